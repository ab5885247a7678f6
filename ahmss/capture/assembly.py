"""Readings of one line become sweeps: one pass over the line's stations, with a number that tells what was lost."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from statistics import median
from typing import Literal

from ahmss.capture.formats.losses import Losses
from ahmss.capture.stations import Reading

__all__ = ["Assembler", "Numbering", "Sweep"]

Numbering = Literal["count", "order", "clock", "time"]
"""Where numbers of sweeps come from: the device's own count; one after the other, a poll each; the same, with gaps
where time went by; or the time alone, for lines that are not in step by themselves."""

_WRAP = 1 << 32  # devices count in 32 bits
_OFF = 1.2  # sweeps by which a number may be behind the time
_SETTLED = 8  # sweeps until the earliest arrivals are known
_LASTING = 4  # sweeps of delay that are a loss, where other lines go on
_DRIFT, _DRIFT_STRICT = 0.0005, 0.005  # periods a period by which clocks are taken to differ
_LATELY = 9  # arrivals by whose median a line is slow
_SLOW = 1.25  # periods a sweep from which it is
_BELIEVED = 3  # so many records that agree on another frame number are right


@dataclass(frozen=True)
class Sweep:
    """One pass over the stations of a line.

    number: of the device's frames, with gaps where some were lost; begins anywhere.
    readings: by station, as the configuration numbers them.
    arrival: of the last reading, monotonic seconds.
    fresh: the numbers begin anew here (the first sweep, or the device was restarted).
    """

    number: int
    readings: dict[int, Reading]
    arrival: float
    fresh: bool = False


@dataclass
class _Open:
    """A sweep that is still coming in; `arrival` is when its latest reading came."""

    readings: dict[int, Reading] = field(default_factory=dict[int, Reading])
    arrival: float = 0.0


class Assembler:
    """Groups readings by the device's frame count, or, where there is none, by the order of the stations.

    A device sends its stations in rising order, a sweep after the other, so a sweep is over when it is complete or
    when the next one has begun in earnest: one record with a wrong count does not end it.
    """

    def __init__(self, stations: Sequence[int], rate: float, losses: Losses, *, numbering: Numbering) -> None:
        """Make one for a line.

        Args:
            stations: the configuration's numbers of the device's stations 1, 2, ...
            rate: sweeps a second.
            losses: where they are counted.
            numbering: what the numbers of sweeps come from.
        """
        self._names = dict(enumerate(stations, 1))
        self._expected = len(stations)
        self._earnest = min(2, len(stations))
        self._window = max(8, round(0.2 * rate))
        self._patience = max(2.5 / rate, 0.1 if numbering == "order" else 0.25)  # else the next sweep ends this one
        self._losses = losses
        self._counted = numbering == "count"
        self._clock = _SweepClock(rate, strict=numbering == "time") if numbering in ("clock", "time") else None
        self._open: dict[int, _Open] = {}
        self._done: int | None = None
        self._fresh = True
        self._strangers: list[int] = []
        self._pass = self._closed = 0
        self._last_station = 0

    def expect(self, active: Sequence[int]) -> None:
        """The device said which of its own stations are on: a sweep of these is complete."""
        self._expected = len([local for local in active if local in self._names]) or len(self._names)
        self._earnest = min(2, self._expected)

    def feed(self, readings: Sequence[Reading]) -> list[Sweep]:
        """The sweeps that these readings complete."""
        sweeps: list[Sweep] = []
        for reading in readings:
            name = self._names.get(reading.station)
            if name is None:
                self._losses.damaged += 1
                continue
            count = self._place(reading)
            if count is not None:
                sweeps += self._add(count, name, reading)
        return self._numbered(sweeps)

    def poll(self) -> list[Sweep]:
        """A frame was asked for: what comes now is the next sweep. Returns the one before, if it was not complete."""
        closed = self._close(self._pass)
        self._pass, self._last_station = self._pass + 1, 0
        return self._numbered(closed)

    def flush(self, now: float) -> list[Sweep]:
        """The sweeps whose rest has not come for so long that it won't."""
        due = [
            count
            for count, sweep in self._open.items()
            if now - sweep.arrival > self._patience and len(sweep.readings) >= self._earnest
        ]
        return self._numbered(self._close(max(due))) if due else []

    def _place(self, reading: Reading) -> int | None:
        """The sweep that a reading belongs to, or None where its count can't be."""
        if not self._counted or reading.count is None:
            return self._pass_of(reading)
        if self._done is None:
            self._done = reading.count - 1
        ahead = (reading.count - self._done) % _WRAP
        if 0 < ahead <= self._window:
            self._strangers.clear()
            return self._done + ahead
        if ahead == 0 or ahead > _WRAP - self._window:
            self._losses.late += 1
            return None
        self._losses.miscounted += 1
        return self._recount(reading.count)

    def _recount(self, count: int) -> int | None:
        """Count on from elsewhere where several readings in a row agree: much was lost, or the device restarted."""
        self._strangers = [other for other in self._strangers if 0 <= count - other <= 1] + [count]
        if len(self._strangers) < _BELIEVED:
            return None
        self._strangers.clear()
        self._open.clear()
        self._fresh = self._done is None or count < self._done
        self._done = count - 1
        return count

    def _pass_of(self, reading: Reading) -> int:
        """Without a count: a return to a station that was there, or far back, begins the next sweep.

        Not every station behind the last one does: a damaged station character would cut the sweep in two.
        """
        current = self._open.get(self._pass)
        back = self._last_station - reading.station
        if current is None:
            over = self._pass <= self._closed
        else:
            over = back >= 0 and (2 * back > self._expected or self._names[reading.station] in current.readings)
        if over:
            self._pass += 1
        self._last_station = reading.station
        return self._pass

    def _add(self, count: int, name: int, reading: Reading) -> list[Sweep]:
        sweep = self._open.setdefault(count, _Open())
        sweep.readings[name] = reading
        sweep.arrival = reading.arrival
        if len(sweep.readings) >= self._expected:
            return self._close(count)
        return self._close(count - 1) if len(sweep.readings) >= self._earnest or not self._counted else []

    def _close(self, last: int) -> list[Sweep]:
        """All open sweeps up to this count, in order."""
        closed: list[Sweep] = []
        for count in sorted(count for count in self._open if count <= last):
            sweep = self._open.pop(count)
            closed.append(Sweep(count, sweep.readings, sweep.arrival, self._fresh))
            self._fresh = False
            self._closed = count
            if self._done is not None:
                self._done = count
        return closed

    def _numbered(self, sweeps: list[Sweep]) -> list[Sweep]:
        if self._clock is None or not sweeps:
            return sweeps
        first = self._clock.advance(len(sweeps), sweeps[-1].arrival)
        return [Sweep(first + at, sweep.readings, sweep.arrival, sweep.fresh) for at, sweep in enumerate(sweeps)]


class _SweepClock:
    """Numbers sweeps that carry no count: one after the other, and a gap where time has gone by without any.

    Arrivals are late at times, never early, so the earliest are believed: `base`, when sweep 0 would have come by them.
    It may drift a little, as clocks differ, and no more: what comes before its time by these numbers was numbered too
    high after something late, and to believe that, too, would make time run fast with every delay. What comes at once
    after a stall of this machine is no loss; what comes of it in several reads is taken for one, near the rate that is
    asked for, and time is then ahead by the stall. A strict clock keeps a line in step with others: it also holds back
    a device that is too fast, and leaves a gap only where the delay lasts, as after a stall of a moment it would have
    to make up for it. One that is not strict takes a line that is slow all the time for what it is, and numbers its
    sweeps by the nearest time.
    """

    def __init__(self, rate: float, *, strict: bool) -> None:
        self._period = 1.0 / rate
        self._strict = strict
        self._number = -1
        self._sweeps = self._behind = 0
        self._base: float | None = None
        self._arrival: float | None = None
        self._paces: deque[float] = deque(maxlen=_LATELY)  # periods that a sweep took

    def advance(self, count: int, arrival: float) -> int:
        """The number of the first of `count` sweeps, the last of which came now."""
        last = self._number + count
        base = arrival - last * self._period if self._base is None else self._base
        behind = (arrival - base) / self._period - last
        if self._strict:
            last = self._in_step(last, behind)
        else:
            last += self._lacking(count, arrival, behind)
        creep = (_DRIFT_STRICT if self._strict else _DRIFT) * self._period * max(count, last - self._number)
        earliest = arrival - last * self._period
        settling = 0.05 * self._period if self._strict else math.inf
        lowest = base - (creep if self._sweeps > _SETTLED else settling)
        self._base = min(base + creep, max(earliest, lowest))
        self._number = last
        self._sweeps += count
        return last - count + 1

    def _lacking(self, count: int, arrival: float, behind: float) -> int:
        """How many sweeps are lacking before these; never more than there was time for, lest the time runs fast."""
        if self._arrival is not None:
            self._paces.append((arrival - self._arrival) / self._period / count)
        self._arrival = arrival
        slow = len(self._paces) == _LATELY and median(self._paces) > _SLOW
        if slow:
            return max(round(behind), 0)
        return math.floor(behind) if behind > _OFF else 0

    def _in_step(self, last: int, behind: float) -> int:
        """The last sweep's number where the line must keep in step with others."""
        self._behind = self._behind + 1 if behind > _OFF else 0
        if self._behind >= _LASTING:
            return last + round(behind)
        if behind < -1.0 and self._number > _SETTLED:
            return max(last - 1, self._number)
        return last
