"""Pictures shown a second (table 5.5 of the thesis): alone, and while the scenario runs."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError
from ahmss.main.play import PlaySetup, play_script, running_server

__all__ = ["display_fps"]

_SIZES = ("640x480", "1280x720")
_SECONDS = 12
_SCENARIO = "examples/table.txt"


def display_fps(workspace: Workspace) -> dict[str, Any]:
    """`display_fps` (a world where nothing moves) and `display_fps_live` (while the scenario is played), by size."""
    return {
        "display_fps": {size: _alone(workspace, size) for size in _SIZES},
        "display_fps_live": {size: _live(workspace, size) for size in _SIZES},
    }


def _alone(workspace: Workspace, size: str) -> float:
    """A viewer on a world with the room and one human, where nothing moves and no main runs any more."""
    with tempfile.TemporaryDirectory(prefix="ahmss-bench-") as folder:
        script = Path(folder) / "still.txt"
        lines = (workspace.root / _SCENARIO).read_text().splitlines()
        still = [line for line in lines if line.split(" ")[0] in ("add", "human")]
        script.write_text("\n".join([*still, f"wait {_SECONDS + 6}"]) + "\n")
        return _watch(script, size)


def _live(workspace: Workspace, size: str) -> float:
    """A viewer on the scenario as it is played in real time."""
    return _watch(workspace.root / _SCENARIO, size)


def _watch(script: Path, size: str) -> float:
    """Play a script in real time and ask a headless viewer for its rate over some seconds."""
    viewers: list[subprocess.Popen[bytes]] = []

    def ready(address: str) -> None:
        command = [sys.executable, "-m", "ahmss", "view", "--server", address, "--headless", "--size", size, "--json"]
        command += ["--seconds", str(_SECONDS)]
        viewers.append(subprocess.Popen(command, stdout=subprocess.PIPE, env=os.environ))

    setup = PlaySetup()
    with running_server(setup, ()) as address:
        play_script(script, PlaySetup(server=address), ready)
        output, _ = viewers[0].communicate(timeout=60)
    try:
        return float(json.loads(output.splitlines()[-1])["frames_per_s"])
    except (ValueError, IndexError, KeyError):
        raise AhmssError(f"the viewer at {size} gave no rate; it ended with {viewers[0].returncode}") from None
