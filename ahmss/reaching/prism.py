"""What may be in a hand's way, as upright prisms: the outline of a thing seen from above, from its bottom to its top.

A table is a block of its own height: a hand goes over its top, not through it, and nobody reaches under it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from ahmss.body.array import Array

__all__ = ["Prism", "clearance", "in_the_way"]

_NEAR = 1.5  # metres from a human's middle beyond which nothing is in a hand's way


@dataclass(frozen=True, eq=False)
class Prism:
    """An outline (n, 2) in the world, and the heights between which the thing is, metres.

    sought: whether it is what is reached for, which fingers come close to.
    """

    ring: Array
    low: float
    high: float
    sought: bool = False

    def signed(self, points: Array) -> Array:
        """The distance (...) of points (..., 3) from it; negative within: how far the way out is."""
        flat = points.reshape(-1, 3)
        shape = self._shape()
        places = np.asarray(shapely.points(flat[:, :2]))
        level = np.asarray(shapely.distance(shape, places), np.float64)
        inside = np.flatnonzero(level <= 0.0)
        if len(inside):
            level[inside] = -np.asarray(shapely.distance(shapely.boundary(shape), places[inside]), np.float64)
        upright = np.maximum(flat[:, 2] - self.high, self.low - flat[:, 2])
        both = np.hypot(np.maximum(level, 0.0), np.maximum(upright, 0.0))
        return np.where((level < 0.0) & (upright < 0.0), np.maximum(level, upright), both).reshape(points.shape[:-1])

    def _shape(self) -> Any:
        if "made" not in self.__dict__:
            made = shapely.make_valid(shapely.Polygon(self.ring))
            shapely.prepare(made)
            self.__dict__["made"] = made
        return self.__dict__["made"]


def clearance(prisms: Sequence[Prism], points: Array) -> Array:
    """The distance (...) of points (..., 3) from the nearest of some prisms; far away where there are none."""
    nearest = np.full(points.shape[:-1], np.inf)
    for prism in prisms:
        nearest = np.minimum(nearest, prism.signed(points))
    return nearest


def in_the_way(prisms: Sequence[Prism], middle: Array, *ends: Array) -> list[Prism]:
    """Of prisms those near a human's middle (2,) or (3,) that hold none of the ends (3,) of a hand's way.

    What a hand is to come into (a shelf), or is in already (a chair that is sat on), can't be kept clear of.
    """
    kept: list[Prism] = []
    for prism in prisms:
        away = np.maximum(prism.ring.min(axis=0) - middle[:2], middle[:2] - prism.ring.max(axis=0))
        if np.hypot(*np.maximum(away, 0.0)) < _NEAR and all(prism.signed(end) > 0.0 for end in ends):
            kept.append(prism)
    return kept
