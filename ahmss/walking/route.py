"""The shortest way round what is blocked: a graph of corners that see each other (Lozano-Pérez and Wesley 1979).

Most of a room lies aside of a way. So only what the way so far runs through enters the graph, until it runs through
nothing: a shortest way among some of the obstacles that is free of all of them is the shortest among all.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from ahmss.body.array import Array

__all__ = ["shortest", "walls_around"]

_OFF = 1e-3  # metres by which a corner of the way stands off the blocked floor's
_SKEW = 5e-3  # radians by which a leg may cut a corner all the same
_TURN = 0.1  # metres that a whole turn about at the start is worth: of two ways as long, the one ahead is taken

Shapes = NDArray[Any]


def shortest(start: Array, goal: Array, blocked: Shapes, start_heading: float | None = None) -> Array | None:
    """The corners (k, 2) of the shortest way from start to goal past all polygons; None: there is none."""
    tree = shapely.STRtree(blocked)
    taken = np.zeros(len(blocked), dtype=bool)
    way: Array | None = np.stack([start, goal])
    corners = np.zeros((0, 3, 2))
    while True:
        met = np.unique(tree.query(_legs(way[:-1], way[1:]), predicate="intersects")[1])
        fresh = met[~taken[met]]
        if not len(fresh):
            return way
        taken[fresh] = True
        corners = np.concatenate([corners, *(_corners(blocked[i]) for i in fresh)])
        buried, under = tree.query(shapely.points(_stood_off(corners)), predicate="intersects")
        corners = np.delete(corners, buried[taken[under]], axis=0)
        way = _through(start, goal, corners, blocked[taken], start_heading)
        if way is None:
            return None


def walls_around(place: Array, blocked: Shapes) -> tuple[Any, list[int]]:
    """The floor (a polygon) that can be reached from a place (2,), and the numbers of the obstacles that bound it."""
    union = shapely.union_all(blocked)
    xmin, ymin, xmax, ymax = shapely.total_bounds(np.array([union, shapely.Point(place)], dtype=object))
    parts = shapely.get_parts(shapely.difference(shapely.box(xmin - 2.0, ymin - 2.0, xmax + 2.0, ymax + 2.0), union))
    floor = parts[np.argmin(shapely.distance(parts, shapely.Point(place)))]
    bounds = [int(i) for i in np.flatnonzero(shapely.distance(blocked, shapely.get_exterior_ring(floor)) < 1e-6)]
    return floor, bounds


def _legs(begin: Array, end: Array) -> Shapes:
    return np.asarray(shapely.linestrings(np.stack([begin, end], axis=1)))


def _through(start: Array, goal: Array, corners: Array, blocked: Shapes, heading: float | None) -> Array | None:
    """The shortest way (k, 2) over corners (n, 3, 2), given with the ones before and after; None: there is none."""
    places = np.concatenate([start[None], goal[None], _stood_off(corners)])
    i, j = np.triu_indices(len(places), 1)
    useful = _passes(places, corners, i, j) & _passes(places, corners, j, i)
    i, j = i[useful], j[useful]
    legs = _legs(places[i], places[j])
    free = np.ones(len(legs), dtype=bool)
    free[shapely.STRtree(legs).query(blocked, predicate="intersects")[1]] = False
    i, j = i[free], j[free]
    lengths = np.linalg.norm(places[j] - places[i], axis=-1)
    if heading is not None:
        way = places[j] - places[i]
        turn = np.abs(np.angle(np.exp(1j * (np.arctan2(way[:, 1], way[:, 0]) - heading))))
        lengths = lengths + np.where(i == 0, _TURN / np.pi * turn, 0.0)
    graph = csr_array((lengths, (i, j)), shape=(len(places), len(places)))
    distances, before = dijkstra(graph, directed=False, indices=0, return_predecessors=True)
    if not np.isfinite(distances[1]):
        return None
    order = [1]
    while order[-1] != 0:
        order.append(int(before[order[-1]]))
    return places[order[::-1]]


def _corners(polygon: Any) -> Array:
    """The corners (n, 3, 2) at which a way can bend round a polygon: each with the one before and the one after it."""
    found: list[Array] = []
    for part in shapely.get_parts(polygon):
        for number, ring in enumerate(shapely.get_rings(part)):
            points = shapely.get_coordinates(ring)[:-1]
            if (number == 0) != bool(shapely.is_ccw(ring)):  # the polygon is to lie on the left
                points = points[::-1]
            before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
            convex = _cross(points - before, after - points) > 1e-9
            found.append(np.stack([before, points, after], axis=1)[convex])
    return np.concatenate([np.zeros((0, 3, 2)), *found])


def _stood_off(corners: Array) -> Array:
    """The corners (n, 2) of the way: a little outside of those (n, 3, 2) of the blocked floor."""
    inward = _unit(corners[:, 0] - corners[:, 1]) + _unit(corners[:, 2] - corners[:, 1])
    return corners[:, 1] - _OFF * _unit(inward)


def _passes(places: Array, corners: Array, at: NDArray[np.intp], to: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Whether a leg between places keeps a corner's both edges on one side; others can't be in a shortest way.

    Both places stand off their corners, so that a leg along a short edge is askew to it.
    """
    passes = np.ones(len(at), dtype=bool)
    inner = at >= 2
    corner = corners[at[inner] - 2]
    way = places[to[inner]] - places[at[inner]]
    edges = corner[:, [0, 2]] - corner[:, None, 1]
    slack = np.linalg.norm(edges, axis=-1).T * (2.0 * _OFF + _SKEW * np.linalg.norm(way, axis=-1))
    one, other = _cross(way, edges[:, 0]), _cross(way, edges[:, 1])
    passes[inner] = ((one > -slack[0]) & (other > -slack[1])) | ((one < slack[0]) & (other < slack[1]))
    return passes


def _cross(a: Array, b: Array) -> Array:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _unit(a: Array) -> Array:
    return a / np.maximum(np.linalg.norm(a, axis=-1, keepdims=True), 1e-12)
