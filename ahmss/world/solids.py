"""Objects' shapes as things stand on them and as they stand: triangles and the base, once for all objects of a kind."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ahmss.body.array import Array
from ahmss.errors import ProtocolError
from ahmss.motion.glbfile import GlbReader
from ahmss.states.behaviour import PART
from ahmss.world.assets import Assets
from ahmss.world.behaviours import Behaviours

__all__ = ["Solid", "Solids"]

_BASE = 0.004  # metres above its lowest point up to which a shape's corners are its base
_MOST_CORNERS = 500  # more than these are told by their box
_SIDES = 2.0 * np.pi * np.arange(32) / 32.0  # directions in which the border of the base is looked for
_RINGS = (1.0, 0.75, 0.5, 0.25)


@dataclass(frozen=True, eq=False)
class Solid:
    """A shape in its object's frame, metres.

    triangles (n, 3, 3), boxes (n, 2, 3) around each; low, high (3,): around all; radius: farthest from the origin;
    corners (m, 3): its outermost points, enough to see how low it reaches when it leans; base (b, 2): points of what
    it stands on, its middle first.
    """

    triangles: Array
    boxes: Array
    low: Array
    high: Array
    radius: float
    corners: Array
    base: Array

    @classmethod
    def of(cls, triangles: Array) -> Solid:
        """The solid of these triangles."""
        points = triangles.reshape(-1, 3)
        boxes = np.stack([triangles.min(axis=1), triangles.max(axis=1)], axis=1)
        low, high = points.min(axis=0), points.max(axis=0)
        box = np.array(np.meshgrid(*zip(low, high, strict=True))).reshape(3, 8).T
        corners = points if len(points) <= _MOST_CORNERS else box
        foot = points[points[:, 2] < low[2] + _BASE, :2]
        middle = 0.5 * (foot.min(axis=0) + foot.max(axis=0))
        border = np.argmax(foot @ np.array([np.cos(_SIDES), np.sin(_SIDES)]), axis=0)
        foot = foot[np.unique(border)]
        rings = [middle + ring * (foot - middle) for ring in _RINGS]
        return cls(
            triangles, boxes, low, high, float(np.linalg.norm(points, axis=1).max()), corners,
            np.concatenate([middle[None], *rings]),
        )  # fmt: skip


class Solids:
    """Solids by shape, without the parts that are not there in every state."""

    def __init__(self, assets: Assets, behaviours: Behaviours) -> None:
        self._assets, self._behaviours = assets, behaviours
        self._known: dict[tuple[str, str], Solid | None] = {}

    def get(self, shape: str, behaviour: str) -> Solid | None:
        """The solid of a shape; None where there is no shape, or one that can't be read: nothing stands on it."""
        if not shape:
            return None
        key = (shape, behaviour)
        if key not in self._known:
            self._known[key] = self._read(shape, self._behaviours.get(behaviour).unsteady)
        return self._known[key]

    def _read(self, shape: str, unsteady: frozenset[str]) -> Solid | None:
        data = self._assets.get(shape)
        if data is None:
            return None
        try:
            reader = GlbReader(data)
            parts = [
                _triangles(reader, primitive)
                for mesh in reader.tree["meshes"]
                if mesh.get("name", "").removeprefix(PART) not in unsteady
                for primitive in mesh["primitives"]
            ]
        except (ProtocolError, LookupError, TypeError, ValueError, AttributeError):  # viewers say so
            return None
        triangles = np.round(np.concatenate(parts), 6) if parts else np.zeros((0, 3, 3))  # float32: 0.88 is 0.88 again
        return Solid.of(triangles) if len(triangles) and np.isfinite(triangles).all() else None


def _triangles(reader: GlbReader, primitive: dict[str, Any]) -> Array:
    """The triangles (n, 3, 3) of a mesh's primitive, which lies in the object's frame."""
    points = reader.array(primitive["attributes"]["POSITION"]).astype(np.float64)
    if "indices" in primitive:
        points = points[reader.array(primitive["indices"])[:, 0]]
    return points.reshape(-1, 3, 3)
