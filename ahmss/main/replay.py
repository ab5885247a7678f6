"""`ahmss play RECORDING`: a recording played back into a server, for any viewer to see."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from ahmss.errors import AhmssError, DataError
from ahmss.main.play import PlaySetup, running_server
from ahmss.world.keys import read_client
from ahmss.world.recording import Reader
from ahmss.world.replay import replay

__all__ = ["is_recording", "play_recording"]

_MAGIC = b"AHMSSREC"


def is_recording(path: Path) -> bool:
    """Whether a file is a recording; False for anything else, also for what can't be read."""
    try:
        with path.open("rb") as file:
            return file.read(len(_MAGIC)) == _MAGIC
    except OSError:
        return False


def play_recording(path: Path, setup: PlaySetup, say: Callable[[str], None]) -> None:
    """Play a recording once, at its own rate (`fast`: as fast as it can).

    Raises:
        AhmssError: it can't be read, or the server refuses what is in it (a human of that name is there already).
    """
    with Reader(path) as reader:
        frames = len(reader)
    if not frames:
        raise DataError(path, "", "there is no frame in this recording")
    problems: list[str] = []
    with running_server(PlaySetup(record=setup.record, server=setup.server), (), problems) as address:
        say(f"{path.name}: {frames} frames, on the server at {address}")
        keys = read_client(setup.keys) if setup.keys else None
        replay(path, address, speed=0.0 if setup.fast else 1.0, keys=keys)
    if problems:
        raise AhmssError("; ".join(problems))
