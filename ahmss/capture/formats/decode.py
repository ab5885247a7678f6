"""From the numbers of records to readings: units, Euler angles, and every check that a single record allows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.euler import from_euler
from ahmss.capture.formats.losses import Losses
from ahmss.capture.stations import Reading

__all__ = ["BINARY", "PRINTED", "REACH", "Columns", "Raw", "doubles", "readings"]

PRINTED, BINARY = 2.5e-4, 1e-4
"""How far a quaternion's length may be from 1: four printed decimals put it off by 1e-4, a float32 by less."""

REACH = 9.2
"""How far from the transmitter a sensor can be, metres: 30 feet, the longest range that is sold."""


@dataclass(frozen=True)
class Columns:
    """Where in a record's numbers the position (3) and the orientation (3 Euler angles or 4 of a quaternion) begin.

    unit: how far the quaternion's length may be from 1.
    """

    position: int
    orientation: int
    euler: bool
    unit: float = BINARY


@dataclass(frozen=True, eq=False)
class Raw:
    """Records as they stand in the stream: n of them.

    values: (n, k) numbers in the device's units. counts, stamps: the device's frame numbers and milliseconds, or None.
    """

    stations: list[int]
    statuses: list[str]
    values: Array
    counts: list[int] | None = None
    stamps: list[int] | None = None


def doubles(numbers: NDArray[np.float32]) -> Array:
    """As float64; damaged bytes may be signalling NaNs, over which numpy would warn."""
    with np.errstate(invalid="ignore"):
        return numbers.astype(float)


def readings(raw: Raw, columns: Columns, metres: float, losses: Losses, arrival: float) -> list[Reading]:
    """The readings of those records whose values can be; the others are counted as damaged.

    Args:
        raw: the records.
        columns: which numbers are what.
        metres: the length of the device's unit.
        losses: counts `records` and `damaged`.
        arrival: when their last byte came, monotonic seconds.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        positions = raw.values[:, columns.position : columns.position + 3] * metres
    rotations, possible = _rotations(raw.values[:, columns.orientation :], columns)
    with np.errstate(over="ignore", invalid="ignore"):
        possible &= np.einsum("ij,ij->i", positions, positions) <= REACH * REACH
    losses.records += int(possible.sum())
    losses.damaged += len(possible) - int(possible.sum())
    nothing: list[None] = [None] * len(possible)
    rows = zip(
        possible.tolist(),
        raw.stations,
        raw.statuses,
        positions.tolist(),
        rotations.tolist(),
        raw.counts or nothing,
        raw.stamps or nothing,
        strict=True,
    )
    return [
        Reading(station, status, tuple(place), tuple(turn), count, stamp and 1e-3 * stamp, arrival)
        for good, station, status, place, turn, count, stamp in rows
        if good
    ]


def _rotations(numbers: Array, columns: Columns) -> tuple[Array, NDArray[np.bool_]]:
    """Unit quaternions (n, 4), and which of them (n,) come from possible numbers."""
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        if columns.euler:
            possible = np.all(np.abs(numbers[:, :3]) <= (180.01, 90.01, 180.01), axis=1)
            return from_euler(np.radians(numbers[:, :3])), possible
        length = np.sqrt(np.einsum("ij,ij->i", numbers[:, :4], numbers[:, :4]))
        return numbers[:, :4] / length[:, None], np.abs(length - 1.0) <= columns.unit
