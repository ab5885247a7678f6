"""What a thing fills, as its properties tell: `blocks`, or one `box`, each by its lowest and its highest corner.

A console is a few blocks rather than one as high as its top, so that a hand comes to what is on its slope.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import shapely

from ahmss.algorithm.place import Transform, WorldObject
from ahmss.body.array import Array
from ahmss.reaching.prism import Prism

__all__ = ["Box", "boxes_of"]


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
        corners = np.stack(np.meshgrid(*zip(self.low, self.high, strict=True), indexing="ij"), axis=-1).reshape(8, 3)
        return self.frame.apply(corners)

    def prism(self, *, sought: bool = False) -> Prism:
        """The upright prism about it."""
        places = self.corners()
        hull = shapely.convex_hull(shapely.MultiPoint(places[:, :2]))
        ring = shapely.get_coordinates(hull)[:-1]
        return Prism(ring, float(places[:, 2].min()), float(places[:, 2].max()), sought)


def boxes_of(thing: WorldObject) -> list[Box]:
    """The boxes that a thing's properties tell, where it is now; none where they tell none."""
    one, several = thing.properties.get("box"), thing.properties.get("blocks")
    told = several if isinstance(several, list) else [] if one is None else [one]
    return [box for entry in cast(list[Any], told) if (box := _box(thing, entry)) is not None]


def _box(thing: WorldObject, entry: Any) -> Box | None:
    """One of them; None where the entry is no two corners, the first the lower one."""
    try:
        low, high = np.array(entry, float)
    except (TypeError, ValueError):
        return None
    return Box(thing.frame, low, high) if low.shape == (3,) and (low < high).all() else None
