"""What has moved in the world since the last frame, for the algorithms that asked to be told."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ahmss.body.array import Array
from ahmss.world.view import World

__all__ = ["NOTHING", "Surroundings", "among", "known", "latest"]

NOTHING: Array = np.zeros((0, 8))  # rows of id, place, rotation


class Surroundings:
    """Compares the world with how it was a frame before."""

    def __init__(self) -> None:
        self._before = b""

    def forget(self) -> None:
        """Nobody asks: what moves until somebody does is told by START."""
        self._before = b""

    def moved(self, world: World, own: Array) -> Array:
        """Rows (n, 8) of id, place, rotation of what moved since the last call.

        Args:
            world: as it is now.
            own: (m, 8) rows of what this main has moved, newer than the world.
        """
        numbers, poses = world.poses()
        before, self._before = self._before, poses.tobytes()
        if before == self._before or len(before) != len(self._before):
            return own
        changed = (np.frombuffer(before).reshape(-1, 7) != poses).any(axis=1)
        changed &= ~np.isin(numbers, own[:, 0])
        if not changed.any():
            return own
        rows = np.empty((int(changed.sum()), 8))
        rows[:, 0], rows[:, 1:] = numbers[changed], poses[changed]
        return np.concatenate([own, rows]) if len(own) else rows


def among(moved: Array, known: Array, *, strangers: bool = False) -> Array:
    """Those rows (n, 8) whose ids are among the known, (m,) in rising order; with `strangers` all humans as well."""
    if not len(moved) or not (len(known) or strangers):
        return NOTHING
    ids = moved[:, 0]
    chosen = np.zeros(len(ids), bool)
    if len(known):
        chosen |= known[known.searchsorted(ids).clip(max=len(known) - 1)] == ids  # np.isin takes ten times as long
    if strangers:
        chosen |= ids < 0.0
    return moved[chosen]


def latest(before: Array, now: Array) -> Array:
    """Rows (n, 8) and newer ones (m, 8) as one row for each id."""
    if not len(before):
        return now
    newest_first = np.concatenate([before, now])[::-1]
    _, first = np.unique(newest_first[:, 0], return_index=True)
    return newest_first[first]


def known(ids: Iterable[int]) -> Array:
    """Ids of what an algorithm knows of, for `among`."""
    return np.array(sorted(ids), np.float64)
