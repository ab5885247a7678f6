"""What has to be thought of before a motion goes on, in parts while frames are given: no frame waits for it."""

from __future__ import annotations

from collections.abc import Generator
from typing import Generic, TypeVar

from ahmss.body.array import Array
from ahmss.motion.steps import Steps

__all__ = ["Thinking", "alongside", "waited"]

Found = TypeVar("Found")


class Thinking(Generic[Found]):
    """Work of which a part is done at a time, a few milliseconds each."""

    def __init__(self, work: Steps[Found]) -> None:
        self._work = work
        self._found: list[Found] = []

    def part(self) -> bool:
        """Do the next part; whether there is more."""
        if self._found:
            return False
        try:
            next(self._work)
        except StopIteration as end:
            self._found.append(end.value)
        return not self._found

    @property
    def found(self) -> Found:
        """What was found; what is left of the work is done now."""
        while self.part():
            pass
        return self._found[0]


def waited(
    work: Steps[Found], row: Array, most: int | None = None, at_once: int = 1
) -> Generator[Array, None, tuple[Found, int]]:
    """What work finds, and in how many frames; in its pauses the same frame (1, 260) again.

    most: frames that may be given; the rest of the work is done in the last. at_once: parts of it that are done in one.
    """
    given = parts = 0
    while True:
        try:
            next(work)
        except StopIteration as end:
            return end.value, given
        parts += 1
        if parts % at_once == 0 and (most is None or given < most):
            given += 1
            yield row


def alongside(rows: Array, thinking: Thinking[Found]) -> Generator[Array, None, None]:
    """Frames (n, 260), singly as long as there is something to be thought of: with each, but the first, a part."""
    k = 0
    more = True
    while more and k < len(rows) - 1:
        yield rows[k : k + 1]
        k += 1
        more = thinking.part()
    yield rows[k:]
