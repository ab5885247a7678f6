"""The triangles of a shape, in groups that lie together: a ray is tried on the few whose boxes it meets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array

__all__ = ["Mesh"]

_MOST = 32  # triangles of a group


@dataclass(frozen=True, eq=False)
class Mesh:
    """A shape in its object's frame, metres.

    groups: of triangles (t, 3, 3). low, high (g, 3): the box around each. middle, half (3,): of the box around all;
    a half of -1 where there is nothing.
    """

    groups: tuple[Array, ...]
    low: Array
    high: Array
    middle: Array
    half: Array

    @classmethod
    def of(cls, triangles: Array) -> Mesh:
        """The mesh of triangles (n, 3, 3)."""
        if not len(triangles):
            return cls((), np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(3), np.full(3, -1.0))
        groups = tuple(_split(triangles))
        low = np.array([group.min(axis=(0, 1)) for group in groups])
        high = np.array([group.max(axis=(0, 1)) for group in groups])
        bottom, top = low.min(axis=0), high.max(axis=0)
        return cls(groups, low, high, 0.5 * (bottom + top), 0.5 * (top - bottom))

    def hit(self, origin: Array, way: Array, length: float) -> bool:
        """Whether a ray meets a triangle within a length.

        Args:
            origin: (3,) in the object's frame.
            way: (3,) unit vector.
            length: metres.
        """
        inverse = 1.0 / np.where(np.abs(way) < 1e-12, 1e-12, way)
        first, second = (self.low - origin) * inverse, (self.high - origin) * inverse
        enters = np.minimum(first, second).max(axis=1)
        leaves = np.maximum(first, second).min(axis=1)
        met = np.flatnonzero((leaves >= np.maximum(enters, 0.0)) & (enters <= length))
        return any(_meets(self.groups[group], origin, way, length) for group in met)


def _split(triangles: Array) -> list[Array]:
    """Halve again and again, across where the middles are spread most."""
    waiting, done = [triangles], list[Array]()
    while waiting:
        part = waiting.pop()
        if len(part) <= _MOST:
            done.append(part)
            continue
        middles = part.mean(axis=1)
        order = np.argsort(middles[:, int(np.argmax(np.ptp(middles, axis=0)))], kind="stable")
        waiting += [part[order[: len(part) // 2]], part[order[len(part) // 2 :]]]
    return done


def _meets(triangles: Array, origin: Array, way: Array, length: float) -> bool:
    """Whether a ray meets one of these triangles, from either side (Moeller and Trumbore 1997)."""
    corner = triangles[:, 0]
    side, other = triangles[:, 1] - corner, triangles[:, 2] - corner
    p = np.cross(way, other)
    det = np.einsum("ij,ij->i", side, p)
    flat = np.abs(det) < 1e-12
    inverse = 1.0 / np.where(flat, 1.0, det)
    t = origin - corner
    u = np.einsum("ij,ij->i", t, p) * inverse
    q = np.cross(t, side)
    v = (q @ way) * inverse
    far = np.einsum("ij,ij->i", other, q) * inverse
    return bool((~flat & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (far > 1e-6) & (far < length)).any())
