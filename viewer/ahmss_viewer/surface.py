"""A surface as the viewer draws it: triangles with normals, colours, perhaps a texture, perhaps a skin."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Skin", "Surface", "corner_normals", "facing_out"]

_CREASE = np.cos(np.radians(38.0))  # faces that meet at a sharper angle keep their edge


@dataclass(frozen=True)
class Skin:
    """How the links move a surface's vertices.

    joints (n, 4) uint8: link numbers. weights (n, 4) uint8: shares of 255. inverse_binds (43, 4, 4): model to link.
    """

    joints: NDArray[np.uint8]
    weights: NDArray[np.uint8]
    inverse_binds: NDArray[np.float64]


@dataclass(frozen=True)
class Surface:
    """Triangles of one texture, in the object's frame, metres.

    positions, normals (n, 3) float32; colours (n, 4) uint8, sRGB; texcoords (n, 2) float32, v down, or None;
    faces (m, 3) uint32; image: the bytes of a PNG or JPEG, or None; skin: for humans; two_sided: to be seen from
    behind too; part: the part of an object that it is, where its look may change; lit: how much of its light is its
    own, 0 to 1.
    """

    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    colours: NDArray[np.uint8]
    faces: NDArray[np.uint32]
    texcoords: NDArray[np.float32] | None = None
    image: bytes | None = None
    skin: Skin | None = None
    two_sided: bool = False
    part: str = ""
    lit: float = 0.0

    def textured(self, image: bytes) -> Surface:
        """The same surface with another picture on it; one without texture coordinates stays as it is."""
        return replace(self, image=image) if self.texcoords is not None else self

    def bounds(self) -> NDArray[np.float64]:
        """Lowest and highest corner (2, 3)."""
        return np.array([self.positions.min(axis=0), self.positions.max(axis=0)], float)


def corner_normals(positions: NDArray[Any], faces: NDArray[Any]) -> NDArray[np.float32]:
    """Normals (m, 3, 3) for each corner of each face: smooth over soft edges, flat at sharp ones."""
    corners = positions[faces].astype(float)
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    unit = area / np.maximum(np.linalg.norm(area, axis=1, keepdims=True), 1e-20)
    _, point = np.unique(np.round(corners.reshape(-1, 3), 5), axis=0, return_inverse=True)
    point = point.reshape(-1)
    order = np.argsort(point, kind="stable")
    face = order // 3
    total = np.repeat(area, 3, axis=0)
    # Corner by corner around each point: with its k-th neighbour in the sorted list, until no point has so many.
    for shift in range(1, int(np.bincount(point).max(initial=1))):
        a, b = order[:-shift], order[shift:]
        same = (point[a] == point[b]) & (np.einsum("ij,ij->i", unit[face[:-shift]], unit[face[shift:]]) > _CREASE)
        if shift > 64:
            break  # the tip of a fan of hundreds: its neighbours nearest in the list are enough
        total[a[same]] += area[face[shift:][same]]
        total[b[same]] += area[face[:-shift][same]]
    length = np.linalg.norm(total, axis=1, keepdims=True)
    normals = np.where(length > 1e-20, total / np.maximum(length, 1e-20), [0.0, 0.0, 1.0])
    return normals.reshape(-1, 3, 3).astype(np.float32)


def facing_out(positions: NDArray[Any], faces: NDArray[Any]) -> NDArray[Any]:
    """The faces, all turned over where together they enclose a negative volume: a closed shape wound inside out."""
    corners = positions[faces].astype(float)
    corners -= corners.reshape(-1, 3).mean(axis=0)
    volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    return faces[:, ::-1] if volume < 0.0 else faces
