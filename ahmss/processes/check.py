"""What main takes from an algorithm: poses that are finite, unit, and the ones it asked for."""

from __future__ import annotations

import math

import numpy as np

from ahmss.algorithm.messages import POSE, TARGETS, size
from ahmss.body.array import Array
from ahmss.body.links import LINKS
from ahmss.errors import ProtocolError

__all__ = ["check_human", "check_object"]

_POSE = size(POSE)
_TOLERANCE = 1e-3  # how far from 1 the squared length of a quaternion may be
_LARGEST = 1e8  # no place, no frame is so far


def check_human(row: Array, k: int) -> None:
    """A POSE row (260,), or (272,) with a way: k as asked, quaternions unit, importances >= 0, targets sensible.

    All numbers must be finite; a way may be NaN as a whole, where it is not known.

    Raises:
        ProtocolError: names what is wrong and where.
    """
    if len(row) > _POSE:
        _check_way(row[_POSE:])
        row = row[:_POSE]
    _check_frame(row, k)
    rotations = row[4:176].reshape(43, 4)
    off = np.vecdot(rotations, rotations) - 1.0
    if off.dot(off) > _TOLERANCE**2:
        _check_lengths(off)
    rest = row[176:].tolist()  # plain numbers: for a handful of them faster than arrays
    importance = rest[:44]
    if min(importance) < 0.0:
        worst = importance.index(min(importance))
        joint = "root" if worst == len(LINKS) else LINKS[worst]
        raise ProtocolError(f"the importance of {joint} is {importance[worst]:.3g}; it can't be negative")
    _check_targets(rest[44:])


def check_object(row: Array, k: int) -> None:
    """An OBJECT row (8,): k as asked, all numbers finite, the quaternion unit.

    Raises:
        ProtocolError: names what is wrong.
    """
    _check_frame(row, k)
    w, x, y, z = row[4:].tolist()
    square = w * w + x * x + y * y + z * z
    if abs(square - 1.0) > _TOLERANCE:
        raise ProtocolError(f"the object's rotation has length {math.sqrt(square):.3g}, not 1")


def _check_frame(row: Array, k: int) -> None:
    """That all numbers are finite and no larger than can be meant, and that it is the frame asked for."""
    # A dot product is several times quicker than the reductions that then say what is wrong, and where.
    with np.errstate(all="ignore"):
        if row.dot(row) < _LARGEST**2 and row[0] == k:
            return
    bad = int(np.argmax(~(np.abs(row) < _LARGEST)))
    if not abs(row[bad]) < _LARGEST:
        raise ProtocolError(f"number {bad} of its pose is {row[bad]:g}")
    raise ProtocolError(f"it sent frame {row[0]:g} where frame {k} was asked for")


def _check_way(way: Array) -> None:
    """That all numbers are finite and no larger than can be meant, or all of them NaN."""
    with np.errstate(all="ignore"):
        if way.dot(way) < _LARGEST**2:
            return
    bad = ~(np.abs(way) < _LARGEST)
    if not np.isnan(way).all():
        first = int(np.argmax(bad))
        raise ProtocolError(f"number {first} of its way is {way[first]:g}; metres are expected, or NaN for all twelve")


def _check_lengths(off: Array) -> None:
    """That no squared length is off by more than the tolerance; off (43,)."""
    worst = int(np.argmax(np.abs(off)))
    if abs(off[worst]) > _TOLERANCE:
        raise ProtocolError(f"the rotation of {LINKS[worst]} has length {math.sqrt(off[worst] + 1.0):.3g}, not 1")


def _check_targets(numbers: list[float]) -> None:
    """Weights from 0 to 1, rotations unit or all zero."""
    for row, name in enumerate(TARGETS):
        w, x, y, z, weight = numbers[8 * row + 3 : 8 * row + 8]
        if not 0.0 <= weight <= 1.0:
            raise ProtocolError(f"the weight of target {name} is {weight:.3g}; 0 to 1 is allowed")
        square = w * w + x * x + y * y + z * z
        if square != 0.0 and not -_TOLERANCE <= square - 1.0 <= _TOLERANCE:
            length = math.sqrt(square)
            raise ProtocolError(f"the rotation of target {name} has length {length:.3g}, not 1 (or all 0: free)")
