"""From a field to a closed triangle mesh: marching cubes, Taubin smoothing, quadric simplification."""

from __future__ import annotations

from dataclasses import dataclass

import fast_simplification
import numpy as np
from manifold3d import Manifold, Mesh
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components
from skimage.measure import marching_cubes

from ahmss.body.array import Array
from humans.distance import Field

__all__ = ["Part", "mesh"]

Faces = NDArray[np.int64]


@dataclass(frozen=True)
class Part:
    """A closed mesh: vertices (n, 3) in metres, faces (m, 3), the field that it was made of, and its colour's name."""

    vertices: Array
    faces: Faces
    field: Field
    colour: str

    def mirrored(self) -> Part:
        """The same on the other side of y = 0."""
        flip = np.array([1.0, -1.0, 1.0])
        return Part(self.vertices * flip, self.faces[:, ::-1], lambda p: self.field(p * flip), self.colour)

    def solid(self) -> Manifold:
        """The part for exact unions and cuts."""
        solid = Manifold(Mesh(np.asarray(self.vertices, np.float32), np.asarray(self.faces, np.uint32)))
        if solid.num_tri() == 0:
            raise ValueError(f"the part coloured {self.colour!r} is not a closed surface: {solid.status()}")
        return solid


def mesh(
    field: Field, box: tuple[Array, Array], cell: float, faces: int, colour: str, turn: Array | None = None
) -> Part:
    """Mesh a field inside a box with cubes of `cell` metres and simplify to about `faces` triangles.

    `turn` (3, 3): columns are the box's axes; the box is then given in those axes.
    """
    axes = np.eye(3) if turn is None else turn
    low, high = np.minimum(*box) - 2 * cell, np.maximum(*box) + 2 * cell
    counts = np.ceil((high - low) / cell).astype(int) + 1
    values = _sample(field, low, counts, cell, axes)
    points, triangles, _, _ = marching_cubes(values, 0.0)
    triangles = _largest(np.asarray(triangles, np.int64), len(points))
    used, triangles = np.unique(triangles, return_inverse=True)
    points, triangles = points[used].astype(float), triangles.reshape(-1, 3)
    points = _taubin(points, triangles, rounds=6)
    points, triangles = fast_simplification.simplify(
        points.astype(np.float32), triangles.astype(np.int32), target_count=faces, agg=7
    )
    vertices = (low + np.asarray(points, float) * cell) @ axes.T
    triangles = np.asarray(triangles, np.int64)
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    if float(np.einsum("ij,ij->", a, np.cross(b, c))) < 0.0:
        triangles = triangles[:, ::-1]
    return Part(vertices, triangles, field, colour)


def _sample(field: Field, low: Array, counts: NDArray[np.intp], cell: float, axes: Array) -> Array:
    """The field on the grid, slab by slab; the outermost layer is outside, so that the surface closes."""
    x, y, z = (low[i] + cell * np.arange(counts[i]) for i in range(3))
    values = np.empty(tuple(counts))
    yy, zz = np.meshgrid(y, z, indexing="ij")
    for start in range(0, len(x), 16):
        part = x[start : start + 16]
        points = np.empty((len(part), *yy.shape, 3))
        points[..., 0], points[..., 1], points[..., 2] = part[:, None, None], yy, zz
        values[start : start + 16] = field(points.reshape(-1, 3) @ axes.T).reshape(len(part), *yy.shape)
    for axis in range(3):
        for layer in (0, -1):
            index: list[slice | int] = [slice(None)] * 3
            index[axis] = layer
            values[tuple(index)] = np.maximum(values[tuple(index)], cell)
    return values


def _largest(triangles: Faces, count: int) -> Faces:
    """The faces of the largest connected piece."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]]])
    graph = csr_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(count, count))
    _, label = connected_components(graph, directed=False)
    return triangles[label[triangles[:, 0]] == np.bincount(label[triangles[:, 0]]).argmax()]


def _taubin(points: Array, triangles: Faces, rounds: int) -> Array:
    """Smooth without shrinking (Taubin 1995)."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    edges = np.concatenate([edges, edges[:, ::-1]])
    graph = csr_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(len(points),) * 2)
    graph.data[:] = 1.0
    degree = np.asarray(graph.sum(axis=1)).ravel()
    for _ in range(rounds):
        for step in (0.5, -0.53):
            points = points + step * (graph @ points / degree[:, None] - points)
    return points
