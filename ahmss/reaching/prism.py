"""What may be in a hand's way, as upright prisms: the outline of a thing seen from above, from its bottom to its top.

A table is a block of its own height: a hand goes over its top, not through it, and nobody reaches under it. What
slopes, as a console's plate does, is cut off by planes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import shapely

from ahmss.body.array import Array

__all__ = ["Prism", "clearance", "in_the_way", "over_hand"]

_NEAR = 1.5  # metres from a human's middle beyond which nothing is in a hand's way
_UNDER = 0.15  # metres: how far under a thing's edge a hand comes out again sideways
_TINY = 1e-9  # metres
_RISES, _LID = 0.04, 0.04  # metres: by which a hand may rise under it; how thick what is over it is at least


@dataclass(frozen=True, eq=False)
class Prism:
    """An outline (n, 2) in the world, and the heights between which the thing is, metres.

    sought: whether it is what is reached for, which fingers come close to.
    cuts: (k, 4) planes beyond which there is nothing of it: a unit vector out of it, and how far along it is.
    """

    ring: Array
    low: float
    high: float
    sought: bool = False
    cuts: Array | None = None

    def signed(self, points: Array) -> Array:
        """The distance (...) of points (..., 3) from it; negative within: how far the way out is.

        Beside an edge at which it is cut off it may be told to be nearer than it is.
        """
        flat = points.reshape(-1, 3)
        made = self._made
        places = np.asarray(shapely.points(flat[:, :2]))
        level = np.asarray(shapely.distance(made.shape, places), np.float64)
        inside = np.flatnonzero(level <= 0.0)
        if len(inside):
            level[inside] = -np.asarray(shapely.distance(made.boundary, places[inside]), np.float64)
        upright = np.maximum(flat[:, 2] - self.high, self.low - flat[:, 2])
        both = np.hypot(np.maximum(level, 0.0), np.maximum(upright, 0.0))
        away = np.where((level < 0.0) & (upright < 0.0), np.maximum(level, upright), both)
        return (away if self.cuts is None else np.maximum(away, self._beyond(flat).max(axis=-1))).reshape(
            points.shape[:-1]
        )

    def way_out(self, point: Array) -> Array:
        """The unit vector (3,) along which a point (3,) comes away from it soonest, or is away from it already."""
        made, place = self._made, shapely.points(point[:2])
        line = shapely.get_coordinates(shapely.shortest_line(made.boundary, place))
        off = line[1] - line[0]
        inside = bool(shapely.contains(made.shape, place))
        level = float(np.hypot(*off)) * (-1.0 if inside else 1.0)
        upright = max(float(point[2]) - self.high, self.low - float(point[2]))
        up = np.array([0.0, 0.0, 1.0 if point[2] - self.high > self.low - point[2] else -1.0])
        aside = np.array([*off, 0.0]) / (level if abs(level) > _TINY else _TINY)
        both = max(level, 0.0) * aside + max(upright, 0.0) * up
        length = float(np.linalg.norm(both))
        if self.cuts is not None:
            beyond = self._beyond(point[None])[0]
            if beyond.max() > (length if length > _TINY else max(level, upright)):
                return self.cuts[int(beyond.argmax()), :3]
        if length > _TINY:
            return both / length
        return aside if level > upright else up

    def tops(self, points: Array) -> Array:
        """How high (n) it is at points (n, 2) or (n, 3) of its outline."""
        high = np.full(len(points), self.high)
        for x, y, z, along in () if self.cuts is None else self.cuts:
            if z > 0.0:
                high = np.minimum(high, (along - points[:, 0] * x - points[:, 1] * y) / z)
        return high

    def at_least(self, points: Array) -> Array:
        """The distance (n) of points (n, 3) from the upright box around it, which it is away by at least; 0 within."""
        low, high = self._made.box
        off = np.maximum(np.maximum(low - points, points - high), 0.0)
        return np.sqrt(np.einsum("ni,ni->n", off, off))

    def is_beyond(self, low: Sequence[float], high: Sequence[float]) -> bool:
        """Whether the upright box around it does not meet the one from a lowest to a highest corner (3)."""
        (x, y, z), (x1, y1, z1) = self._made.corners  # one by one: it is asked often, of many
        return x > high[0] or y > high[1] or z > high[2] or x1 < low[0] or y1 < low[1] or z1 < low[2]

    def meets(self, low: Array, high: Array) -> bool:
        """Whether the upright box around it meets the one from a lowest to a highest corner (3,)."""
        return not self.is_beyond(low.tolist(), high.tolist())

    def over(self, points: Array) -> Any:
        """Whether points (n, 2) or (n, 3) are within its outline, seen from above."""
        return shapely.contains_xy(self._made.shape, points[:, 0], points[:, 1])

    def from_outline(self, points: Array) -> Array:
        """How far points (n, 3) are from its outline's line, level."""
        return np.asarray(shapely.distance(self._made.boundary, shapely.points(points[:, :2])), np.float64)

    def _beyond(self, points: Array) -> Array:
        """How far points (n, 3) are beyond each of the planes (n, k)."""
        assert self.cuts is not None
        return points @ self.cuts[:, :3].T - self.cuts[:, 3]

    @cached_property
    def _made(self) -> _Made:
        shape = shapely.make_valid(shapely.Polygon(self.ring))
        boundary = shapely.boundary(shape)
        shapely.prepare([shape, boundary])
        low, high = self.ring.min(axis=0), self.ring.max(axis=0)
        box = np.append(low, self.low), np.append(high, self.high)
        return _Made(shape, boundary, box, (tuple(box[0].tolist()), tuple(box[1].tolist())))


class _Made(NamedTuple):
    """What distances from a prism are measured by: its outline, that one's line, and the lowest and highest corner."""

    shape: Any
    boundary: Any
    box: tuple[Array, Array]
    corners: tuple[tuple[float, float, float], tuple[float, float, float]]  # the same as floats


def clearance(prisms: Sequence[Prism], points: Array, within: float = np.inf) -> Array:
    """The distance (...) of points (..., 3) from the nearest of some prisms; far away where there are none.

    within: metres beyond which nobody asks for it exactly: what is farther may be told to be anywhere beyond.
    """
    flat = points.reshape(-1, 3)
    nearest = np.full(len(flat), np.inf)
    if not len(flat):
        return nearest.reshape(points.shape[:-1])
    low, high = (flat.min(axis=0) - within).tolist(), (flat.max(axis=0) + within).tolist()
    for prism in prisms:
        if prism.is_beyond(low, high):
            continue
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
    places = np.stack(ends)
    x, y = middle[:2].tolist()
    low, high = (x - _NEAR, y - _NEAR, -np.inf), (x + _NEAR, y + _NEAR, np.inf)
    for prism in prisms:
        if prism.is_beyond(low, high):
            continue
        level = np.append(middle[:2], prism.low)
        if prism.at_least(level[None])[0] < _NEAR and (clearance([prism], places, 0.0) > 0.0).all():
            kept.append(prism)
    return kept


def over_hand(prism: Prism, middle: Array, points: Array, radii: Array) -> Prism | None:
    """What of a thing is in the way of a hand with skin of such radii (n) around points (n, 3).

    All of it, but where the hand is in its prism: a hand under the edge of a table comes out as it came in,
    what is over it is in its way. Nothing of what one is in or sits on oneself, seen from the middle (3,) of the body,
    or has a hand deep in, as in a basin: None.
    """
    inside = prism.over(points) & (points[:, 2] < prism.tops(points)) & (points[:, 2] > prism.low)
    if not inside.any():
        return prism
    if prism.over(middle[None])[0] or prism.from_outline(points[inside]).max() > _UNDER:
        return None
    return replace(prism, low=min(float((points[:, 2] + radii)[inside].max()) + _RISES, prism.high - _LID))
