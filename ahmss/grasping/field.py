"""How far points are from a shape: a grid of signed distances, read between its nodes.

The grid covers the part of a shape that a hand can meet; it is made once (see `ahmss.grasping.distance`) and kept.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.errors import DataError

__all__ = ["Crowded", "Field", "Joined", "Solid"]

_HEAD = struct.Struct("<4s3I4d")  # name and version, nodes along x, y, z, the first node's place, spacing
_MAGIC = b"SDF1"
STEP = 2e-5  # metres that a stored number counts: distances up to 0.65 m
_EPSILON = 5e-4  # metres of the central differences that give a normal


class Solid(Protocol):
    """What a hand can close on."""

    def clearance(self, points: Array) -> Array:
        """The distance (...) of points (..., 3) from the surface, metres, negative inside."""
        ...


@dataclass(frozen=True)
class Field:
    """Signed distances (X, Y, Z) at the nodes of a grid in the object's frame.

    first: (3,) the place of node 0, 0, 0, metres. spacing: metres between nodes. nodes: int16, counts of `STEP`.
    """

    first: Array
    spacing: float
    nodes: NDArray[np.int16]

    @property
    def alone(self) -> Field:
        """The shape without what is about."""
        return self

    def clearance(self, points: Array) -> Array:
        """The distance (...) of points (..., 3) from the surface, metres, negative inside; linear between nodes.

        Beyond the grid: as of two sides at right angles, that of the nearest place in the grid and how far that is.
        """
        shape = np.array(self.nodes.shape)
        at = (points - self.first) / self.spacing
        within = np.clip(at, 0.0, shape - 1.001)
        low = within.astype(np.intp)
        share = within - low
        _, width, depth = self.nodes.shape
        flat = self.nodes.reshape(-1)
        corner = (low[..., 0] * width + low[..., 1]) * depth + low[..., 2]
        x, y, z = share[..., 0], share[..., 1], share[..., 2]
        # along z, then y, then x
        sides: list[Array] = []
        for i in (0, width * depth):
            rows: list[Array] = []
            for j in (0, depth):
                near = flat[corner + (i + j)].astype(np.float64)
                rows.append(near + z * (flat[corner + (i + j + 1)] - near))
            sides.append(rows[0] + y * (rows[1] - rows[0]))
        distance = (sides[0] + x * (sides[1] - sides[0])) * STEP
        beyond = at - within
        x, y, z = beyond[..., 0], beyond[..., 1], beyond[..., 2]  # numpy's largest of three takes longer than these
        outside = (np.abs(x) > 0.002) | (np.abs(y) > 0.002) | (np.abs(z) > 0.002)
        if outside.any():
            away = self.spacing * np.sqrt(np.einsum("...c,...c->...", beyond, beyond))
            distance = np.where(outside, np.hypot(away, np.maximum(distance, 0.0)), distance)
        return distance

    def normals(self, points: Array) -> Array:
        """The unit normals (..., 3) of the surface nearest to points (..., 3), pointing out of it."""
        steps = _EPSILON * np.concatenate([np.eye(3), -np.eye(3)])
        around = self.clearance(points[..., None, :] + steps)
        slope = around[..., :3] - around[..., 3:]
        return slope / np.maximum(np.linalg.norm(slope, axis=-1, keepdims=True), 1e-12)

    def to_bytes(self) -> bytes:
        """The field as it is kept."""
        return _HEAD.pack(_MAGIC, *self.nodes.shape, *self.first.tolist(), self.spacing) + self.nodes.tobytes()

    @classmethod
    def from_bytes(cls, data: bytes) -> Field:
        """The field that was kept; its nodes can't be written.

        Raises:
            DataError: the bytes are none, or of another version.
        """
        if len(data) < _HEAD.size or data[:4] != _MAGIC:
            raise DataError("field", "", "these bytes are no field of distances; delete what is kept and start again")
        _, nx, ny, nz, x, y, z, spacing = _HEAD.unpack_from(data)
        if len(data) != _HEAD.size + 2 * nx * ny * nz:
            raise DataError("field", "", "the field of distances is cut short; delete what is kept and start again")
        nodes = np.frombuffer(data, np.int16, offset=_HEAD.size).reshape(nx, ny, nz)
        return cls(np.array([x, y, z]), spacing, nodes)


@dataclass(frozen=True)
class Joined(Field):
    """The field of a shape and another's as one: what is held, and the hand around it. also: that other field."""

    also: Field

    @classmethod
    def of(cls, shape: Field, also: Field) -> Joined:
        """Two shapes in one frame as one."""
        return cls(shape.first, shape.spacing, shape.nodes, also)

    def clearance(self, points: Array) -> Array:
        """The distance (...) of points (..., 3) from the nearer surface, metres, negative inside."""
        return np.minimum(super().clearance(points), self.also.clearance(points))


@dataclass(frozen=True)
class Crowded(Field):
    """The field of a shape with others about it, which hands that close on it stay out of too.

    shape: without them. others: gives the distance (...) of points (..., 3) from them, metres, negative inside; never
    more than it is.
    """

    shape: Field
    others: Callable[[Array], Array]

    @classmethod
    def of(cls, shape: Field, others: Callable[[Array], Array]) -> Crowded:
        """A shape and what is about it."""
        return cls(shape.first, shape.spacing, shape.nodes, shape, others)

    @property
    def alone(self) -> Field:
        """The shape without what is about."""
        return self.shape

    def clearance(self, points: Array) -> Array:
        """The distance (...) of points (..., 3) from the nearest surface, metres, negative inside."""
        return np.minimum(self.shape.clearance(points), self.others(points))
