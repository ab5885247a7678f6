"""Corner normals that keep sharp edges sharp and round things round."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array

__all__ = ["closed", "corner_normals", "weld"]

_CREASE = np.cos(np.radians(35.0))  # faces that meet at more stay apart
_MOST_AT_A_POINT = 64  # the hub of a fan this large is flat


def weld(triangles: Array) -> NDArray[np.intp]:
    """For each corner of triangles (n, 3, 3) the number (n, 3) of its point; points within 1e-6 of the size are one."""
    points = triangles.reshape(-1, 3)
    grain = max(float(np.ptp(points, axis=0).max()), 1e-9) * 1e-6
    _, number = np.unique(np.round(points / grain).astype(np.int64), axis=0, return_inverse=True)
    return number.reshape(-1, 3)


def corner_normals(triangles: Array, points: NDArray[np.intp]) -> Array:
    """Unit normals (n, 3, 3): at each corner the mean of the faces there that are turned by less than 35 degrees.

    Args:
        triangles: (n, 3, 3), none without area.
        points: (n, 3), which corners are one point (see `weld`).
    """
    area = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    flat = area / np.linalg.norm(area, axis=1, keepdims=True)
    corners = points.reshape(-1)
    face = np.repeat(np.arange(len(triangles)), 3)
    order = np.argsort(corners, kind="stable")
    _, start, count = np.unique(corners[order], return_index=True, return_counts=True)
    shared = np.repeat(count, count)
    few = shared <= _MOST_AT_A_POINT
    corner = np.repeat(order[few], shared[few])
    first = np.repeat(np.repeat(start, count)[few], shared[few])
    steps = np.arange(len(corner)) - np.repeat(np.cumsum(shared[few]) - shared[few], shared[few])
    other = face[order[first + steps]]
    near = np.einsum("ij,ij->i", flat[face[corner]], flat[other]) > _CREASE
    out = np.zeros((len(corners), 3))
    for i in range(3):
        out[:, i] = np.bincount(corner[near], weights=area[other[near], i], minlength=len(corners))
    length = np.linalg.norm(out, axis=1, keepdims=True)
    out = np.where(length > 1e-30, out / np.maximum(length, 1e-30), flat[face])
    return out.reshape(-1, 3, 3)


def closed(points: NDArray[np.intp]) -> bool:
    """Whether the surface has no border: each edge is walked once in either direction."""
    edges = np.concatenate([points[:, [0, 1]], points[:, [1, 2]], points[:, [2, 0]]]).astype(np.int64)
    most = int(edges.max()) + 1
    forth, back = edges[:, 0] * most + edges[:, 1], edges[:, 1] * most + edges[:, 0]
    forth.sort()
    back.sort()
    return bool((forth == back).all())
