"""Coloured triangles: what every shape file is read into, before it becomes a GLB."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array

__all__ = ["Soup"]


@dataclass(frozen=True)
class Soup:
    """Triangles (n, 3, 3), colours (n, 3) of 0 to 255, a layer (n,) into `layers`, and picture coordinates.

    uv: (n, 3, 2), from the lower left corner, or None where the file has none. picture: an image that came within the
    shape file, as PNG or JPEG bytes.
    """

    triangles: Array
    colors: NDArray[np.uint8]
    layer: NDArray[np.intp]
    layers: tuple[str, ...]
    uv: Array | None = None
    picture: bytes | None = None

    def transformed(self, matrix: Array) -> Soup:
        """All triangles moved by a 3x3 or 4x4 matrix (columns); a mirror keeps the outsides outside."""
        linear = matrix[:3, :3]
        triangles = self.triangles @ linear.T
        if matrix.shape == (4, 4):
            triangles = triangles + matrix[:3, 3]
        uv = self.uv
        if np.linalg.det(linear) < 0.0:
            triangles = triangles[:, ::-1]
            uv = None if uv is None else uv[:, ::-1]
        return replace(self, triangles=triangles, uv=uv)

    def proper(self) -> Soup:
        """Without the triangles that have no area."""
        a, b, c = (self.triangles[:, i] for i in range(3))
        cross = np.cross(b - a, c - a)
        size = np.maximum(((b - a) ** 2).sum(-1), ((c - a) ** 2).sum(-1))
        keep = (cross**2).sum(-1) > 1e-16 * size**2
        return replace(
            self,
            triangles=self.triangles[keep],
            colors=self.colors[keep],
            layer=self.layer[keep],
            uv=None if self.uv is None else self.uv[keep],
        )
