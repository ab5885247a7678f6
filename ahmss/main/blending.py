"""The blending part: from the motions' frames to the one pose of the human (Ichiguchi 2000, 4.2.4).

Joint by joint (4.11), the root by increments; then inertialisation where the source changes; then hands, feet and gaze
are solved onto their targets.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ahmss.body.array import Array
from ahmss.body.blending import blend, blend_root
from ahmss.body.inertialisation import Inertialiser
from ahmss.body.inverse import grips, solve
from ahmss.body.links import INDEX
from ahmss.body.skeleton import Skeleton

__all__ = ["Blending", "Contribution"]

_ROOT, _ROTATIONS, _IMPORTANCE, _TARGETS = slice(1, 4), slice(4, 176), slice(176, 220), slice(220, 260)
_DRIVEN = np.array([INDEX[name] for name in ("right_hand", "left_hand", "right_foot", "left_foot", "head")])
_NOBODY = 1e-12
_LEAST = 1e-3  # the importance that a target has at least, for the sake of a motion that gives a target alone
_JUMP = 0.2  # a joint of which more than this share changes hands in one frame has a new source
_NO_TARGETS = np.zeros((5, 8))


class Contribution:
    """What one motion gives to the blend: its newest frame, a POSE row (260,)."""

    __slots__ = ("number", "previous_root", "row")

    def __init__(self, number: int, row: Array) -> None:
        self.number, self.row = number, row
        self.previous_root = row[_ROOT]

    def advance(self, row: Array) -> None:
        """Its next frame has come."""
        self.previous_root, self.row = self.row[_ROOT], row

    def hold(self) -> None:
        """Its next frame has not come: it stays where it is."""
        self.previous_root = self.row[_ROOT]


class Blending:
    """One human's pose, frame after frame.

    rotations (43, 4), root (3,) and grips (2, 7) are what the world is shown.
    """

    def __init__(self, skeleton: Skeleton, rotations: Array, root: Array, rate: float) -> None:
        self.skeleton = skeleton
        self._inertialiser = Inertialiser(skeleton, rate)
        self.place(rotations, root)

    def place(self, rotations: Array, root: Array) -> None:
        """Stand still in a pose."""
        self.rotations, self.root = rotations.copy(), root.copy()
        self.grips = grips(self.skeleton, rotations, root)
        self._source, self._source_root = self.rotations, self.root
        self._shares: dict[int, Array] = {}
        self._inertialiser.begin(rotations, root)

    def step(self, motions: Sequence[Contribution]) -> None:
        """Make the next frame out of the motions' newest ones; with none the body comes to rest."""
        if not motions and not self._shares and self._inertialiser.settled:
            return
        if self._changes_hands(motions):
            self._source, self._source_root = self.rotations, self.root
            self._inertialiser.change()
        targets = _NO_TARGETS
        if len(motions) == 1:
            targets = self._follow(motions[0])
        elif motions:
            targets = self._blend(motions)
        rotations, root, targets = self._inertialiser.smooth(self._source, self._source_root, targets)
        if targets[:, 7].any():
            rotations = solve(self.skeleton, rotations, root, targets)
        self._inertialiser.shown(rotations, root)
        self.rotations, self.root = rotations, root
        self.grips = grips(self.skeleton, rotations, root)

    def _follow(self, motion: Contribution) -> Array:
        """One motion alone: its joints as they are, on the hemisphere of the last ones; returns its targets."""
        row = motion.row
        rotations = row[_ROTATIONS].reshape(43, 4)
        importance = row[_IMPORTANCE]
        sign = np.copysign(1.0, np.einsum("jc,jc->j", rotations, self._source))
        owned = importance > _NOBODY
        if owned.all():
            self._source = rotations * sign[:, None]
            self._source_root = row[_ROOT]
        else:
            self._source = np.where(owned[:43, None], rotations * sign[:, None], self._source)
            if owned[43]:
                self._source_root = row[_ROOT]
        return row[_TARGETS].reshape(5, 8)

    def _blend(self, motions: Sequence[Contribution]) -> Array:
        """Several motions; returns their targets as one."""
        rows = np.array([motion.row for motion in motions])
        importance = rows[:, _IMPORTANCE]
        rotations = rows[:, _ROTATIONS].reshape(-1, 43, 4)
        self._source = blend(rotations, importance[:, :43], self._source)
        owners = np.flatnonzero(importance[:, 43] > _NOBODY)
        if len(owners) == 1:
            self._source_root = rows[owners[0], _ROOT]
        elif len(owners):
            increments = rows[:, _ROOT] - np.array([motion.previous_root for motion in motions])
            self._source_root = blend_root(increments, importance[:, 43], self._source_root)
        return _merge(rows[:, _TARGETS].reshape(-1, 5, 8), importance)

    def _changes_hands(self, motions: Sequence[Contribution]) -> bool:
        """Whether some joint's source is not the one of the frame before."""
        shares = _shares(motions)
        before, self._shares = self._shares, shares
        if len(shares) == 1 and shares.keys() == before.keys():
            (number,) = shares
            return not np.array_equal(shares[number], before[number])
        zero = np.zeros(44)
        change = np.zeros(44)
        for number in shares.keys() | before.keys():
            change += np.abs(shares.get(number, zero) - before.get(number, zero))
        return bool((change > _JUMP).any()) or _gains_one_owner(shares, before)


def _shares(motions: Sequence[Contribution]) -> dict[int, Array]:
    """Each motion's share (44,) of each joint and of the root."""
    if len(motions) == 1:
        return {motions[0].number: (motions[0].row[_IMPORTANCE] > _NOBODY).astype(float)}
    importance = {motion.number: motion.row[_IMPORTANCE] for motion in motions}
    total = sum(importance.values(), np.full(44, _NOBODY))
    return {number: own / total for number, own in importance.items()}


def _gains_one_owner(shares: dict[int, Array], before: dict[int, Array]) -> bool:
    """Whether the root had several owners, who share its way, and has now one alone, who is followed to its place."""
    owners = sum(1 for share in shares.values() if share[43] > 0.0)
    return owners == 1 and sum(1 for share in before.values() if share[43] > 0.0) > 1


def _merge(targets: Array, importance: Array) -> Array:
    """Several motions' targets (n, 5, 8) as one (5, 8), by weight and the importance of the link that each drives.

    A target that one motion alone gives keeps its weight: averages dilute contact.
    """
    share = targets[..., 7] * np.maximum(importance[:, _DRIVEN], _LEAST)
    total = share.sum(axis=0)
    if not total.any():
        return _NO_TARGETS
    share = share / np.where(total > 0.0, total, 1.0)
    first = targets[share.argmax(axis=0), np.arange(5)]
    merged = np.empty((5, 8))
    merged[:, :3] = np.einsum("nt,ntc->tc", share, targets[..., :3])
    turns = targets[..., 3:7]
    sign = np.copysign(1.0, np.einsum("ntc,tc->nt", turns, first[:, 3:7]))
    merged[:, 3:7] = np.einsum("nt,ntc->tc", share * sign, turns)
    length = np.sqrt(np.einsum("tc,tc->t", merged[:, 3:7], merged[:, 3:7]))
    merged[:, 3:7] /= np.where(length > _NOBODY, length, 1.0)[:, None]
    merged[:, 7] = targets[..., 7].max(axis=0)
    return merged
