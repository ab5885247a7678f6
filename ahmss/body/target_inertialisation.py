"""Inertialisation of targets: a new target takes hold of hand or foot where it is."""

from __future__ import annotations

from typing import Any

import numpy as np

from ahmss.body.array import Array
from ahmss.body.inertialisation import Places, Rotations, Rows
from ahmss.body.inverse import ends
from ahmss.body.skeleton import Skeleton

__all__ = ["TargetInertialiser"]


class TargetInertialiser:
    """Smooths the targets (5, 8) of one human.

    A hand's or foot's new target starts out from where the end is and goes over to the wanted place; where the end is
    there already, as a planted foot, nothing moves. The gaze's target stays as it is: see `gaze_inertialisation`.
    """

    def __init__(self, skeleton: Skeleton, rate: float, seconds: float = 0.4) -> None:
        """Smooth at a rate (frames a second) over some seconds."""
        self._skeleton = skeleton
        self._places = Places(4, rate, seconds)
        self._turns = Rotations(4, rate, seconds)
        self._poses: list[tuple[Array, Array]] = []  # the last that came out, newest last, at most two

    @property
    def settled(self) -> bool:
        """Whether nothing decays."""
        return self._places.settled and self._turns.settled

    def place(self, rotations: Array, root: Array) -> None:
        """Stand still in a pose, rotations (43, 4) and root (3,), that met no target."""
        self._poses = [(rotations, root)]
        self._places.place(_NO_PLACES)
        self._turns.place(_NO_TURNS)

    def settle(self, rotations: Array, root: Array) -> None:
        """Tell the pose that came out in the end. Not to be changed after."""
        self._poses = [*self._poses[-1:], (rotations, root)]

    def step(self, targets: Array, switched: Rows) -> Array:
        """The smoothed targets (5, 8) of this frame; those given while nothing decays.

        Args:
            targets: (5, 8) place, rotation (all 0: free) and weight; world.
            switched: (5,) whose source is another one from this frame on.
        """
        if self.settled and not switched[:4].any():
            return targets
        held: Any = targets[:4, 7] > 0.0
        free: Any = ~targets[:4, 3:7].any(axis=1)
        fresh = switched[:4] & held
        if fresh.any() and self._poses:
            self._take_hold()
        out = targets.copy()
        out[:4, :3] = self._places.step(targets[:4, :3], fresh)
        turns = np.where(free[:, None], _NO_TURNS, targets[:4, 3:7])
        out[:4, 3:7] = np.where(free[:, None], 0.0, self._turns.step(turns, fresh & ~free))
        return out

    def _take_hold(self) -> None:
        """New targets of hands and feet start where these are, with the velocity that they have."""
        for rotations, root in (self._poses[0], self._poses[-1]):  # one pose twice: it stood still
            seen = ends(self._skeleton, rotations, root)
            self._places.settle(seen[:, :3])
            self._turns.settle(seen[:, 3:])


_NO_PLACES, _NO_TURNS = np.zeros((4, 3)), np.tile([1.0, 0.0, 0.0, 0.0], (4, 1))
