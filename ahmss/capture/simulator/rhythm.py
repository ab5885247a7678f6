"""When a unit measures: on a grid that begins with the performance; with the clock "poll", when a frame is wanted."""

from __future__ import annotations

import math

from ahmss.capture.simulator.options import MODELS, SimulatorOptions
from ahmss.capture.simulator.stage import Stage

__all__ = ["Rhythm"]

_SLACK = 1e-9  # seconds: what a sum of frame times is off by at most


class Rhythm:
    """The frames of one unit, numbered from 0 at the performance's beginning."""

    def __init__(self, options: SimulatorOptions, stage: Stage, stations: int) -> None:
        """Args: the tracker's options; the subject; how many stations are active."""
        self._options, self._stage = options, stage
        self._by_poll = options.clock == "poll"
        shared = options.measurements or MODELS[options.kind].measurements
        self._apart = 0.0 if self._by_poll or shared == math.inf else 1.0 / shared
        self._zero: float | None = None  # when the device's own counters were 0
        self._since = (0.0, 0)  # from this second of the performance, and this frame, on the rate is as it is now
        self.rate = options.unit_frames_a_second(stations)
        """Frames a second, of the stations that are active now."""
        self.last = -1
        """The newest frame that was sent."""

    def begin(self) -> None:
        """The next frame is the first."""
        self.last, self._since = -1, (0.0, 0)

    def share_among(self, stations: int, now: float) -> None:
        """So many stations are active from now on: fewer may be measured oftener."""
        rate = self._options.unit_frames_a_second(stations)
        if rate != self.rate:
            frame = max(self.last if self._by_poll else self.newest(now), 0)
            self._since, self.rate = (self.seconds(frame), frame), rate

    def count_from(self, now: float) -> None:
        """The device's own counters are 0 now."""
        self._zero = now

    def newest(self, now: float) -> int:
        """The last frame that is measured by now, or the one that is wanted; -1 before the first."""
        if self._by_poll:
            return self.last + 1
        if self._stage.epoch is None:
            return -1
        seconds, frame = self._since
        return frame + math.floor((now - self._stage.epoch - seconds + _SLACK) * self.rate)

    def due(self, now: float) -> int | None:
        """The newest frame, unless it was sent, or there is no more to see."""
        frame = self.newest(now)
        return None if frame <= self.last or self._stage.over(self.seconds(frame)) else frame

    def next_time(self, now: float) -> float | None:
        """When the next frame will be due; None: never."""
        frame = self.newest(now) if self._by_poll else max(self.newest(now), self.last) + 1
        if self._stage.over(self.seconds(frame)):
            return None
        return now if self._by_poll else (self._stage.epoch or 0.0) + self.seconds(frame)

    def seconds(self, frame: int, before: int = 0) -> float:
        """When in the performance a frame is measured; stations that share a FASTRAK's measurements take turns.

        Args:
            frame: its number.
            before: how many active stations are measured before this one.
        """
        seconds, first = self._since
        return seconds + (frame - first) / self.rate + before * self._apart

    def count(self, frame: int) -> int:
        """The device's own number of a frame: since it was switched on, or since its counters were reset."""
        if self._by_poll or self._stage.epoch is None or self._zero is None:
            return frame
        return max(math.floor((self._stage.epoch - self._zero) * self.rate) + frame, 0)
