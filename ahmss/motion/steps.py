"""Work done in steps, so that who has frames to give can give them in between.

A function that works so is a generator: it yields None where it may pause, and returns what it found.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import TypeVar

__all__ = ["Steps", "finished"]

Found = TypeVar("Found")
Steps = Generator[None, None, Found]
"""Work that pauses now and then, a few milliseconds each, and returns what it found."""


def finished(work: Steps[Found]) -> Found:
    """What work finds that is done without a pause."""
    while True:
        try:
            next(work)
        except StopIteration as end:
            return end.value
