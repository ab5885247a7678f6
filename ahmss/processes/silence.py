"""How long a process has kept main waiting, less the time in which the machine kept the process waiting.

A process that is late on a busy machine is not stuck: stuck is one that had a processor, or wanted none, and said
nothing. Linux counts for each thread the nanoseconds that it ran and those that it was ready to run and had no
processor, in /proc/PID/task/TID/schedstat (the kernel's Documentation/scheduler/sched-stats.rst). Where that is not to
be had, a second counts as the share of it that falls to each of those that want a processor.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple

__all__ = ["Silence", "Thread", "share_of_each", "threads_of"]

_BETWEEN = 0.05  # seconds between two looks at a process
_LONGEST = 0.25  # seconds between two looks that count: main itself was held up for the rest, and maybe all were


class Thread(NamedTuple):
    """What the kernel says of a thread: seconds that it ran and waited for a processor, whether it runs or waits now.

    A wait is counted when it is over.
    """

    ran: float
    waited: float
    ready: bool


class _Seen(NamedTuple):
    """A thread as it was seen: `since` when nothing was counted, and what it has waited, with what still lasts."""

    thread: Thread
    since: float
    waited: float


class Silence:
    """From the moment that a process is asked until it answers.

        silence = Silence()
        if silence.lasts(process_id) > 1.0: ...     # as often as one likes

    Args:
        clock: seconds.
        threads: of a process id, by their numbers; None: nobody knows.
        share: the part of a processor that falls to each of those that want one, above 0, 1 at the most.
    """

    def __init__(
        self, clock: Callable[[], float] = time.monotonic,
        threads: Callable[[int], Mapping[int, Thread] | None] | None = None, share: Callable[[], float] | None = None,
    ) -> None:  # fmt: skip
        self._clock, self._threads_of, self._share = clock, threads or threads_of, share or share_of_each
        self.begin()

    def begin(self) -> None:
        """It is asked now. Nothing is read: most answer at once."""
        self._began = self._looked = self._clock()
        self._starved = 0.0
        self._seen: dict[int, _Seen] = {}

    @property
    def due(self) -> bool:
        """Whether it is time for a look."""
        return self._clock() - self._looked >= _BETWEEN

    def lasts(self, pid: int) -> float:
        """Seconds since it was asked, without those in which it was ready to go on and had no processor.

        Args:
            pid: the process; 0: not known yet.
        """
        now = self._clock()
        passed = now - self._looked
        if passed >= _BETWEEN:
            self._looked = now
            self._starved += max(self._held_up(pid, now, passed), passed - _LONGEST)
        return max(0.0, self._looked - self._began - self._starved)

    def _held_up(self, pid: int, now: float, passed: float) -> float:
        """Seconds that it has waited for a processor since the last look; that of its threads that waited most."""
        threads = self._threads_of(pid) if pid else None
        before, self._seen = self._seen, {}
        if threads is None:
            return passed * (1.0 - self._share())
        longest = 0.0
        for number, thread in threads.items():
            last = before.get(number)
            since = last.since if last is not None and last.thread == thread else now
            waited = thread.waited + (now - since if thread.ready else 0.0)
            if last is not None:
                waited = max(waited, last.waited)
                longest = max(longest, waited - last.waited)
            elif before:  # it is new
                longest = max(longest, waited)
            self._seen[number] = _Seen(thread, since, waited)
        return longest


def threads_of(pid: int) -> dict[int, Thread] | None:
    """The threads of a process by their numbers; None where the kernel says nothing of them."""
    threads: dict[int, Thread] = {}
    try:
        for number in os.listdir(f"/proc/{pid}/task"):
            place = Path(f"/proc/{pid}/task/{number}")
            ran, waited, _ = (place / "schedstat").read_text().split()
            state = (place / "stat").read_text().rpartition(")")[2].split()[0]
            if int(ran):  # else it has not run yet, or nothing is counted
                threads[int(number)] = Thread(int(ran) * 1e-9, int(waited) * 1e-9, state == "R")
    except (OSError, ValueError, IndexError):  # no Linux, no such count, or one of them has just ended
        return None
    return threads or None


def share_of_each() -> float:
    """The part of a processor that falls to each of those that want one now."""
    try:
        wanting = float(Path("/proc/loadavg").read_text().split()[3].split("/")[0])
    except (OSError, ValueError, IndexError):
        try:
            wanting = os.getloadavg()[0]
        except (OSError, AttributeError):
            return 1.0
    return min(1.0, (os.cpu_count() or 1) / max(wanting, 1.0))
