"""What lies between two heights of a shape, seen from above, as outlines."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from ahmss.body.array import Array
from ahmss.database.silhouette import silhouette

__all__ = ["Ring", "Rings", "outlines"]

_HALF = 0.005  # metres: half of the thickness that a surface standing upright is given
_SHARP = 2.0  # how far beyond that a corner may reach
_SMOOTH = 0.004  # metres by which an outline may be simplified: less than `_HALF`, or what is thin would lose its width
_ROOM = 1.0  # square metres from which on a hole is a room to be in, and not the inside of something
_GRAIN = 1e-3  # metres: corners nearer than this are one
_SPECK = 1e-7  # square metres under which a triangle is seen from its edge
_MOST = 5000  # triangles of which the union is made exactly

Ring = tuple[tuple[float, float], ...]
Rings = tuple[Ring, ...]


def outlines(triangles: Array, low: float, high: float) -> Rings:
    """The area under triangles (n, 3, 3) between two heights, as outlines.

    Surfaces that stand upright count as thick as 1 cm. Holes under 1 m2 are the insides of things and are occupied.

    Returns:
        Outlines without holes, counter-clockwise, the first corner not repeated; they may touch, but do not overlap. A
        hole that is kept divides what is around it.
    """
    within = _above(triangles, low)
    within = _above(within * [1.0, 1.0, -1.0], -high)[..., :2]
    corners = np.unique(_sorted(np.round(within / _GRAIN)), axis=0) * _GRAIN
    if not len(corners):
        return ()
    area, smooth = _union(corners) if len(corners) <= _MOST else silhouette(corners)
    area = shapely.simplify(_filled(area), smooth)
    pieces = [piece for part in shapely.get_parts(area) for piece in _without_holes(part)]
    return tuple(_ring(piece) for piece in pieces)


def _above(triangles: Array, height: float) -> Array:
    """What of triangles (n, 3, 3) is over a height, as triangles (m, 3, 3)."""
    over = triangles[..., 2] >= height
    count = over.sum(axis=1)
    one, two = triangles[count == 1], triangles[count == 2]
    tip, left, right = _apex(one, over[count == 1])
    corner, a, b = _apex(two, ~over[count == 2])
    to_a, to_b = _meet(corner, a, height), _meet(corner, b, height)
    return np.concatenate([
        triangles[count == 3],
        np.stack([tip, _meet(tip, left, height), _meet(tip, right, height)], axis=1),
        np.stack([to_a, a, b], axis=1),
        np.stack([to_a, b, to_b], axis=1),
    ])  # fmt: skip


def _apex(triangles: Array, alone: Any) -> tuple[Array, Array, Array]:
    """The corners (n, 3) of triangles, that one first which is alone on its side."""
    order = (np.argmax(alone, axis=1)[:, None] + np.arange(3)) % 3
    turned = np.take_along_axis(triangles, order[..., None], axis=1)
    return turned[:, 0], turned[:, 1], turned[:, 2]


def _meet(a: Array, b: Array, height: float) -> Array:
    """Where the edges from a to b (n, 3), which lie on either side, pass a height."""
    share = (height - a[:, 2:]) / (b[:, 2:] - a[:, 2:])
    return a + share * (b - a)


def _sorted(corners: Array) -> Array:
    """Triangles (n, 3, 2) with their corners in order, so that equal ones are equal."""
    order = np.lexsort((corners[..., 1], corners[..., 0]), axis=-1)
    return np.take_along_axis(corners, order[..., None], axis=1)


def _areas(corners: Array) -> Array:
    """Signed areas (n,) of triangles (n, 3, 2)."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _union(corners: Array) -> tuple[Any, float]:
    """The area under triangles (n, 3, 2) with sorted corners, and how far its outline may be simplified."""
    flat = np.abs(_areas(corners)) < _SPECK
    faces = shapely.union_all(shapely.polygons(corners[~flat]))
    # Of what is seen from its edge the first and the last corner are the ends.
    edges = shapely.get_parts(shapely.multilinestrings(np.unique(corners[flat][:, [0, 2]], axis=0)))
    with np.errstate(divide="ignore", invalid="ignore"):  # at corners that are next to in one place
        thick = shapely.buffer([faces, *edges], _HALF, cap_style="square", join_style="mitre", mitre_limit=_SHARP)
    return shapely.union_all(thick), _SMOOTH


def _filled(area: Any) -> Any:
    """The area without holes that are no rooms."""
    parts: list[Any] = []
    for part in shapely.get_parts(area):
        holes = shapely.get_interior_ring(part, np.arange(shapely.get_num_interior_rings(part)))
        rooms = holes[shapely.area(shapely.polygons(holes)) >= _ROOM]
        parts.append(shapely.polygons(part.exterior, rooms))
    return shapely.union_all(parts)


def _without_holes(part: Any) -> list[Any]:
    """A polygon as polygons without holes, divided at the middle of each hole."""
    if not part.interiors:
        return [part]
    x = shapely.Polygon(part.interiors[0]).representative_point().x
    left, bottom, right, top = part.bounds
    halves = [shapely.box(left, bottom, x, top), shapely.box(x, bottom, right, top)]
    pieces = [piece for half in halves for piece in shapely.get_parts(shapely.intersection(part, half))]
    return [whole for piece in pieces if piece.area > 0.0 for whole in _without_holes(piece)]


def _ring(piece: Any) -> Ring:
    """The outline of a polygon."""
    points = shapely.get_coordinates(shapely.orient_polygons(piece))[:-1]
    return tuple((x, y) for x, y in np.round(points, 4).tolist())
