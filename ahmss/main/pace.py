"""The pace of frames: 60 a second by an absolute clock, or as fast as can be."""

from __future__ import annotations

import time
from collections.abc import Callable

__all__ = ["Pace"]

_TOO_LATE = 0.25  # seconds behind from which on the clock starts anew rather than hurry


class Pace:
    """When the next frame is due.

    Attributes:
        late: how many frames began more than one frame's time late.
    """

    def __init__(self, rate: float, *, fast: bool = False, clock: Callable[[], float] = time.monotonic) -> None:
        self.period = 0.0 if fast else 1.0 / rate
        self.late = 0
        self._clock = clock
        self._due = clock()

    @property
    def due(self) -> float:
        """When the frame begins, by the clock."""
        return self._due

    def left(self) -> float:
        """Seconds until the next frame begins; negative when it should have begun."""
        return self._due - self._clock() if self.period else 0.0

    def advance(self) -> None:
        """A frame begins now: the next is due one period after this one was, not after it began."""
        if not self.period:
            return
        behind = self._clock() - self._due
        if behind > self.period:
            self.late += 1
        if behind > _TOO_LATE:
            self._due += behind
        self._due += self.period
