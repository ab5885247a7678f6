"""The end of an algorithm's process: politely first, then by signals that get harder, until nothing of it is left."""

from __future__ import annotations

import signal
import time

from ahmss.processes.child import Child, Hired
from ahmss.processes.stream import Outbound

__all__ = ["Ending"]


class Ending:
    """Presses one process to end, from `begin` on.

    Args:
        child: the process.
        outbound: what is still to be sent to it; closed once that is done.
        patience: seconds between one means and the next.
    """

    def __init__(self, child: Child, outbound: Outbound, patience: float) -> None:
        self._child, self._outbound, self._patience = child, outbound, patience
        self._due: float | None = None  # when the next, harder means is
        self._means: list[int] = [signal.SIGKILL, signal.SIGTERM]

    def begin(self, patience: float) -> None:
        """Let it end by itself for so many seconds."""
        self._due = time.monotonic() + patience

    def press(self) -> bool:
        """Do what is due; whether it has ended."""
        if self._due is None:
            return False
        now = time.monotonic()
        self._outbound.flush()
        if self._outbound.empty and self._outbound.sink >= 0:
            self._outbound.close()
        if self._child.poll() is not None:
            return True
        if now >= self._due and self._means:
            self._signal(self._means.pop())
            self._due = now + self._patience
        return False

    def kill(self) -> None:
        """End it by force, now."""
        self._means = []
        self._signal(signal.SIGKILL)

    def _signal(self, number: int) -> None:
        self._child.signal(number)
        if isinstance(self._child, Hired):
            self._child.abandon()
