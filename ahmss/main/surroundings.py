"""What has moved in the world since the last frame, for the algorithms that asked to be told."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.world.view import World

__all__ = ["Surroundings", "among"]


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


def among(moved: Array, known: frozenset[int]) -> Array | None:
    """Those rows whose objects an algorithm knows of; None where there are none."""
    if not known or not len(moved):
        return None
    chosen = [int(number) in known for number in moved[:, 0]]
    return moved[chosen] if any(chosen) else None
