"""What the tests of this folder share: a human, frames, and the misbehaving programs."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from ahmss.algorithm.messages import encode_frame
from ahmss.body.skeleton import Skeleton
from ahmss.errors import AlgorithmError
from ahmss.processes.answers import Message
from ahmss.processes.launcher import Launcher
from ahmss.processes.process import AlgorithmProcess
from ahmss.walking.catalogue import STRAIGHT
from ahmss.walking.library import BODY, WalkClip

PEERS = Path(__file__).parents[1] / "peers"
HUMAN = Skeleton.of(1.70, "male", "tester")
ROTATIONS, ROOT = HUMAN.upright()


@dataclass(frozen=True)
class Entry:
    """What the database would hand out."""

    name: str
    argv: tuple[str, ...]
    directory: Path = PEERS


def walk_clip(frames: int = 4) -> WalkClip:
    """A straight step that is none: the human glides."""
    rotations = np.tile([1.0, 0.0, 0.0, 0.0], (frames + 1, BODY, 1))
    root = np.linspace([0.0, 0.0, 0.9], [0.7, 0.0, 0.9], frames + 1)
    return WalkClip(STRAIGHT, rotations, root, np.ones((frames + 1, 2, 3), bool))


def peer(how: str, *arguments: str) -> Entry:
    """The misbehaving program, as a new interpreter without site packages."""
    return Entry(how, (sys.executable, "-I", "-S", "peer.py", how, *arguments))


def frame(k: int) -> bytes:
    """FRAME k of a human that stands still."""
    return encode_frame(k, ROOT, ROTATIONS, np.zeros((2, 7)))


def object_frame(k: int) -> bytes:
    """FRAME k for an object algorithm: the cup at (0.4, -0.1, 0.8), palms at (k / 100, 0, 1)."""
    palm = np.array([k / 100, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    cup = np.array([0.4, -0.1, 0.8, 1.0, 0.0, 0.0, 0.0])
    return encode_frame(k, ROOT, ROTATIONS, np.array([palm, palm]), cup)


def play(
    launcher: Launcher, process: AlgorithmProcess, frames: int, make: Callable[[int], bytes] = frame
) -> list[Message]:
    """Ask for frames 1 to N and collect what comes, to the end of the motion or the error."""
    messages: list[Message] = []
    for k in range(1, frames + 1):
        process.ask(make(k))
        launcher.wait([process], 30.0)
        messages += process.receive()
    return messages


def failure(launcher: Launcher, process: AlgorithmProcess, frames: int) -> str:
    """The one sentence that its failure is told by, within so many frames."""
    with pytest.raises(AlgorithmError) as caught:  # noqa: PT012 - it may come with the last frame or behind it
        play(launcher, process, frames)
        process.receive()
    return str(caught.value)


def wait_for(condition: Callable[[], object], seconds: float = 10.0) -> bool:
    """Whether the condition comes true in time."""
    until = time.monotonic() + seconds
    while not condition() and time.monotonic() < until:
        time.sleep(0.01)
    return bool(condition())


def gone(pid: int) -> bool:
    """Whether no such process is left, but for a zombie that nobody here could reap."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except (FileNotFoundError, ProcessLookupError):
        return True
