"""What a thing fills, as its properties tell: `blocks`, or one `box`, each by its lowest and its highest corner.

A block may also be an outline, seen from the side, drawn out along y: so a console is told as it slopes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import shapely
from numpy.typing import NDArray

from ahmss.algorithm.place import Transform, WorldObject
from ahmss.body.array import Array
from ahmss.body.quaternion import rotate, to_matrix
from ahmss.reaching.prism import Prism

__all__ = ["Box", "boxes_of", "filled", "nearest"]

_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], bool)  # of a box, high or low
_LEVEL = 1e-6  # of a face's unit vector: what is less is upright, or level
_ALIKE = 1e-12  # by which the components of two rotations differ that are one


@dataclass(frozen=True, eq=False)
class Box:
    """A frame in the world, and the lowest and highest corner (3,) in it."""

    frame: Transform
    low: Array
    high: Array

    def gap(self, points: Array) -> Array:
        """The distance (...) of points (..., 3) of the world from it, negative within."""
        own = self.frame.inverse().apply(points)
        off = np.maximum(self.low - own, own - self.high)
        return np.linalg.norm(np.maximum(off, 0.0), axis=-1) + np.minimum(off.max(axis=-1), 0.0)

    def corners(self) -> Array:
        """Its corners (8, 3) in the world."""
        return self.frame.apply(np.where(_CORNERS, self.high, self.low))

    def prism(self, *, sought: bool = False) -> Prism:
        """The upright prism about it."""
        places = self.corners()
        return Prism(_around(places[:, :2]), float(places[:, 2].min()), float(places[:, 2].max()), sought)


@dataclass(frozen=True, eq=False)
class _Drawn:
    """A frame in the world, a convex outline (n, 2) in its x and z, counter-clockwise, and the two y between which it
    is drawn out, the lower first.
    """

    frame: Transform
    outline: Array
    ends: Array

    def prism(self, *, sought: bool = False) -> Prism:
        """What it fills: the upright prism about it, cut off at its slopes."""
        x, z = self.outline.T
        places = self.frame.apply(np.concatenate([np.stack([x, np.full(len(x), y), z], axis=-1) for y in self.ends]))
        along = np.roll(self.outline, -1, axis=0) - self.outline
        out = np.stack([along[:, 1], np.zeros(len(along)), -along[:, 0]], axis=-1)
        out /= np.linalg.norm(out, axis=-1, keepdims=True)
        out = rotate(self.frame.rotation, np.concatenate([out, [[0.0, -1.0, 0.0], [0.0, 1.0, 0.0]]]))
        slopes = out[(np.abs(out[:, 2]) > _LEVEL) & (np.abs(out[:, 2]) < 1.0 - _LEVEL)]
        cuts = np.column_stack([slopes, (places @ slopes.T).max(axis=0)]) if len(slopes) else None
        return Prism(_around(places[:, :2]), float(places[:, 2].min()), float(places[:, 2].max()), sought, cuts)


def nearest(boxes: Sequence[Box], points: Array, most: float) -> Array:
    """The metres (n) between hands, or what else is together, of points (n, m, 3) of the world and the nearest box.

    Negative within; never more than `most`: what is farther is not looked at, so that many boxes cost little more than
    the few that are near.
    """
    gaps = np.full(len(points), most)
    if not boxes:
        return gaps
    middle = 0.5 * (points.min(axis=1) + points.max(axis=1))
    about = np.sqrt(((points - middle[:, None]) ** 2).sum(axis=-1).max(axis=1))
    for turn, low, high in _alike(boxes):
        own = middle @ turn
        off = np.maximum(np.maximum(low[:, None] - own, own - high[:, None]), 0.0)  # (b, n, 3)
        box, some = np.nonzero((off**2).sum(axis=-1) < (about + most) ** 2)
        if not len(some):
            continue
        np.minimum.at(gaps, some, _gaps(turn, low, high, points, box, some))
    return gaps


def _alike(boxes: Sequence[Box]) -> list[tuple[Array, Array, Array]]:
    """Boxes by how they are turned: the rotation (3, 3), and their corners (b, 3) along its axes, from the origin."""
    rotations, left = np.array([box.frame.rotation for box in boxes]), np.ones(len(boxes), bool)
    corners = np.array([(box.low, box.high) for box in boxes])
    places = np.array([box.frame.place for box in boxes])
    found: list[tuple[Array, Array, Array]] = []
    while left.any():
        first = rotations[left.argmax()]
        own = left & (np.abs(rotations - first).max(axis=-1) < _ALIKE)
        turn = to_matrix(first)
        at = places[own] @ turn
        found.append((turn, at + corners[own, 0], at + corners[own, 1]))
        left &= ~own
    return found


def _gaps(turn: Array, low: Array, high: Array, points: Array, box: NDArray[np.intp], some: NDArray[np.intp]) -> Array:
    """The metres (p) of pairs of a box and some points: their numbers (p), the boxes' corners along a rotation's axes.

    A component of all points lies together in memory, which is several times as fast.
    """
    used, pair = np.unique(some, return_inverse=True)
    m = points.shape[1]
    own = (turn.T @ points[used].reshape(-1, 3).T).reshape(3, len(used), m)[:, pair]
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    own -= middle[box].T[..., None]
    off = np.abs(own, out=own)
    off -= half[box].T[..., None]
    within = np.maximum(np.maximum(off[0], off[1]), off[2]).min(axis=1)
    np.maximum(off, 0.0, out=off)
    off *= off
    return np.where(within < 0.0, within, np.sqrt((off[0] + off[1] + off[2]).min(axis=1)))


def boxes_of(thing: WorldObject) -> list[Box]:
    """The boxes that a thing's properties tell, where it is now; none where they tell none."""
    return [box for entry in _told(thing) if (box := _box(thing, entry)) is not None]


def filled(thing: WorldObject, *, sought: bool = False) -> list[Prism]:
    """What a thing's properties tell that it fills, where it is now; nothing where they tell nothing."""
    return [*thing.while_it_stays(("filled", sought), lambda: _filled(thing, sought=sought))]


def _filled(thing: WorldObject, *, sought: bool) -> list[Prism]:
    blocks = [_drawn(thing, entry) if isinstance(entry, dict) else _box(thing, entry) for entry in _told(thing)]
    return [block.prism(sought=sought) for block in blocks if block is not None]


def _told(thing: WorldObject) -> list[Any]:
    one, several = thing.properties.get("box"), thing.properties.get("blocks")
    return cast(list[Any], several) if isinstance(several, list) else [] if one is None else [one]


def _drawn(thing: WorldObject, entry: dict[str, Any]) -> _Drawn | None:
    """One that is told by its outline; None where the entry is none."""
    try:
        outline, ends = np.array(entry["outline"], float), np.array(entry["y"], float)
    except (KeyError, TypeError, ValueError):
        return None
    if outline.ndim != 2 or outline.shape[1] != 2 or len(outline) < 3 or ends.shape != (2,) or ends[0] >= ends[1]:
        return None
    ring = _around(outline)
    return _Drawn(thing.frame, ring, ends) if len(ring) >= 3 else None


def _around(places: Array) -> Array:
    """The convex outline (m, 2), counter-clockwise, of places (n, 2)."""
    ring = shapely.get_coordinates(shapely.convex_hull(shapely.MultiPoint(places)))[:-1]
    x, y = ring.T
    return ring if float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) > 0.0 else ring[::-1]


def _box(thing: WorldObject, entry: Any) -> Box | None:
    """One of them; None where the entry is no two corners, the first the lower one."""
    try:
        low, high = np.array(entry, float)
    except (TypeError, ValueError):
        return None
    return Box(thing.frame, low, high) if low.shape == (3,) and (low < high).all() else None
