"""The subject before the transmitter, in time: what each sensor measures at any moment of the performance."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import slerp
from ahmss.capture.simulator.noise import REACH, Noise
from ahmss.capture.simulator.options import SimulatorOptions
from ahmss.capture.simulator.sensors import Mounts, measure, save_truth

__all__ = ["Sensed", "Stage"]


class Sensed(NamedTuple):
    """One sensor at one moment: rotation (4,), transmitter <- sensor; position (3,) in metres; whether out of reach."""

    rotation: Array
    position: Array
    far: bool


class Stage:
    """One performance, shared by all units of a tracker.

    It begins when the first unit is told to send, goes on while any unit sends, and begins again when a unit is told to
    send after all had stopped.
    """

    def __init__(self, options: SimulatorOptions) -> None:
        performance = options.performance
        mounts = Mounts.askew(performance.skeleton, options.seed) if options.mounted else Mounts.straight()
        if options.truth is not None:
            save_truth(options.truth, performance, mounts, options.transmitter)
        self._rotations, self._positions = measure(performance, mounts, options.transmitter)
        self._rate, self._after = performance.rate, options.after
        self._noise = Noise(options.noise, options.seed)
        self._noisy = options.noise != "none"
        self._sending: set[int] = set()
        self.epoch: float | None = None
        """The moment of the performance's first frame, on the clock that `start` was given."""
        self._at = lru_cache(maxsize=32)(self._measured)

    def start(self, unit: int, now: float) -> None:
        """A unit begins to send."""
        if not self._sending:
            self.epoch = now
        self._sending.add(unit)

    def stop(self, unit: int) -> None:
        """A unit sends no more."""
        self._sending.discard(unit)

    def rest(self) -> None:
        """The subject goes back to where it began, unless a unit sends."""
        if not self._sending:
            self.epoch = None

    def asked(self, now: float) -> None:
        """A unit is polled: the performance begins, unless it has."""
        if self.epoch is None:
            self.epoch = now

    def over(self, seconds: float) -> bool:
        """Whether nothing more is to be sent: the performance is done, and that is how it should end."""
        return self._after == "stop" and seconds * self._rate > len(self._rotations) - 1 + 1e-6

    def sense(self, station: int, seconds: float, frame: int) -> Sensed:
        """What a station (from 1) measures so many seconds into the performance; the frame has its own jitter."""
        rotations, positions, far = self._at(seconds, frame)
        return Sensed(rotations[station - 1], positions[station - 1], bool(far[station - 1]))

    def _measured(self, seconds: float, frame: int) -> tuple[Array, Array, Array]:
        """All sensors: rotations (15, 4), positions (15, 3), and (15,) which are out of reach."""
        rotations, positions = self._true(max(seconds, 0.0) * self._rate)
        far = self._noisy & (np.sqrt((positions**2).sum(-1)) > REACH)
        return (*self._noise(rotations, positions, frame), far)

    def _true(self, index: float) -> tuple[Array, Array]:
        """Rotations (15, 4) and positions (15, 3) at a place between the performance's frames."""
        last = len(self._rotations) - 1
        if self._after == "loop":
            index %= last + 1
        index = min(index, last)
        before = int(index + 1e-6)
        share = index - before
        if share < 1e-6:
            return self._rotations[before], self._positions[before]
        after = min(before + 1, last)
        rotations = slerp(self._rotations[before], self._rotations[after], np.full(self._rotations.shape[1], share))
        return rotations, self._positions[before] + share * (self._positions[after] - self._positions[before])
