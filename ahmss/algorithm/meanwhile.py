"""What has to be thought of before a motion goes on, in parts while frames are given: no frame waits for it."""

from __future__ import annotations

from collections.abc import Generator
from typing import Generic, TypeVar

from ahmss.body.array import Array
from ahmss.reaching.steps import Steps

__all__ = ["Thinking", "alongside"]

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


def alongside(rows: Array, thinking: Thinking[Found]) -> Generator[Array, None, None]:
    """Frames (n, 260), singly as long as there is something to be thought of: with each, but the first, a part."""
    k = 0
    more = True
    while more and k < len(rows) - 1:
        yield rows[k : k + 1]
        k += 1
        more = thinking.part()
    yield rows[k:]
