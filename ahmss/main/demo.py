"""`ahmss demo`: the thesis's scenario with every kind of process, filmed while it is played."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError, DependencyError
from ahmss.main.play import PlayReport, PlaySetup, play_script
from ahmss.main.script import read_script
from ahmss.world.process import ServerProcess

__all__ = ["has_display", "run_demo"]

_SCRIPT = Path("examples") / "scenario.txt"
_FILM_SIZE, _SHEET_SIZE = "640x360", "480x270"
_EVERY = 90  # frames between two pictures of the sheet
# From the corner where the room has no walls, all of it to be seen from door to chair.
_CAMERA = ("--position", "-2.2", "3.5", "2.9", "--look-at", "1.1", "0.25", "0.75")
_VIEWER_ENDS_S = 20.0


def has_display() -> bool:
    """Whether a window can be opened here."""
    return sys.platform == "darwin" or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def run_demo(out: Path, workspace: Path | None, *, window: bool, say: Callable[[str], None]) -> int:
    """Run the demo; returns how many things went wrong.

    Raises:
        AhmssError: a process could not be started, or a file not be written.
    """
    root = Workspace.find(workspace).root
    out.mkdir(parents=True, exist_ok=True)
    recording, film, sheet = (out / f"{_SCRIPT.stem}{ending}" for ending in (".rec", ".mp4", ".png"))
    say(f"playing {_SCRIPT} in real time: server, main, algorithms and a viewer without a window, which films it")
    report, live = _play(root / _SCRIPT, root, recording, film)
    say(str(report))
    say(_live_line(live))
    failures = report.failures
    if "error" in live:
        failures += 1
    say("drawing the contact sheet")
    try:
        _draw(recording, sheet)
    except DependencyError as error:
        say(f"no sheet: {error}")
        failures += 1
    for path in (recording, film, sheet):
        if path.is_file():
            say(f"{path}  ({path.stat().st_size / 1e6:.1f} MB)")
    say(_measured(recording))
    if window and has_display():
        say("close the window to end")
        subprocess.run([sys.executable, "-m", "ahmss", "view", str(recording)], check=False)
    return failures


def _play(script: Path, root: Path, recording: Path, film: Path) -> tuple[PlayReport, dict[str, Any]]:
    """Play the script in real time, a viewer without a window filming it; both reports."""
    names = [human.name for human in read_script(script).humans]
    with ServerProcess(lockstep=names, recording=recording) as server:
        viewer = _watch(server.address, film)
        try:
            report = play_script(script, PlaySetup(server=server.address, workspace=root, stay=True, waits=True))
        finally:
            live = _end(viewer)
    return report, live


def _watch(address: str, film: Path) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "ahmss", "view", "--server", address, "--json", "--size", _FILM_SIZE, *_CAMERA]
    command += ["--record", str(film)]
    return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def _end(viewer: subprocess.Popen[bytes]) -> dict[str, Any]:
    """Stop the viewer; what it told, or why it did not."""
    viewer.send_signal(signal.SIGINT)
    try:
        output, errors = viewer.communicate(timeout=_VIEWER_ENDS_S)
    except subprocess.TimeoutExpired:
        viewer.kill()
        output, errors = viewer.communicate()
    try:
        return json.loads(output.splitlines()[-1])
    except (ValueError, IndexError):
        said = errors.decode(errors="replace").strip().splitlines()
        return {"error": said[-1] if said else f"it ended with exit code {viewer.returncode}"}


def _live_line(live: dict[str, Any]) -> str:
    if "error" in live:
        return f"the live viewer: {live['error']}"
    age = live.get("age_ms") or {}
    age_text = f", the world shown {age['p50']:.0f} ms old" if age else ""
    return (
        f"the live viewer: {live['pictures']} pictures of {live['size']}, {live['frames_per_s']:.1f} frames/s{age_text}"
    )


def _draw(recording: Path, sheet: Path) -> None:
    """Draw the sheet; in a process of its own, for OpenGL is bound once."""
    command = [sys.executable, "-m", "ahmss", "view", str(recording), "--size", _SHEET_SIZE, "--camera", "cuts"]
    command += ["--sheet", str(sheet), "--every", str(_EVERY), "--json"]
    done = subprocess.run(command, stdout=subprocess.PIPE, check=False)
    if done.returncode:
        try:
            reason = json.loads(done.stdout.splitlines()[-1])["error"]
        except (ValueError, IndexError, KeyError):
            reason = "see above"
        raise DependencyError(reason)


def _measured(recording: Path) -> str:
    """How smooth the recorded motion is."""
    from ahmss.main.judging import judge

    try:
        return "\n".join(judge(recording))
    except AhmssError as error:
        return f"not measured: {error}"
