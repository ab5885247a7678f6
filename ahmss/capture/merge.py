"""Sweeps of several lines become one: all stations that were measured at one time."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from ahmss.capture.assembly import Sweep
from ahmss.capture.formats.losses import Losses
from ahmss.capture.stations import Reading

__all__ = ["Merged", "Merger"]

_BEGINNING = 0.5  # seconds


@dataclass(frozen=True)
class Merged:
    """One frame of all lines; number counts from 0, with gaps where frames were lost."""

    number: int
    readings: dict[int, Reading]
    arrival: float


class Merger:
    """Holds sweeps back until every line has sent its own, or until waiting is no use.

    Lines number their sweeps as they like; each is brought in step by the arrival of its first. On a serial line
    bytes keep their order, so a line that sent a later sweep has lost the earlier one. Datagrams may overtake each
    other: there a gap is given `patience`.
    """

    def __init__(
        self, lines: int, rate: float, losses: Losses, *, ordered: bool = True, together: bool = False
    ) -> None:
        """Make one.

        Args:
            lines: how many.
            rate: frames a second.
            losses: where they are counted.
            ordered: what is sent first comes first.
            together: lines that begin within half a second began with the same sweep, whenever it came.
        """
        self._lines = lines
        self._rate = rate
        self._patience = min(0.15, max(0.03, 3.5 / rate))
        self._losses = losses
        self._ordered = ordered
        self._together = together
        self._offsets: dict[int, int] = {}
        self._latest = dict.fromkeys(range(lines), -1)
        self._pending: dict[int, dict[int, Sweep]] = {}
        self._given = -1
        self._lately: deque[int] = deque(maxlen=60 if lines == 1 else 0)
        self._first: tuple[int, float] | None = None

    def add(self, line: int, sweep: Sweep) -> None:
        """Take in a sweep of a line (0 and up)."""
        if sweep.fresh or line not in self._offsets:
            self._offsets[line] = self._number_now(sweep) - sweep.number
        number = sweep.number + self._offsets[line]
        self._latest[line] = max(self._latest[line], number)
        if number in self._lately:
            self._losses.repeated += 1
        elif number <= self._given:
            self._losses.late += 1
        elif line in self._pending.setdefault(number, {}):
            self._losses.repeated += 1
        else:
            self._pending[number][line] = sweep

    def take(self, now: float) -> list[Merged]:
        """The frames that are ready, in order."""
        ready: list[Merged] = []
        while self._pending:
            number = min(self._pending)
            sweeps = self._pending[number]
            if not self._due(number, sweeps, now):
                break
            del self._pending[number]
            self._losses.lost += number - self._given - 1
            self._given = number
            self._lately.append(number)
            readings = {station: reading for sweep in sweeps.values() for station, reading in sweep.readings.items()}
            ready.append(Merged(number, readings, max(sweep.arrival for sweep in sweeps.values())))
        return ready

    def _number_now(self, sweep: Sweep) -> int:
        """The frame that a line's first sweep belongs to: one not given out yet, unless all lines began together."""
        if self._first is None:
            self._first = (sweep.number, sweep.arrival)
        number, start = self._first
        if self._together and sweep.fresh and sweep.arrival - start < _BEGINNING:
            return sweep.number - number
        return max(round((sweep.arrival - start) * self._rate), self._given + 1)

    def _due(self, number: int, sweeps: dict[int, Sweep], now: float) -> bool:
        complete = len(sweeps) == self._lines
        if self._ordered:
            if complete or min(self._latest.values()) >= number:
                return True
        elif complete and number == self._given + 1:
            return True
        return now - min(sweep.arrival for sweep in sweeps.values()) > self._patience
