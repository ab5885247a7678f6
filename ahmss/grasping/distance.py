"""Making a field: distances to the triangles of a mesh, and which side of them is inside.

Any mesh will do: pieces that overlap count as one body, a hole in a wall that other faces hide does no harm, and a
surface with a border has no inside but a distance on both of its sides.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.quaternion import cross
from ahmss.grasping.field import STEP, Field

__all__ = ["Grid", "build", "distances"]

MARGIN = 0.03  # metres around what is covered: no skin is further from a bone
FINEST, NODES = 0.00125, 600_000  # metres between nodes at the least; how many nodes at the most
_TOGETHER = 4096  # points whose distances are made at a time: a processor keeps what that takes at hand
_CHUNK = 2_000_000  # pairs of lines and faces at a time
_ASIDE = np.array([1.7e-7, 2.3e-7])  # metres by which lines pass beside the edges of what is drawn on a grid

Faces = NDArray[np.intp]


@dataclass(frozen=True)
class Grid:
    """Nodes `spacing` apart from `low` (3,) on, `count` (3,) of them along each axis."""

    low: Array
    count: Faces
    spacing: float

    @property
    def high(self) -> Array:
        """(3,) the place of the last node."""
        return self.low + self.spacing * (self.count - 1)

    def points(self) -> Array:
        """The places (n, 3) of all nodes."""
        axes = [self.low[i] + self.spacing * np.arange(self.count[i]) for i in range(3)]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def build(vertices: Array, faces: Faces, low: Array, high: Array) -> Field:
    """The field of what of a mesh is within a box.

    Args:
        vertices: (V, 3) metres, in the object's frame.
        faces: (T, 3) numbers of vertices, counter-clockwise from outside.
        low: (3,) lower corner of the box, metres. high: (3,) its upper corner. The shape's own bounds cut it further.

    Raises:
        ValueError: nothing of the mesh is in the box.
    """
    triangles = vertices[faces]
    low = np.maximum(low, triangles.min(axis=(0, 1))) - MARGIN
    high = np.minimum(high, triangles.max(axis=(0, 1))) + MARGIN
    near = _touching(triangles, low, high)
    if (high - low < MARGIN).any() or not near.any():
        raise ValueError("nothing of the shape is there")
    spacing = max(FINEST, float(np.prod(high - low) / NODES) ** (1.0 / 3.0))
    grid = Grid(low, np.ceil((high - low) / spacing).astype(np.intp) + 1, spacing)
    distance = _unsigned(grid, triangles[near])
    signed = np.where(_inside(grid, triangles), -distance, distance) / STEP
    nodes = np.clip(np.round(signed), -32767, 32767).astype(np.int16).reshape(grid.count)
    return Field(low, spacing, nodes)


def _touching(triangles: Array, low: Array, high: Array) -> NDArray[np.bool_]:
    """Which triangles' bounds (n, 3, 3) meet a box."""
    return ((triangles.min(axis=1) <= high) & (triangles.max(axis=1) >= low)).all(axis=1)


def _unsigned(grid: Grid, triangles: Array) -> Array:
    """The distances (n) of all nodes from triangles (m, 3, 3): exact near them, further off to the face nearest there.

    Raises:
        ValueError: no triangle is near.
    """
    from scipy.ndimage import distance_transform_edt  # slow to load, and not needed where the field is kept
    from scipy.spatial import KDTree

    samples, owners = _samples(triangles, grid.low, grid.high, grid.spacing)
    if not len(samples):
        raise ValueError("nothing of the shape is there")
    cells = np.round((samples - grid.low) / grid.spacing).astype(np.intp)
    owner = np.full(grid.count, -1)
    within = ((cells >= 0) & (cells < grid.count)).all(axis=1)
    owner[tuple(cells[within].T)] = owners[within]
    indices = distance_transform_edt(owner < 0, return_distances=False, return_indices=True)
    points, face = grid.points(), owner[tuple(np.asarray(indices))].reshape(-1)
    distance = _from_faces(points, triangles, face)
    close = np.flatnonzero(distance < 3.0 * grid.spacing)  # there the next face may be nearer
    _, found = KDTree(samples).query(points[close], k=min(6, len(samples)), workers=-1)
    asked = [face[close]]
    for column in owners[np.reshape(found, (len(close), -1))].T:
        new = np.flatnonzero(np.logical_and.reduce([column != before for before in asked]))
        at = close[new]
        distance[at] = np.minimum(distance[at], _from_faces(points[at], triangles, column[new]))
        asked.append(column)
    return distance


def _from_faces(points: Array, triangles: Array, face: Faces) -> Array:
    """The distances (n) of points (n, 3) from those of triangles (m, 3, 3) whose numbers are given (n)."""
    parts = [slice(first, first + _TOGETHER) for first in range(0, len(points), _TOGETHER)]
    return np.concatenate([np.zeros(0), *(distances(points[part], triangles[face[part]]) for part in parts)])


def _samples(triangles: Array, low: Array, high: Array, spacing: float) -> tuple[Array, Faces]:
    """Points (n, 3) on triangles (m, 3, 3), some `spacing` apart, within a box, and whose they are (n)."""
    owners = np.arange(len(triangles))
    done: list[tuple[Array, Faces]] = []
    while len(triangles):
        edges = triangles[:, [1, 2, 0]] - triangles
        length = np.einsum("tec,tec->te", edges, edges)
        small = length.max(axis=1) < (1.5 * spacing) ** 2
        done.append((triangles[small].mean(axis=1), owners[small]))
        triangles, owners, longest = triangles[~small], owners[~small], length[~small].argmax(axis=1)
        rows = np.arange(len(triangles))
        a, b, c = (triangles[rows, (longest + i) % 3] for i in range(3))
        middle = 0.5 * (a + b)
        triangles = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
        owners = np.concatenate([owners, owners])
        kept = _touching(triangles, low, high)
        triangles, owners = triangles[kept], owners[kept]
    return np.concatenate([part[0] for part in done]), np.concatenate([part[1] for part in done])


def distances(points: Array, triangles: Array) -> Array:
    """The distances (n) of points (n, 3) from triangles (n, 3, 3), one each, metres."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    normal = cross(b - a, c - a)
    area = np.einsum("nc,nc->n", normal, normal)
    height = np.einsum("nc,nc->n", points - a, normal)
    above = np.ones(len(points), bool)
    nearest = np.full(len(points), np.inf)
    for p, q in ((a, b), (b, c), (c, a)):
        edge, apart = q - p, points - p
        above &= np.einsum("nc,nc->n", cross(edge, apart), normal) >= 0.0
        length = np.einsum("nc,nc->n", edge, edge)
        share = np.clip(np.einsum("nc,nc->n", edge, apart) / np.maximum(length, 1e-18), 0.0, 1.0)
        apart = apart - share[:, None] * edge
        nearest = np.minimum(nearest, np.einsum("nc,nc->n", apart, apart))
    flat = above & (area > 1e-18)
    return np.sqrt(np.where(flat, height**2 / np.maximum(area, 1e-18), nearest))


def _inside(grid: Grid, triangles: Array) -> NDArray[np.bool_]:
    """Which nodes (n) are inside of triangles (m, 3, 3), by the most of the three directions in which one may look.

    Along a line of nodes each face that it goes through adds or takes one, as it is seen from its back or its front;
    inside is where the sum is not zero. A line whose sum does not come back to zero has gone through a hole, and has no
    vote.
    """
    votes = np.zeros(grid.count, np.int8)
    for axis in range(3):
        votes += np.moveaxis(_along(grid, triangles, axis), -1, axis)
    return (votes > 0).reshape(-1)


def _along(grid: Grid, triangles: Array, axis: int) -> NDArray[np.int8]:
    """Votes of the lines along an axis (nodes of the two others, nodes of this): 1 inside, -1 outside, 0 none."""
    others = [i for i in range(3) if i != axis]
    lines, length = grid.count[others], grid.count[axis]
    flat = (triangles[:, :, others] - grid.low[others] - _ASIDE) / grid.spacing  # nodes are at whole numbers
    heights = (triangles[:, :, axis] - grid.low[axis]) / grid.spacing
    first = np.maximum(np.ceil(flat.min(axis=1)), 0.0).astype(np.intp)
    last = np.minimum(np.floor(flat.max(axis=1)), lines - 1).astype(np.intp)
    size = np.maximum(last - first + 1, 0)
    total = size.prod(axis=1)
    sums = np.zeros((lines[0] * lines[1], length + 1), np.int32)
    order = np.cumsum(total)
    for chunk in np.split(np.arange(len(triangles)), np.flatnonzero(np.diff(order // _CHUNK)) + 1):
        face = np.repeat(chunk, total[chunk])
        if not len(face):
            continue
        place = np.arange(len(face)) - np.repeat(np.cumsum(total[chunk]) - total[chunk], total[chunk])
        line = first[face] + np.stack(np.divmod(place, np.maximum(size[face, 1], 1)), axis=1)
        a, b, c = (flat[face, i] - line for i in range(3))
        shares = np.stack([_cross(b, c), _cross(c, a), _cross(a, b)], axis=1)
        area = shares.sum(axis=1)
        hit = ((shares > 0.0).all(axis=1) | (shares < 0.0).all(axis=1)) & (area != 0.0)
        height = (shares[hit] * heights[face[hit]]).sum(axis=1) / area[hit]
        row = np.clip(np.ceil(height), 0, length).astype(np.intp)
        turn = np.where(area[hit] > 0.0, 1, -1)
        np.add.at(sums, (line[hit, 0] * lines[1] + line[hit, 1], row), turn)
    through = np.cumsum(sums, axis=1)
    whole = through[:, -1:] == 0
    votes = np.where(whole, np.where(through[:, :-1] != 0, 1, -1), 0).astype(np.int8)
    return votes.reshape(lines[0], lines[1], length)


def _cross(p: Array, q: Array) -> Array:
    return p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
