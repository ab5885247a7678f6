"""The pieces that a shape is made of, each with an inside: how deep a point is in one, exactly, by its own triangles.

Pieces that touch or overlap count each for itself: a face of one that lies within another is no surface of that.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from ahmss.body.array import Array
from ahmss.grasping.distance import distances

__all__ = ["Piece", "pieces"]

_GRAIN = 1e-5  # metres: corners so near to each other are one
_FLAT = 1e-6  # metres that a corner may be outside of a face's plane of a convex piece
_PAIRS = 10_000  # of points and triangles at a time: what is worked on stays near the processor


@dataclass(frozen=True)
class Piece:
    """Triangles (T, 3, 3), counter-clockwise from outside, metres."""

    triangles: Array

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """The lowest and the highest corner."""
        return self.triangles.min(axis=(0, 1)), self.triangles.max(axis=(0, 1))

    @cached_property
    def planes(self) -> Array | None:
        """The planes (m, 4) of its faces, outward normals and offsets, if it is convex; else None."""
        a, b, c = self.triangles[:, 0], self.triangles[:, 1], self.triangles[:, 2]
        normal = np.cross(b - a, c - a)
        size = np.linalg.norm(normal, axis=1)
        normal = normal[size > 0.0] / size[size > 0.0, None]
        offset = -np.einsum("mc,mc->m", normal, a[size > 0.0])
        corners = np.unique(self.triangles.reshape(-1, 3), axis=0)
        return np.column_stack([normal, offset]) if (corners @ normal.T + offset).max() < _FLAT else None

    def depth(self, points: Array) -> Array:
        """How far points (n, 3) are within its surface, metres, 0 outside."""
        deep = np.zeros(len(points))
        low, high = self.bounds
        near = np.flatnonzero(((points > low) & (points < high)).all(axis=-1))
        if len(near) and self.planes is not None:
            deep[near] = np.maximum(-(points[near] @ self.planes[:, :3].T + self.planes[:, 3]).max(axis=1), 0.0)
            return deep
        for some in np.array_split(near, len(near) * len(self.triangles) // _PAIRS + 1):
            inside = some[np.abs(_windings(points[some], self.triangles)) > 0.5]
            deep[inside] = _nearest(points[inside], self.triangles)
        return deep


def pieces(triangles: Array) -> list[Piece]:
    """What hangs together of triangles (T, 3, 3) and is closed, each by itself; what is not closed, as one."""
    corners = np.unique(np.round(triangles.reshape(-1, 3) / _GRAIN).astype(np.int64), axis=0, return_inverse=True)[1]
    faces = corners.reshape(-1, 3)
    count = int(faces.max(initial=-1)) + 1
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    links = coo_matrix((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(count, count))
    number: NDArray[np.intp] = np.asarray(connected_components(links, directed=False)[1])[faces[:, 0]]
    found, rest = list[Piece](), list[Array]()
    for one in range(int(number.max(initial=-1)) + 1):
        own = number == one
        if _closed(faces[own]):
            found.append(Piece(triangles[own]))
        else:
            rest.append(triangles[own])
    return [*found, Piece(np.concatenate(rest))] if rest else found


def _closed(faces: NDArray[np.intp]) -> bool:
    """Whether each edge of faces (T, 3) is gone along as often in one direction as in the other."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges = edges[edges[:, 0] != edges[:, 1]]
    forth = edges[:, 0] < edges[:, 1]
    _, which = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    return not np.bincount(which.reshape(-1), np.where(forth, 1.0, -1.0)).any()


def _windings(points: Array, triangles: Array) -> Array:
    """How often (n) triangles (T, 3, 3) go around points (n, 3): the solid angle of each, as seen from there, summed.

    Van Oosterom and Strackee 1983, "The solid angle of a plane triangle".
    """
    # Coordinates each by itself (n, T): several times as fast as vectors of three.
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (
        [triangles[None, :, i, k] - points[:, None, k] for k in range(3)] for i in range(3)
    )
    la, lb, lc = (np.sqrt(x * x + y * y + z * z) for x, y, z in ((ax, ay, az), (bx, by, bz), (cx, cy, cz)))
    volume = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    ab, bc, ca = ax * bx + ay * by + az * bz, bx * cx + by * cy + bz * cz, cx * ax + cy * ay + cz * az
    return np.arctan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb).sum(axis=1) / (2.0 * np.pi)


def _nearest(points: Array, triangles: Array) -> Array:
    """The distances (n) of points (n, 3) from the nearest of triangles (T, 3, 3)."""
    n, count = len(points), len(triangles)
    if not n:
        return np.zeros(0)
    pairs = distances(np.repeat(points, count, axis=0), np.tile(triangles, (n, 1, 1)))
    return pairs.reshape(n, count).min(axis=1)
