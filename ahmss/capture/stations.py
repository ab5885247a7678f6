"""What a tracker gives: readings of single stations, and frames of all fifteen."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import msgspec
import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.links import LINKS

__all__ = ["TRACKED", "Quaternion", "Reading", "Status", "TrackerFrame", "Vector"]

TRACKED: tuple[str, ...] = LINKS[:15]
"""The links that carry a sensor, in the one order of all frames and takes (Ichiguchi 2000, 5.3.1)."""

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


class Status(IntEnum):
    """What a row of a frame is worth."""

    GOOD = 0
    WEAK = 1
    """The device marked it: the sensor is far from the transmitter, or something disturbs the field."""
    MISSING = 2
    """Nothing came, or it was damaged: the row repeats the station's last good values."""
    IMPLAUSIBLE = 3
    """A record came and parsed, but no body moves like that: the row repeats the station's last good values."""


class Reading(msgspec.Struct, frozen=True, gc=False):
    """One record of one station.

    station: 1 and up, as the device counts.
    status: "" is good; a letter is what the device says is wrong, such as a weak signal.
    position: metres, in the transmitter's frame.
    rotation: unit quaternion wxyz, transmitter <- sensor.
    count: the device's own frame number, where its records have one.
    stamp: the device's own time, seconds, where its records have one.
    arrival: seconds of this machine's monotonic clock.
    """

    station: int
    status: str
    position: Vector
    rotation: Quaternion
    count: int | None = None
    stamp: float | None = None
    arrival: float = 0.0


@dataclass(frozen=True, eq=False)
class TrackerFrame:
    """All fifteen stations at one time, in the order of `TRACKED`.

    number: 0 and up, one step a frame of the device; a number left out is a frame that was lost whole.
    time: seconds since the first frame: the device's own clock or frame number where it sends one, else the arrival.
    rotations: (15, 4) unit quaternions wxyz, transmitter <- sensor, each on the hemisphere of its predecessor.
    positions: (15, 3) metres in the transmitter's frame.
    status: (15,) uint8, the values of `Status`.
    arrival: monotonic seconds at which the last byte of the frame came.
    """

    number: int
    time: float
    rotations: Array
    positions: Array
    status: NDArray[np.uint8]
    arrival: float
