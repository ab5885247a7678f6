"""What has moved in the world since the last frame, for the algorithms that asked to be told."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.world.view import World

__all__ = ["Surroundings", "among"]


class Surroundings:
    """Compares the world with how it was a frame before."""

    def __init__(self) -> None:
        self._poses: Array | None = None
        self._revision = -1

    def forget(self) -> None:
        """Nobody asks: what moves until somebody does is told by START."""
        self._poses = None

    def moved(self, world: World, own: Array) -> Array:
        """Rows (n, 8) of id, place, rotation of what moved since the last call.

        Args:
            world: as it is now.
            own: (m, 8) rows of what this main has moved, newer than the world.
        """
        numbers, poses = world.poses()
        before, self._poses = self._poses, poses.copy()
        if before is None or self._revision != world.revision:
            self._revision = world.revision
            return own
        changed = (before != poses).any(axis=1)
        if not changed.any():
            return own
        changed &= ~np.isin(numbers, own[:, 0])
        rows = np.empty((int(changed.sum()), 8))
        rows[:, 0], rows[:, 1:] = numbers[changed], poses[changed]
        return np.concatenate([own, rows]) if len(own) else rows


def among(moved: Array, known: frozenset[int]) -> Array | None:
    """Those rows whose objects an algorithm knows of; None where there are none."""
    if not known or not len(moved):
        return None
    chosen = [int(number) in known for number in moved[:, 0]]
    return moved[chosen] if any(chosen) else None
