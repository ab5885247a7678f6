"""Merged readings become frames of fifteen links; what no body could do beside its neighbours is held back."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply
from ahmss.capture.formats.losses import Losses
from ahmss.capture.merge import Merged
from ahmss.capture.stations import TRACKED, Reading, Status, TrackerFrame

__all__ = ["SPEED", "TURN", "Gate", "possible"]

SPEED = 10.0
"""m/s: no sensor of a person who acts in a room is faster (walking: feet 4; a throw is faster)."""

TURN = 30.0
"""rad/s: no link turns faster (public walks and turns: 13)."""

PUSH, TWIST = 200.0, 1200.0
"""m/s2 and rad/s2 between one frame and the next (public walks and turns: 170 and 1,100)."""

_JITTER = 0.03  # metres and, with the next, radians between two readings at rest: three times the noise at 15 feet
_JITTER_TURN = 0.05
_AGREE = 3  # so many readings in a row at another place are right: the person, or the field, did move there

_LINKS = len(TRACKED)
_NEVER = -1_000_000


def possible(places: tuple[Array, Array], rotations: tuple[Array, Array], seconds: Array | float) -> NDArray[np.bool_]:
    """Whether sensors can get from the first of places (..., 3) and rotations (..., 4) to the second in this time."""
    return _near(places, rotations, SPEED * seconds, TURN * seconds)


def _near(
    places: tuple[Array, Array], rotations: tuple[Array, Array], metres: Array | float, radians: Array | float
) -> NDArray[np.bool_]:
    """Whether two poses are so close, but for the sensor's noise."""
    moved = places[1] - places[0]
    distance = np.sqrt(np.einsum("...i,...i->...", moved, moved))
    cosine = np.abs(np.einsum("...i,...i->...", rotations[0], rotations[1]))
    angle = 2.0 * np.arccos(np.minimum(cosine, 1.0))
    return (distance <= metres + _JITTER) & (angle <= radians + _JITTER_TURN)


class Gate:
    """Makes the frames that the program gets.

    A reading that a body can't have reached since the station's last good one is held back, and marked. When the next
    ones agree with it and not with what was good before, they are believed: so one wrong reading that slipped through
    can't shut out the right ones, and a jump that is real (a magnet fell over) shows after two frames.
    """

    def __init__(self, rows: Mapping[int, int], rate: float, losses: Losses) -> None:
        """Args: station number -> row of a frame; frames a second; where losses are counted."""
        self._rows = dict(rows)
        self._period = 1.0 / rate
        self._losses = losses
        self._places, self._rotations = np.zeros((_LINKS, 3)), np.tile((1.0, 0.0, 0.0, 0.0), (_LINKS, 1))
        self._good = np.full(_LINKS, _NEVER)  # number of the frame in which a row was good last
        self._before, self._turned_before = self._places.copy(), self._rotations.copy()  # the good ones before those
        self._moving = np.zeros(_LINKS, bool)  # whether these two came in adjacent frames
        self._held_places, self._held_rotations = self._places.copy(), self._rotations.copy()
        self._held = np.full(_LINKS, _NEVER)  # number of the frame in which a row was held back last
        self._agreed = np.zeros(_LINKS, int)
        self._stamps: tuple[float, float, int] | None = None  # first stamp, last time, its frame

    def frame(self, merged: Merged) -> TrackerFrame:
        """The frame of all fifteen; a row without a good reading repeats its last one."""
        seen, weak, places, rotations = self._spread(merged)
        taken = seen & self._judge(merged.number, seen, places, rotations)
        behind = np.einsum("ij,ij->i", rotations, self._rotations) < 0.0
        self._moving[taken] = (merged.number - self._good[taken]) == 1
        self._before[taken], self._turned_before[taken] = self._places[taken], self._rotations[taken]
        self._places[taken] = places[taken]
        self._rotations[taken] = np.where(behind[:, None], -rotations, rotations)[taken]
        self._good[taken] = merged.number
        status = np.full(_LINKS, Status.MISSING, np.uint8)
        status[seen] = Status.IMPLAUSIBLE
        status[taken] = Status.GOOD
        status[taken & weak] = Status.WEAK
        self._losses.frames += 1
        self._losses.missing += len(self._rows) - int(seen.sum())
        self._losses.weak += int((taken & weak).sum())
        self._losses.implausible += int((seen & ~taken).sum())
        time = self._time(merged)
        return TrackerFrame(merged.number, time, self._rotations.copy(), self._places.copy(), status, merged.arrival)

    def _spread(self, merged: Merged) -> tuple[NDArray[np.bool_], NDArray[np.bool_], Array, Array]:
        """Readings into rows: which came, which are weak, places (15, 3), rotations (15, 4)."""
        seen, weak = np.zeros(_LINKS, bool), np.zeros(_LINKS, bool)
        values = np.zeros((_LINKS, 7))
        values[:, 3] = 1.0
        known = [(self._rows[name], reading) for name, reading in merged.readings.items() if name in self._rows]
        if known:
            rows = [row for row, _ in known]
            values[rows] = [_numbers(reading) for _, reading in known]
            seen[rows] = True
            weak[rows] = [reading.status != "" for _, reading in known]
        return seen, weak, values[:, :3], values[:, 3:]

    def _judge(self, number: int, seen: NDArray[np.bool_], places: Array, rotations: Array) -> NDArray[np.bool_]:
        """Which rows are to be believed (15,)."""
        steps = number - self._good
        believed = possible((self._places, places), (self._rotations, rotations), steps * self._period)
        moving = self._moving & (steps == 1)
        if moving.any():
            believed &= ~moving | self._follows(places, rotations)
        believed |= self._good == _NEVER
        doubted = seen & ~believed
        if doubted.any():
            agrees = possible(
                (self._held_places, places), (self._held_rotations, rotations), (number - self._held) * self._period
            )
            self._agreed[doubted] = np.where(agrees & (self._agreed > 0), self._agreed + 1, 1)[doubted]
            self._held_places[doubted], self._held_rotations[doubted] = places[doubted], rotations[doubted]
            self._held[doubted] = number
            believed |= doubted & (self._agreed >= _AGREE)
        self._agreed[seen & believed] = 0
        return believed

    def _follows(self, places: Array, rotations: Array) -> NDArray[np.bool_]:
        """Whether rows go on from their last two good readings, a frame apart, as a body with muscles can (15,)."""
        expected = 2.0 * self._places - self._before
        turned = multiply(multiply(self._rotations, conjugate(self._turned_before)), self._rotations)
        square = self._period * self._period
        return _near((expected, places), (turned, rotations), PUSH * square, TWIST * square)

    def _time(self, merged: Merged) -> float:
        """Seconds since the first frame: by the device's stamps where they fit its frame numbers, else by these."""
        stamps = [reading.stamp for reading in merged.readings.values() if reading.stamp is not None]
        if not stamps:
            return merged.number * self._period
        stamp = sorted(stamps)[len(stamps) // 2]
        if self._stamps is None:
            self._stamps = (stamp - merged.number * self._period, 0.0, merged.number)
        zero, last, frame = self._stamps
        time, expected = stamp - zero, last + (merged.number - frame) * self._period
        if not last <= time <= last + 2.5 * (expected - last):
            zero, time = stamp - expected, expected  # a damaged stamp, or the device's clock was set
        self._stamps = (zero, time, merged.number)
        return time


def _numbers(reading: Reading) -> tuple[float, ...]:
    return (*reading.position, *reading.rotation)
