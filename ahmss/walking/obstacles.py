"""What a walker keeps clear of: the footprints of things and of other humans, and how near each may be passed where.

A walker's middle keeps its radius from every footprint. Where a walk starts or ends nearer than that, because one
stands at a table to use it, the clearance that the place has is enough there, and grows with the way from it.
"""

from __future__ import annotations

from collections.abc import Sequence
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
_LEVELS = 3  # steps by which that growth is cut from the blocked floor
_QUARTER = 2  # segments of a rounded corner of 90 degrees

Shapes = NDArray[Any]
Indices = NDArray[np.intp]


class NoWay(AlgorithmError):
    """No way leads there; the sentence says why, and where one can go instead."""


@dataclass(frozen=True)
class Ends:
    """Where things may be nearer: the places (2, 2) of start and goal, the clearance (2, m) from each of m obstacles.

    slopes (2, m): by how much the clearance that is kept grows with the distance from the place.
    """

    places: Array
    clearances: Array
    slopes: Array


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

    def clearance(self, place: Array) -> Array:
        """(m,) metres from a place (2,) to each footprint; negative within it: the way out."""
        point = shapely.Point(place)
        away = np.array(shapely.distance(self.shapes, point), dtype=np.float64)
        for i in np.flatnonzero(away <= 0.0):
            away[i] = -shapely.distance(shapely.boundary(self.shapes[i]), point)
        return away

    def ends(self, start: Array, goal: Array, slope: float = SLOPE) -> Ends:
        """What the two places of a walk allow."""
        near = np.stack([self.clearance(start), self.clearance(goal)])
        return Ends(np.stack([start, goal]), near, np.where(near < NEAREST / 2, _STEEP, slope))

    def needed(self, points: Array, which: Indices, ends: Ends) -> Array:
        """The clearance (...) that points (..., 2) are to have from the obstacles numbered `which` (...)."""
        away = np.linalg.norm(points[..., None, :] - ends.places, axis=-1)
        grown = ends.clearances.T[which] + ends.slopes.T[which] * away
        return np.minimum(self.radius, grown.min(axis=-1))

    def blocked(self, ends: Ends) -> Shapes:
        """(m,) for each obstacle the floor where the walker's middle may not be."""
        wide: Shapes = np.asarray(shapely.buffer(self.shapes, self.radius, quad_segs=_QUARTER))
        for end in range(2):
            for i in np.flatnonzero(ends.clearances[end] < self.radius + 0.005):
                wide[i] = self._opened(wide[i], int(i), ends, end)
        return wide

    def _opened(self, wide: Any, i: int, ends: Ends, end: int) -> Any:
        """Blocked floor of obstacle i without what may be used around one of the ends."""
        clearance, slope = ends.clearances[end, i], ends.slopes[end, i]
        reach = (self.radius - clearance) / slope + 0.03
        for level in range(_LEVELS):
            disc = shapely.buffer(shapely.Point(ends.places[end]), reach * (level + 1) / _LEVELS, quad_segs=4)
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
    around = Obstacles.of(obstacles, radius)
    if not len(obstacles) or (around.clearance(point) >= radius).all():
        return np.array(point, dtype=np.float64)
    wide = shapely.union_all(_buffered(around.shapes, 1.005 * radius, 8))  # as round corners are cut by up to 0.5 %
    return shapely.get_coordinates(shapely.shortest_line(shapely.boundary(wide), shapely.Point(point)))[0]


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
