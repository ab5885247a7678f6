"""Packed poses of all humans or all objects: one preallocated array, a row each, without gaps."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array

__all__ = ["Table"]


class Table:
    """Rows of float64 by id. Adding and removing is rare; a frame writes into a row.

    Attributes:
        rows: the row of each id. A removal moves the last row into the gap.
        data: (capacity, width); the first `len` rows are in use. It is replaced when it grows: don't keep it.
    """

    def __init__(self, width: int) -> None:
        self.rows: dict[int, int] = {}
        self.data: Array = np.zeros((16, width))
        self._ids: NDArray[np.uint32] = np.zeros(16, np.uint32)

    def __len__(self) -> int:
        """Rows in use."""
        return len(self.rows)

    def __getitem__(self, number: int) -> Array:
        """The row of an id, to be read or written in place."""
        return self.data[self.rows[number]]

    @property
    def ids(self) -> NDArray[np.uint32]:
        """(n,) ids in the order of rows."""
        return self._ids[: len(self.rows)]

    @property
    def used(self) -> Array:
        """(n, width) the rows in use."""
        return self.data[: len(self.rows)]

    def add(self, number: int, pose: Array) -> None:
        """A new row at the end."""
        row = len(self.rows)
        if row == len(self.data):
            self.data = np.concatenate([self.data, np.zeros_like(self.data)])
            self._ids = np.concatenate([self._ids, np.zeros_like(self._ids)])
        self.rows[number] = row
        self._ids[row] = number
        self.data[row] = pose

    def remove(self, number: int) -> None:
        """Take a row out."""
        last = len(self.rows) - 1
        row = self.rows.pop(number)
        if row != last:
            mover = int(self._ids[last])
            self.data[row], self._ids[row] = self.data[last], mover
            self.rows[mover] = row
