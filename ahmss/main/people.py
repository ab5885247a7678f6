"""The other humans as algorithms see them: where they stand on the floor, how they face, where they mean to be."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ahmss.algorithm.messages import ObjectRecord
from ahmss.body.array import Array
from ahmss.body.floor_frame import floor_frame
from ahmss.motion.way import WAY_WIDTH
from ahmss.world.view import World

__all__ = ["People", "records"]

_KIND = "human"
_HIPS = 7  # numbers of a pose that say where the hips are: place, then rotation


def records(world: World, own: str) -> list[ObjectRecord]:
    """All humans but the acting one, for START.

    Their ids are the world's with a minus: the world counts humans and objects each from 1.
    """
    numbers, hips, _ = _others(world, own)
    names = {record.id: record.name for record in world.humans.values()}
    out: list[ObjectRecord] = []
    for number, x, y, z, *rotation in _rows(numbers, hips).tolist():
        w, i, j, k = rotation
        out.append(ObjectRecord(int(number), names.get(-int(number), ""), _KIND, (x, y, z), (w, i, j, k)))
    return out


class People:
    """Compares where the others are, and mean to be, with how it was a frame before."""

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """Nobody asks: who does next is told of all at first."""
        self._numbers: NDArray[np.uint32] = np.zeros(0, np.uint32)
        self._hips, self._ways = np.zeros((0, _HIPS)), np.zeros((0, WAY_WIDTH))

    def moved(self, world: World, own: str) -> Array:
        """Rows (n, 8) of id, place, rotation of the other humans that moved, or mean to, since the last call.

        Of who has gone there is a row of NaN, so that nobody waits for them.
        """
        before = self._numbers, self._hips, self._ways
        numbers, hips, ways = self._numbers, self._hips, self._ways = _others(world, own)
        if np.array_equal(numbers, before[0]):
            changed = (hips != before[1]).any(axis=1)
            changed |= ((ways != before[2]) & ~(np.isnan(ways) & np.isnan(before[2]))).any(axis=1)
            return _rows(numbers[changed], hips[changed])
        left = before[0][~np.isin(before[0], numbers)]
        gone = np.full((len(left), 8), np.nan)
        gone[:, 0] = -left.astype(np.float64)
        return np.concatenate([_rows(numbers, hips), gone])

    def ways(self, numbers: Array) -> Array:
        """(n, 12) the ways of humans now, by the ids (n,) of their rows; NaN of who tells none, or is gone."""
        ways = np.full((len(numbers), WAY_WIDTH), np.nan)
        if len(self._numbers):
            order = np.argsort(self._numbers)
            at = order[np.searchsorted(self._numbers, -numbers, sorter=order).clip(max=len(order) - 1)]
            there = self._numbers[at] == -numbers
            ways[there] = self._ways[at[there]]
        return ways


def _others(world: World, own: str) -> tuple[NDArray[np.uint32], Array, Array]:
    """Ids (n,) of the other humans, their hips (n, 7) and ways (n, 12)."""
    record = world.humans.get(own)
    others = world.human_ids != (0 if record is None else record.id)
    hips, ways = world.human_poses[others, :_HIPS], world.human_ways[others]
    return world.human_ids[others], hips.astype(np.float64), ways.reshape(-1, WAY_WIDTH).astype(np.float64)


def _rows(numbers: NDArray[np.uint32], hips: Array) -> Array:
    """Rows (n, 8) of -id, and the floor frame of each."""
    place, rotation = floor_frame(hips[:, None, 3:], hips[:, :3])
    return np.concatenate([-numbers[:, None].astype(np.float64), place, rotation], axis=1)
