"""Pictures shown a second (table 5.5 of the thesis): alone, and while the scenario runs."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError
from ahmss.main.play import PlaySetup, play_script, running_server

__all__ = ["display_fps", "drawn", "watch"]

_SIZES = ("640x480", "1280x720")
_SECONDS = 12
_SCENARIO = "examples/table.txt"


def display_fps(workspace: Workspace) -> dict[str, Any]:
    """`display_fps` (the scenario's recording, drawn alone) and `display_fps_live` (while it is played), by size."""
    return {
        "display_fps": {size: drawn(workspace.root / _SCENARIO, size)["fps"] for size in _SIZES},
        "display_fps_live": {size: watch(workspace.root / _SCENARIO, size) for size in _SIZES},
    }


def drawn(script: Path, size: str, seconds: float = 6.0) -> dict[str, Any]:
    """What the viewer draws by itself of a script's recording: `fps`, `faces`, `ms`, with no server and no main."""
    with tempfile.TemporaryDirectory(prefix="ahmss-bench-") as folder:
        recording = Path(folder) / "run.rec"
        play_script(script, PlaySetup(fast=True, record=recording))
        # OpenGL belongs to one process and one way of drawing, so each measurement has a process of its own.
        code = "import json, sys; from ahmss_viewer.bench import display_rate; width, height = sys.argv[2].split('x'); "
        code += "print(json.dumps(display_rate(sys.argv[1], (int(width), int(height)), float(sys.argv[3]))))"
        command = [sys.executable, "-c", code, str(recording), size, str(seconds)]
        done = subprocess.run(command, stdout=subprocess.PIPE, check=False)
    try:
        return json.loads(done.stdout.splitlines()[-1])
    except (ValueError, IndexError):
        raise AhmssError(f"the viewer at {size} gave no rate; it ended with {done.returncode}") from None


def watch(script: Path, size: str, seconds: float = _SECONDS, workspace: Path | None = None) -> float:
    """Play a script in real time and ask a headless viewer for its rate over some seconds."""
    viewers: list[subprocess.Popen[bytes]] = []

    def ready(address: str) -> None:
        command = [sys.executable, "-m", "ahmss", "view", "--server", address, "--headless", "--size", size, "--json"]
        command += ["--seconds", str(seconds)]
        viewers.append(subprocess.Popen(command, stdout=subprocess.PIPE))

    with running_server(PlaySetup(), ()) as address:
        report = play_script(script, PlaySetup(server=address, workspace=workspace), ready)
        output, _ = viewers[0].communicate(timeout=60)
    if report.failures:
        raise AhmssError(f"{script.name} can't be shown as it was meant: {report.mains[0]['messages'][0]}")
    try:
        return float(json.loads(output.splitlines()[-1])["frames_per_s"])
    except (ValueError, IndexError, KeyError):
        raise AhmssError(f"the viewer at {size} gave no rate; it ended with {viewers[0].returncode}") from None
