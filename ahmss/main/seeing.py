"""How a person gets to see what was played."""

from __future__ import annotations

from pathlib import Path

from ahmss.main.demo import has_display
from ahmss.main.play import PlaySetup

__all__ = ["how_to_see"]


def how_to_see(script: Path, setup: PlaySetup, *, window: bool | None = None) -> str:
    """The commands that show a script that was played; window: whether one can be opened, left out: as it is here."""
    window = has_display() if window is None else window
    if setup.server:
        live = "" if window else " --sheet sheet.png"
        return f"to see the world: ahmss view --server {setup.server}{live}"
    recording = setup.record or Path(f"{script.stem}.rec")
    name = recording.stem
    shown = f"ahmss view {recording}" + ("" if window else f" --sheet {name}.png, or a film: --record {name}.mp4")
    if setup.record is not None:
        return f"to see it: {shown}"
    return f"to see it: ahmss play {script} --record {recording}, then {shown}"
