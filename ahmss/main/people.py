"""The other humans as algorithms see them: where they stand on the floor, and which way they face."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ahmss.algorithm.messages import ObjectRecord
from ahmss.body.array import Array
from ahmss.motion.edit import floor_frame
from ahmss.world.view import World

__all__ = ["People", "records"]

_KIND = "human"
_HIPS = 7  # numbers of a pose that say where the hips are: place, then rotation


def records(world: World, own: str) -> list[ObjectRecord]:
    """All humans but the acting one, for START.

    Their ids are the world's with a minus: the world counts humans and objects each from 1.
    """
    numbers, hips = _others(world, own)
    names = {record.id: record.name for record in world.humans.values()}
    out: list[ObjectRecord] = []
    for number, x, y, z, *rotation in _rows(numbers, hips).tolist():
        w, i, j, k = rotation
        out.append(ObjectRecord(int(number), names.get(-int(number), ""), _KIND, (x, y, z), (w, i, j, k)))
    return out


class People:
    """Compares where the others are with where they were a frame before."""

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """Nobody asks: who does next is told of all at first."""
        self._numbers: NDArray[np.uint32] = np.zeros(0, np.uint32)
        self._hips = np.zeros((0, _HIPS))

    def moved(self, world: World, own: str) -> Array:
        """Rows (n, 8) of id, place, rotation of the other humans that moved since the last call."""
        numbers, hips = _others(world, own)
        changed = np.ones(len(numbers), bool)
        if np.array_equal(numbers, self._numbers):
            changed = (hips != self._hips).any(axis=1)
        self._numbers, self._hips = numbers, hips
        return _rows(numbers[changed], hips[changed])


def _others(world: World, own: str) -> tuple[NDArray[np.uint32], Array]:
    """Ids (n,) of the other humans, and their hips (n, 7)."""
    record = world.humans.get(own)
    others = world.human_ids != (0 if record is None else record.id)
    return world.human_ids[others], world.human_poses[others, :_HIPS].astype(np.float64)


def _rows(numbers: NDArray[np.uint32], hips: Array) -> Array:
    """Rows (n, 8) of -id, and the floor frame of each."""
    place, rotation = floor_frame(hips[:, None, 3:], hips[:, :3])
    return np.concatenate([-numbers[:, None].astype(np.float64), place, rotation], axis=1)
