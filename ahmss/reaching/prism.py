"""What may be in a hand's way, as upright prisms: the outline of a thing seen from above, from its bottom to its top.

A table is a block of its own height: a hand goes over its top, not through it, and nobody reaches under it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

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
        made = self._made
        places = np.asarray(shapely.points(flat[:, :2]))
        level = np.asarray(shapely.distance(made.shape, places), np.float64)
        inside = np.flatnonzero(level <= 0.0)
        if len(inside):
            level[inside] = -np.asarray(shapely.distance(made.boundary, places[inside]), np.float64)
        upright = np.maximum(flat[:, 2] - self.high, self.low - flat[:, 2])
        both = np.hypot(np.maximum(level, 0.0), np.maximum(upright, 0.0))
        return np.where((level < 0.0) & (upright < 0.0), np.maximum(level, upright), both).reshape(points.shape[:-1])

    def at_least(self, points: Array) -> Array:
        """The distance (n) of points (n, 3) from the upright box around it, which it is away by at least; 0 within."""
        low, high = self._made.box
        off = np.maximum(np.maximum(low - points, points - high), 0.0)
        return np.sqrt(np.einsum("ni,ni->n", off, off))

    @cached_property
    def _made(self) -> _Made:
        shape = shapely.make_valid(shapely.Polygon(self.ring))
        boundary = shapely.boundary(shape)
        shapely.prepare([shape, boundary])
        low, high = self.ring.min(axis=0), self.ring.max(axis=0)
        return _Made(shape, boundary, (np.append(low, self.low), np.append(high, self.high)))


class _Made(NamedTuple):
    """What distances from a prism are measured by: its outline, that one's line, and the lowest and highest corner."""

    shape: Any
    boundary: Any
    box: tuple[Array, Array]


def clearance(prisms: Sequence[Prism], points: Array, within: float = np.inf) -> Array:
    """The distance (...) of points (..., 3) from the nearest of some prisms; far away where there are none.

    within: metres beyond which nobody asks for it exactly: what is farther may be told to be anywhere beyond.
    """
    flat = points.reshape(-1, 3)
    nearest = np.full(len(flat), np.inf)
    for prism in prisms:
        away = prism.at_least(flat)
        near = np.flatnonzero((away < np.minimum(nearest, within)) | (away <= 0.0))
        if len(near):
            nearest[near] = np.minimum(nearest[near], prism.signed(flat[near]))
    return nearest.reshape(points.shape[:-1])


def in_the_way(prisms: Sequence[Prism], middle: Array, *ends: Array) -> list[Prism]:
    """Of prisms those near a human's middle (2,) or (3,) that hold none of the ends (3,) of a hand's way.

    What a hand is to come into (a shelf), or is in already (a chair that is sat on), can't be kept clear of.
    """
    kept: list[Prism] = []
    for prism in prisms:
        level = np.append(middle[:2], prism.low)
        if prism.at_least(level[None])[0] < _NEAR and (clearance([prism], np.stack(ends)) > 0.0).all():
            kept.append(prism)
    return kept
