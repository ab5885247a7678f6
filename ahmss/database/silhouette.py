"""Very many triangles seen from above, as rows of cells: exact unions of as many would take minutes."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from ahmss.body.array import Array

__all__ = ["silhouette"]

_CELL = 0.01  # metres, or ...
_ACROSS = 500  # ... as much as makes so many across
_AT_ONCE = 1_000_000  # rows of triangles that are in memory


def silhouette(corners: Array) -> tuple[Any, float]:
    """The area that triangles (n, 3, 2) cover, in whole cells, as a shape of shapely; and the size of a cell, metres.

    A cell counts that a triangle touches, so one without an area covers something too.
    """
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    cell = max(_CELL, float((high - low).max()) / _ACROSS)
    grid = (corners - low) / cell
    width, height = (np.floor((high - low) / cell).astype(int) + 2).tolist()
    covered = np.zeros(width * height, np.int64)
    tall = np.ptp(np.floor(grid[..., 1]), axis=1).astype(int) + 1
    ends = np.cumsum(tall)
    for first in range(0, int(ends[-1]), _AT_ONCE):
        chosen = (ends > first) & (ends <= first + _AT_ONCE)
        row, left, right = _rows(grid[chosen], tall[chosen])
        covered += np.bincount(row * width + left, minlength=len(covered))
        covered -= np.bincount(row * width + right + 1, minlength=len(covered))
    mask = np.cumsum(covered.reshape(height, width), axis=1) > 0
    edge = np.diff(np.pad(mask, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    (row, left), (_, right) = np.nonzero(edge == 1), np.nonzero(edge == -1)
    boxes = shapely.box(low[0] + left * cell, low[1] + row * cell, low[0] + right * cell, low[1] + (row + 1) * cell)
    return shapely.union_all(boxes), cell


def _rows(grid: Array, tall: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """For each row of cells that each triangle (n, 3, 2) touches: the row, and its first and last column there."""
    which = np.repeat(np.arange(len(grid)), tall)
    within = np.arange(len(which)) - np.repeat(np.cumsum(tall) - tall, tall)
    row = np.floor(grid[..., 1].min(axis=1)).astype(int)[which] + within
    left, right = np.full(len(row), np.inf), np.full(len(row), -np.inf)
    for i in range(3):
        (xa, ya), (xb, yb) = grid[which, i].T, grid[which, i - 1].T
        meets = (np.minimum(ya, yb) <= row + 1) & (np.maximum(ya, yb) >= row)
        level = ya == yb
        rise = np.where(level, 1.0, yb - ya)
        for bound, otherwise in ((row, 0.0), (row + 1, 1.0)):
            share = np.where(level, otherwise, np.clip((bound - ya) / rise, 0.0, 1.0))
            x = xa + share * (xb - xa)
            left = np.where(meets, np.minimum(left, x), left)
            right = np.where(meets, np.maximum(right, x), right)
    return row, np.floor(left).astype(int), np.floor(right).astype(int)
