"""How deep points on the floor are in outlines, and the way out: a few hundred points at once, many times."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array

__all__ = ["Fence"]


@dataclass(frozen=True)
class Fence:
    """Outlines (n, 2), which need not be closed, metres.

    within: how far points that matter are from them. tops: how high the things are, as many; none: all are high.
    """

    outlines: Sequence[Array]
    within: float
    tops: Sequence[float] = ()

    def away(self, points: Array, lows: Array | float = 0.0) -> tuple[Array, Array]:
        """How far points (n, 2) are from the nearest outline (n,), negative within it, and the way outwards (n, 2).

        What is further from all than `within` is said to be just that far from them, and what is over them too.

        Args:
            points: metres.
            lows: (n,) how high the lowest of what is there is.
        """
        away, out = np.full(len(points), self.within), np.zeros(points.shape)
        for number, ring in enumerate(self.outlines):
            low, high = ring.min(axis=0) - self.within, ring.max(axis=0) + self.within
            close = ((points > low) & (points < high)).all(axis=-1)
            if self.tops:
                close &= lows < self.tops[number]
            about = np.flatnonzero(close)
            if not len(about):
                continue
            signed, outwards = _from_ring(ring, points[about])
            nearer = signed < away[about]
            away[about[nearer]], out[about[nearer]] = signed[nearer], outwards[nearer]
        return away, out


def _from_ring(ring: Array, points: Array) -> tuple[Array, Array]:
    """The same for one outline."""
    along, across = (np.roll(ring, -1, axis=0) - ring).T
    x, y = points[:, :1] - ring[:, 0], points[:, 1:] - ring[:, 1]
    share = np.clip((x * along + y * across) / np.maximum(along**2 + across**2, 1e-12), 0.0, 1.0)
    off_x, off_y = x - share * along, y - share * across
    square = off_x * off_x + off_y * off_y
    crossed = ((y < 0.0) != (y < across)) & ((x * across < y * along) == (across > 0.0))  # by the line ahead of it
    inside = np.count_nonzero(crossed, axis=1) % 2 == 1
    rows, nearest = np.arange(len(points)), square.argmin(axis=1)
    signed = np.sqrt(square[rows, nearest]) * np.where(inside, -1.0, 1.0)
    out = np.stack([off_x[rows, nearest], off_y[rows, nearest]], axis=-1)
    return signed, out / np.where(np.abs(signed) > 1e-9, signed, 1e-9)[:, None]
