"""A human's way: where they mean to be soon, so that others need not guess it from how they move.

A way comes with a frame and says where the hips will be on the floor at each of `AHEAD` from it: (6, 2) metres in the
world. Who waits tells their own place six times; who walks to a goal stays there once they have come to it. NaN
everywhere: it is not known.
"""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array

__all__ = ["AHEAD", "UNKNOWN", "WAY_WIDTH", "known", "staying", "ways_of"]

AHEAD: Array = np.array([0.4, 0.8, 1.2, 1.6, 2.0, 2.4])
"""Seconds from the frame that a way comes with."""

WAY_WIDTH = 2 * len(AHEAD)
"""Numbers of one way, x and y at each of `AHEAD`."""

UNKNOWN: Array = np.full((len(AHEAD), 2), np.nan)
"""The way of who tells none; not to be written to."""

AHEAD.flags.writeable = UNKNOWN.flags.writeable = False


def known(numbers: Array) -> Array | None:
    """A way (6, 2) of its numbers (12,), as a view; None where it is not known."""
    return None if np.isnan(numbers[0]) else numbers.reshape(-1, 2)


def staying(place: Array) -> Array:
    """The way (6, 2) of who stays at a place (2,)."""
    return np.repeat(place[None], len(AHEAD), axis=0)


def ways_of(level: Array, first: int, end: int, rate: float) -> Array:
    """The ways (n, 6, 2) told with the frames from `first` to the one before `end`, of so many a second, by hips that
    will be at `level` (F, 2), and stay at its end.
    """
    ahead = np.round(AHEAD * rate).astype(np.intp)
    return level[np.minimum(np.arange(first, end)[:, None] + ahead, len(level) - 1)]
