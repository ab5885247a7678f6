"""`ahmss up`: server, viewer and main with its console on this machine."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from ahmss.main.command import Add
from ahmss.main.console import run_console
from ahmss.main.demo import has_display
from ahmss.main.process import Setup
from ahmss.world.address import PORT
from ahmss.world.process import ServerProcess

__all__ = ["run_up"]


def run_up(human: str, body: str, scene: str, address: str, workspace: Path | None) -> int:
    """Run all until the console is left; returns how many things went wrong.

    Raises:
        AhmssError: the port is taken, or no such body.
    """
    with ServerProcess(address or f"127.0.0.1:{PORT}") as server:
        viewer = _viewer(server.address)
        if viewer is None:
            print(f"no display for a window; pictures: ahmss view --server {server.address} --snapshot picture.png")
        try:
            first = [Add(scene)] if scene else []
            return run_console(Setup(human, body, server=server.address, workspace=workspace), first)
        finally:
            if viewer is not None:
                viewer.terminate()
                viewer.wait()


def _viewer(address: str) -> subprocess.Popen[bytes] | None:
    """The window, where there is a display."""
    if not has_display():
        return None
    return subprocess.Popen([sys.executable, "-m", "ahmss", "view", "--server", address], stdin=subprocess.DEVNULL)
