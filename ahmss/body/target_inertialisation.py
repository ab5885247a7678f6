"""Inertialisation of targets: a new target takes hold of hand or foot where it is, and of the gaze little by little."""

from __future__ import annotations

from typing import Any

import numpy as np

from ahmss.body.array import Array
from ahmss.body.inertialisation import Places, Rotations, Rows
from ahmss.body.inverse import GAZE, ends
from ahmss.body.skeleton import Skeleton

__all__ = ["TargetInertialiser"]

_SAME = 0.02  # metres, or share of weight, by which what is looked at may differ to be the same
_GAZE_LONGER = 1.5  # a head turns towards a new place in some 0.6 s


class TargetInertialiser:
    """Smooths the targets (5, 8) of one human.

    A hand's or foot's new target starts out from where the end is and goes over to the wanted place; where the end is
    there already, as a planted foot, nothing moves. The gaze has no such place: its new target gains weight instead,
    and if it had one before, it moves over.
    """

    def __init__(self, skeleton: Skeleton, rate: float, seconds: float = 0.4) -> None:
        """Smooth at a rate (frames a second) over some seconds."""
        self._skeleton = skeleton
        self._places = Places(4, rate, seconds)
        self._turns = Rotations(4, rate, seconds)
        self._gaze = Places(2, rate, _GAZE_LONGER * seconds)  # its place; its weight, as (weight, 0, 0)
        self._wanted = _NO_GAZE  # the gaze's rows that came last
        self._poses: list[tuple[Array, Array]] = []  # the last that came out, newest last, at most two

    @property
    def settled(self) -> bool:
        """Whether nothing decays."""
        return self._places.settled and self._turns.settled and self._gaze.settled

    def place(self, rotations: Array, root: Array) -> None:
        """Stand still in a pose, rotations (43, 4) and root (3,), that met no target."""
        self._poses = [(rotations, root)]
        for channel, values in ((self._places, _NO_PLACES), (self._turns, _NO_TURNS), (self._gaze, _NO_GAZE)):
            channel.place(values)

    def settle(self, rotations: Array, root: Array) -> None:
        """Tell the pose that came out in the end. Not to be changed after."""
        self._poses = [*self._poses[-1:], (rotations, root)]

    def step(self, targets: Array, switched: Rows) -> Array:
        """The smoothed targets (5, 8) of this frame; those given while nothing decays.

        Args:
            targets: (5, 8) place, rotation (all 0: free) and weight; world.
            switched: (5,) whose source is another one from this frame on.
        """
        gaze = _gaze_rows(targets)
        # Two motions that look at the same thing, one after the other, are one gaze.
        new_gaze = bool(switched[GAZE]) and bool(np.abs(gaze - self._wanted).max() > _SAME)
        self._wanted = gaze
        if self.settled and not switched.any():
            self._gaze.settle(gaze)
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
        self._step_gaze(out, gaze, new_gaze)
        return out

    def _take_hold(self) -> None:
        """New targets of hands and feet start where these are, with the velocity that they have."""
        for rotations, root in (self._poses[0], self._poses[-1]):  # one pose twice: it stood still
            seen = ends(self._skeleton, rotations, root)
            self._places.settle(seen[:, :3])
            self._turns.settle(seen[:, 3:])

    def _step_gaze(self, out: Array, gaze: Array, switched: bool) -> None:
        """Fill in the gaze's row: one that had a target moves over, one that had none gains weight, the end is at once.

        The end may be at once because the joints, inertialised, come from where the head is seen.
        """
        before = self._gazed
        wanted = gaze[1, 0] > 0.0
        rows = np.array([switched and wanted and before[1, 0] > 0.0, switched and wanted])
        smoothed = self._gaze.step(gaze, rows)
        if wanted:
            out[GAZE, :3], out[GAZE, 7] = smoothed[0], min(max(smoothed[1, 0], 0.0), 1.0)
        self._gaze.settle(_gaze_rows(out))

    @property
    def _gazed(self) -> Array:
        """The gaze's rows that were given out last."""
        return _NO_GAZE if self._gaze.present is None else self._gaze.present


_NO_PLACES, _NO_TURNS, _NO_GAZE = np.zeros((4, 3)), np.tile([1.0, 0.0, 0.0, 0.0], (4, 1)), np.zeros((2, 3))


def _gaze_rows(targets: Array) -> Array:
    """The gaze as rows of a channel (2, 3): its place, and its weight in the first column."""
    rows = np.zeros((2, 3))
    rows[0] = targets[GAZE, :3]
    rows[1, 0] = targets[GAZE, 7]
    return rows
