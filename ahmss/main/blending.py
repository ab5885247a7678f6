"""The blending part: from the motions' frames to the one pose of the human (Ichiguchi 2000, 4.2.4).

Joint by joint (4.11), the root by increments; then inertialisation where the source changes; then hands, feet and gaze
are solved onto their targets.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.blending import blend, blend_root
from ahmss.body.inertialisation import Inertialiser
from ahmss.body.inverse import grips, solve
from ahmss.body.links import INDEX
from ahmss.body.skeleton import Skeleton
from ahmss.body.target_inertialisation import TargetInertialiser

__all__ = ["Blending", "Contribution"]

_ROOT, _ROTATIONS, _IMPORTANCE, _TARGETS = slice(1, 4), slice(4, 176), slice(176, 220), slice(220, 260)
_DRIVEN = np.array([INDEX[name] for name in ("right_hand", "left_hand", "right_foot", "left_foot", "head")])
_NOBODY = 1e-12
_LEAST = 1e-3  # the importance that a target has at least, for the sake of a motion that gives a target alone
_JUMP = 0.2  # a joint of which more than this share changes hands in one frame has a new source
_NO_TARGETS = np.zeros((5, 8))
_NOTHING = np.zeros(49)
_NO_JOINT, _NO_END = np.zeros(43, bool), np.zeros(5, bool)
_WEIGHTS = slice(227, 260, 8)
_DRIVEN_IMPORTANCE = 176 + _DRIVEN
_CHAINS = tuple(
    [INDEX[name] for name in chain]
    for chain in (
        ("right_upper_arm", "right_lower_arm", "right_hand"),
        ("left_upper_arm", "left_lower_arm", "left_hand"),
        ("right_upper_leg", "right_lower_leg", "right_foot"),
        ("left_upper_leg", "left_lower_leg", "left_foot"),
        ("spine", "head"),
    )
)

Rows = NDArray[np.bool_]


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
        self._inertialiser = Inertialiser(rate)
        self._targets = TargetInertialiser(skeleton, rate)
        self.place(rotations, root)

    def place(self, rotations: Array, root: Array) -> None:
        """Stand still in a pose."""
        self.rotations, self.root = rotations.copy(), root.copy()
        self.grips = grips(self.skeleton, rotations, root)
        self._source, self._source_root = self.rotations, self.root
        self._shares: dict[int, Array] = {}
        self._inertialiser.place(self.rotations, self.root)
        self._targets.place(self.rotations, self.root)

    @property
    def resting(self) -> bool:
        """Whether nothing moves without a motion."""
        return not self._shares and self._inertialiser.settled and self._targets.settled

    def step(self, motions: Sequence[Contribution]) -> None:
        """Make the next frame out of the motions' newest ones; with none the body comes to rest."""
        if not motions and self.resting:
            return
        joints, root_switched, ends = self._switches(motions)
        if joints is not _NO_JOINT:  # what nobody drives from now on stays where it is seen
            self._source = np.where(joints[:, None], self.rotations, self._source)
        if root_switched:
            self._source_root = self.root
        targets = _NO_TARGETS
        if len(motions) == 1:
            targets = self._follow(motions[0])
        elif motions:
            targets = self._blend(motions)
        rotations, root = self._inertialiser.step(self._source, self._source_root, joints, root_switched)
        targets = self._targets.step(targets, ends)
        if targets[:, 7].any():
            rotations = solve(self.skeleton, rotations, root, targets)
        self._inertialiser.settle(rotations, root)
        self._targets.settle(rotations, root)
        self.rotations, self.root = rotations, root
        self.grips = grips(self.skeleton, rotations, root)

    def _follow(self, motion: Contribution) -> Array:
        """One motion alone: its joints as they are, on the hemisphere of the last ones; returns its targets."""
        row = motion.row
        rotations = row[_ROTATIONS].reshape(43, 4)
        importance = row[_IMPORTANCE]
        rotations = rotations * np.copysign(1.0, np.einsum("jc,jc->j", rotations, self._source))[:, None]
        owned = importance > _NOBODY
        self._source = rotations if owned.all() else np.where(owned[:43, None], rotations, self._source)
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

    def _switches(self, motions: Sequence[Contribution]) -> tuple[Rows, bool, Rows]:
        """Which joints (43,), whether the root, and which targets (5,) have another source than a frame before."""
        before, shares = self._shares, _shares(motions)
        self._shares = shares
        if len(shares) == 1 and shares.keys() == before.keys():
            (number,) = shares
            if np.array_equal(shares[number], before[number]):
                return _NO_JOINT, False, _NO_END
        change, gone = np.zeros(49), np.zeros(5)
        for number in shares.keys() | before.keys():
            now, then = shares.get(number, _NOTHING), before.get(number, _NOTHING)
            change += np.abs(now - then)
            gone += then[44:] - now[44:]
        switched = change > _JUMP
        if not switched.any():
            return _NO_JOINT, _gains_one_owner(shares, before), _NO_END
        joints = switched[:43]
        for end in np.flatnonzero(gone > _JUMP):  # a limb that loses its target falls back to its own rotations
            joints[_CHAINS[end]] = True
        return joints, bool(switched[43]) or _gains_one_owner(shares, before), switched[44:]


def _shares(motions: Sequence[Contribution]) -> dict[int, Array]:
    """Each motion's share (49,) of each joint, of the root and of each target."""
    shares: dict[int, Array] = {}
    if len(motions) == 1:
        row, share = motions[0].row, np.empty(49)
        np.greater(row[_IMPORTANCE], _NOBODY, out=share[:44], casting="unsafe")
        share[44:] = row[_WEIGHTS]
        return {motions[0].number: share}
    for motion in motions:
        share = np.empty(49)
        share[:44] = motion.row[_IMPORTANCE]
        share[44:] = motion.row[_WEIGHTS] * np.maximum(motion.row[_DRIVEN_IMPORTANCE], _LEAST)
        shares[motion.number] = share
    if shares:
        total = np.sum(list(shares.values()), axis=0) + _NOBODY
        total[44:] /= np.max([motion.row[_WEIGHTS] for motion in motions], axis=0) + _NOBODY
        for share in shares.values():
            share /= total
    return shares


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
