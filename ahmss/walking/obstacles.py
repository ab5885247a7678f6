"""What a walker keeps clear of: the footprints of things and of other humans, and how near each may be passed where.

A walker's middle keeps its radius from every footprint. Where a walk starts or ends nearer than that, because one
stands at a table to use it, the clearance that the place has is enough there, and grows with the way from it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.errors import AlgorithmError

__all__ = ["NEAREST", "SLOPE", "Ends", "NoWay", "Obstacles", "nearest_free"]

NEAREST = 0.12  # metres from a footprint to the middle of one who stands at it: half a trunk's depth
SLOPE = 0.4  # by how much the clearance grows with the way from a place that lacks it: 24 degrees off an edge
_STEEP = 0.8  # the same for one who starts within a footprint: straight out
_ARRIVING = 1.5  # how much faster it grows from a goal: who arrives turns there, and the feet swing wider than the hips
_BENT = np.array([0.5, 1.0])  # of that growth, what is left where a way bends, near the start and near the goal
_LEVELS = 3  # steps by which that growth is cut from the blocked floor
_QUARTER = 2  # segments of a rounded corner of 90 degrees

Shapes = NDArray[Any]
Indices = NDArray[np.intp]


class NoWay(AlgorithmError):
    """No way leads there; the sentence says why, and where one can go instead.

    It is found when it is read: who waits for a way to become free asks often, and throws it away.
    """

    def __init__(self, sentence: str | Callable[[], str]) -> None:
        super().__init__()
        self._sentence = sentence

    @cached_property
    def _told(self) -> str:
        return self._sentence if isinstance(self._sentence, str) else self._sentence()

    def __str__(self) -> str:
        """The sentence."""
        return self._told


@dataclass(frozen=True)
class Ends:
    """Where things may be nearer: the places (2, 2) of start and goal, the clearance (2, m) from each of m obstacles.

    slopes (2, m): by how much the clearance that is kept grows with the distance from the place, after `along` metres.
    """

    places: Array
    clearances: Array
    slopes: Array
    along: float = 0.0


@dataclass(frozen=True)
class Obstacles:
    """Footprints, m shapes of shapely, with a name each; the walker's radius in metres."""

    shapes: Shapes
    names: tuple[str, ...]
    radius: float

    @classmethod
    def of(
        cls,
        rings: Sequence[Array],
        radius: float,
        circles: Sequence[tuple[float, float, float]] = (),
        names: Sequence[str] = (),
    ) -> Obstacles:
        """From rings (k, 2) and from circles x, y, r."""
        called = [names[i] if i < len(names) else "an obstacle" for i in range(len(rings))]
        shapes = np.concatenate([_of_rings(rings), _of_circles(circles)])
        return cls(shapes, (*called, *["another human"] * len(circles)), radius)

    def nearest_free(self, point: Array) -> Array:
        """The place (2,) nearest to a point (2,) that keeps the radius from them."""
        if not len(self.shapes) or (self.clearance(point) >= self.radius).all():
            return np.array(point, dtype=np.float64)
        return shapely.get_coordinates(shapely.shortest_line(self._edge, shapely.Point(point)))[0]

    @cached_property
    def _edge(self) -> Any:
        """The line around them that keeps the radius, a little farther: round corners are cut by up to 0.5 %."""
        return shapely.boundary(shapely.union_all(_buffered(self.shapes, 1.005 * self.radius, 8)))

    def clearance(self, place: Array) -> Array:
        """(m,) metres from a place (2,) to each footprint; negative within it: the way out."""
        return self.signed(np.arange(len(self.shapes)), np.broadcast_to(place, (len(self.shapes), 2)))

    def signed(self, which: Indices, points: Array) -> Array:
        """(n,) metres from points (n, 2) to the obstacles numbered `which`, each to its own; negative within it."""
        shapes, places = self.shapes[which], shapely.points(points)
        away = np.array(shapely.distance(shapes, places), dtype=np.float64)
        inside = np.flatnonzero(away <= 0.0)
        if len(inside):
            away[inside] = -shapely.distance(shapely.boundary(shapes[inside]), np.asarray(places)[inside])
        return away

    def ends(self, start: Array, goal: Array, slope: float = SLOPE, along: float = 0.0) -> Ends:
        """What the two places of a walk allow: so many metres along things, then off them so steeply."""
        near = np.stack([self.clearance(start), self.clearance(goal)])
        grows = slope * np.array([[1.0], [_ARRIVING]])
        return Ends(np.stack([start, goal]), near, np.where(near < NEAREST / 2, _STEEP, grows), along)

    def left(self, ends: Ends) -> NDArray[np.bool_]:
        """(m,) which obstacles the start lies within."""
        return ends.clearances[0] <= 0.0

    def leaving(self, points: Array, which: Indices, ends: Ends) -> NDArray[np.bool_]:
        """(n,) whether points (n, 2) are on the way out of what the start lies within, each of its own obstacle."""
        away = np.linalg.norm(points - ends.places[0], axis=-1)
        return self.left(ends)[which] & (away < 1.5 * (self.radius - ends.clearances[0, which]))

    def needed(self, points: Array, which: Indices, ends: Ends, full: float) -> tuple[Array, Array]:
        """The clearance (n,) that points (n, 2) are to have from the obstacles numbered `which`; its gradient (n, 2).

        full: what it is away from the ends, metres.
        """
        off = points[:, None, :] - ends.places
        away = np.linalg.norm(off, axis=-1)
        slope = ends.slopes.T[which] * np.where(ends.clearances.T[which] > 0.0, _BENT, 1.0)
        grown = ends.clearances.T[which] + slope * np.maximum(away - ends.along, 0.0)
        end, rows = np.argmin(grown, axis=-1), np.arange(len(points))
        least = grown[rows, end]
        grows = (least < full) & (away[rows, end] > ends.along)
        rate = np.where(grows, slope[rows, end], 0.0) / np.maximum(away[rows, end], 1e-9)
        return np.minimum(full, least), rate[:, None] * off[rows, end]

    def blocked(self, ends: Ends) -> Shapes:
        """(m,) for each obstacle the floor where the walker's middle may not be."""
        wide: Shapes = np.asarray(_buffered(self.shapes, self.radius))
        left = self.left(ends)
        for end, i in np.argwhere((ends.clearances < self.radius + 0.005) & ~left):
            wide[i] = self._opened(wide[i], int(i), ends, int(end))
        if left.any():
            wide[left] = shapely.difference(wide[left], self._way_out(ends.places[0], wide, left))
        return wide

    def _way_out(self, start: Array, wide: Shapes, left: NDArray[np.bool_]) -> Any:
        """The shortest way out of what the start lies within that leads through nothing else, a little wide."""
        rim = shapely.segmentize(shapely.boundary(shapely.union_all(wide[left])), 0.1)
        nearest = shapely.get_coordinates(shapely.shortest_line(rim, shapely.Point(start)))[:1]
        exits = np.concatenate([nearest, shapely.get_coordinates(rim)])
        exits = start + (exits - start) * 1.02
        ways = np.asarray(shapely.linestrings(np.stack([np.broadcast_to(start, exits.shape), exits], axis=1)))
        shut = shapely.intersects(shapely.union_all(self.shapes[~left]), ways)
        shut |= shapely.intersects(shapely.union_all(wide[~left]), shapely.points(exits))
        return _buffered(ways[np.argmin(np.where(shut, np.inf, shapely.length(ways)))], 0.02)

    def _opened(self, wide: Any, i: int, ends: Ends, end: int) -> Any:
        """Blocked floor of obstacle i without what may be used around one of the ends."""
        clearance, slope = ends.clearances[end, i], ends.slopes[end, i]
        reach = (self.radius - clearance) / slope + 0.03
        for level in range(_LEVELS):
            open_to = ends.along + reach * (level + 1) / _LEVELS
            disc = shapely.buffer(shapely.Point(ends.places[end]), open_to, quad_segs=4)
            kept = clearance - 0.01 + slope * reach * level / _LEVELS
            wide = shapely.difference(wide, shapely.difference(disc, _buffered(self.shapes[i], kept)))
        return wide

    @cached_property
    def edges(self) -> tuple[Shapes, Indices]:
        """All edges of the footprints as lines, and the number of the obstacle of each."""
        rings, whose = shapely.get_rings(self.shapes, return_index=True)
        points, ring = shapely.get_coordinates(rings, return_index=True)
        joined = ring[1:] == ring[:-1]
        lines = shapely.linestrings(np.stack([points[:-1][joined], points[1:][joined]], axis=1))
        return np.asarray(lines), np.asarray(whose[ring[:-1][joined]], dtype=np.intp)


def nearest_free(point: Array, obstacles: Sequence[Array], radius: float) -> Array:
    """The place (2,) nearest to a point (2,) that keeps a radius (metres) from obstacles, rings (k, 2)."""
    return Obstacles.of(obstacles, radius).nearest_free(point)


def _buffered(shapes: Any, width: float, quarter: int = _QUARTER) -> Any:
    return shapely.buffer(shapes, width, quad_segs=quarter)


def _of_rings(rings: Sequence[Array]) -> Shapes:
    """Polygons of rings; what has no area, or crosses itself, is as wide as 2 mm."""
    sizes = np.array([len(ring) for ring in rings], dtype=int)
    shapes = np.empty(len(rings), dtype=object)
    proper = sizes >= 3
    if proper.any():
        points = np.concatenate([ring for ring in rings if len(ring) >= 3])
        shapes[proper] = shapely.polygons(
            shapely.linearrings(points, indices=np.repeat(np.arange(proper.sum()), sizes[proper]))
        )
    for i in map(int, np.flatnonzero(~proper)):
        shapes[i] = shapely.MultiPoint(rings[i]).convex_hull
    for i in np.flatnonzero(~shapely.is_valid(shapes) | (shapely.area(shapes) < 1e-6)):
        shapes[i] = _buffered(shapely.make_valid(shapes[i]), 0.001)
    return shapes


def _of_circles(circles: Sequence[tuple[float, float, float]]) -> Shapes:
    """Polygons of 16 corners around circles x, y, r."""
    if not circles:
        return np.empty(0, dtype=object)
    angles = np.arange(16) * (np.pi / 8)
    corners = np.stack([np.cos(angles), np.sin(angles)], axis=-1) / np.cos(np.pi / 16)
    table = np.asarray(circles, dtype=np.float64)
    return np.asarray(shapely.polygons(table[:, None, :2] + table[:, None, 2:] * corners))
