"""The blending part: from the motions' frames to the one pose of the human (Ichiguchi 2000, 4.2.4).

Joint by joint (4.11), the root by increments; then inertialisation where the source changes; then hands, feet and gaze
are solved onto their targets. Spine and head are smoothed after the gaze has turned them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.blending import blend, blend_root
from ahmss.body.gaze_inertialisation import TURNED, GazeInertialiser
from ahmss.body.inertialisation import Inertialiser
from ahmss.body.inverse import GAZE, grips, solve
from ahmss.body.links import INDEX
from ahmss.body.skeleton import Skeleton
from ahmss.body.target_inertialisation import TargetInertialiser
from ahmss.motion.way import UNKNOWN, known

__all__ = ["Blending", "Contribution"]

_ROOT, _ROTATIONS, _IMPORTANCE, _TARGETS = slice(1, 4), slice(4, 176), slice(176, 220), slice(220, 260)
_DRIVEN = np.array([INDEX[name] for name in ("right_hand", "left_hand", "right_foot", "left_foot", "head")])
_POSE = 260  # numbers of a POSE without a way
_ROOT_IMPORTANCE = 219
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
    )
)

_LIMBS = ~np.isin(np.arange(43), TURNED)
_LOOKS = (np.arange(5) == GAZE)[:, None]

Rows = NDArray[np.bool_]


class Contribution:
    """What one motion gives to the blend: its newest frame, a POSE row (260,), and the way that it tells, or None."""

    __slots__ = ("number", "previous_root", "row", "way")

    def __init__(self, number: int, row: Array) -> None:
        self.number = number
        self._take(row)
        self.previous_root = row[_ROOT]

    def advance(self, row: Array) -> None:
        """Its next frame has come, (260,) or (272,)."""
        self.previous_root = self.row[_ROOT]
        self._take(row)

    def _take(self, row: Array) -> None:
        self.row = row[:_POSE]
        self.way = known(row[_POSE:]) if len(row) > _POSE else None

    def hold(self) -> None:
        """Its next frame has not come: it stays where it is."""
        self.previous_root = self.row[_ROOT]

    @property
    def claims(self) -> tuple[int, bytes, bytes]:
        """What it claims of the body: equal claims in two frames mean that nothing changes hands."""
        return self.number, self.row[_IMPORTANCE].tobytes(), self.row[_WEIGHTS].tobytes()


class Blending:
    """One human's pose, frame after frame.

    rotations (43, 4), root (3,) and grips (2, 7) are what the world is shown. way (6, 2) is told with them: that of the
    motion which takes the root along, NaN where none tells one.
    """

    def __init__(self, skeleton: Skeleton, rotations: Array, root: Array, rate: float) -> None:
        self.skeleton = skeleton
        self._inertialiser = Inertialiser(rate)
        self._targets = TargetInertialiser(skeleton, rate)
        self._looking = GazeInertialiser(rate)
        self.place(rotations, root)

    def place(self, rotations: Array, root: Array) -> None:
        """Stand still in a pose."""
        self.rotations, self.root = rotations.copy(), root.copy()
        self.grips = grips(self.skeleton, rotations, root)
        self.way = UNKNOWN
        self._source, self._source_root = self.rotations, self.root
        # The last two frames, newest last: before the targets were solved, and as they were shown.
        self._plain = self._shown = (self.rotations, self.rotations)
        self._claims: list[tuple[int, bytes, bytes]] = []
        self._shares: dict[int, Array] = {}
        self._owned, self._all_owned, self._any_target = np.zeros(44, bool), False, False
        self._gazes = self._ceased = False  # a gaze is given; it was until a frame ago
        self._merge = _NO_MERGE
        self._inertialiser.place(self.rotations, self.root)
        self._targets.place(self.rotations, self.root)
        self._looking.place(self.rotations)

    @property
    def resting(self) -> bool:
        """Whether nothing moves without a motion."""
        settled = self._inertialiser.settled and self._targets.settled and self._looking.settled
        return not self._claims and settled

    def step(self, motions: Sequence[Contribution]) -> None:
        """Make the next frame out of the motions' newest ones; with none the body comes to rest."""
        self.way = _way(motions)
        if not motions and self.resting:
            return
        claims = [motion.claims for motion in motions]
        joints, root_switched, ends = _NO_JOINT, False, _NO_END
        if claims != self._claims:
            self._claims = claims
            joints, lost, root_switched, ends = self._switches(motions)
            if joints is not _NO_JOINT:
                self._begin_at_what_is_seen(joints, lost)
        if root_switched:
            self._source_root = self.root
        targets = _NO_TARGETS
        if len(motions) == 1:
            targets = self._follow(motions[0])
        elif motions:
            targets = self._blend(motions)
        rotations, root = self._source, self._source_root
        if joints is not _NO_JOINT or root_switched or not self._inertialiser.settled:
            rotations, root = self._inertialiser.step(rotations, root, joints & _LIMBS, root_switched)
        if ends is not _NO_END or not self._targets.settled:
            targets = self._targets.step(targets, ends)
        plain, switched = rotations, joints[TURNED]
        if switched.any() or not self._looking.settled:
            rotations, targets = self._turned(rotations, root, targets, switched), np.where(_LOOKS, 0.0, targets)
            plain = plain if self._gazes else rotations
        shown = solve(self.skeleton, rotations, root, targets) if self._any_target else rotations
        self._inertialiser.settle(plain, root)
        self._targets.settle(shown, root)
        self._looking.settle(shown)
        self._plain, self._shown = (self._plain[1], plain), (self._shown[1], shown)
        self.rotations, self.root = shown, root
        self.grips = grips(self.skeleton, shown, root)

    def _begin_at_what_is_seen(self, joints: Rows, lost: Rows) -> None:
        """Joints with a new source start from the present; what nobody drives from now on stays there.

        The present is what stood before the targets were solved, because those that go on are solved again; a limb that
        has lost its target starts from where it was shown. Spine and head that a gaze has turned come to rest.
        """
        present = self._plain
        if lost.any():
            present = tuple(np.where(lost[:, None], s, p) for s, p in zip(self._shown, self._plain, strict=True))
            for rotations in present:
                self._inertialiser.rotations.settle(rotations)
            self._plain = present  # a change in the next frame goes on from here too
        self._source = np.where(joints[:, None], present[1], self._source)
        if self._ceased:
            self._source[TURNED] = self._looking.rest(*self._shown)

    def _turned(self, rotations: Array, root: Array, targets: Array, switched: Rows) -> Array:
        """The pose (43, 4) whose spine and head, turned by the gaze, go on from where they are seen."""
        targets = np.where(_LOOKS, targets, 0.0)
        made = solve(self.skeleton, rotations, root, targets) if self._gazes else rotations.copy()
        made[TURNED] = self._looking.step(made, switched)
        return made

    def _follow(self, motion: Contribution) -> Array:
        """One motion alone: its joints as they are; returns its targets."""
        row = motion.row
        rotations = row[_ROTATIONS].reshape(43, 4)
        self._source = rotations if self._all_owned else np.where(self._owned[:43, None], rotations, self._source)
        if self._owned[43]:
            self._source_root = row[_ROOT]
        return row[_TARGETS].reshape(5, 8)

    def _blend(self, motions: Sequence[Contribution]) -> Array:
        """Several motions; returns their targets as one."""
        rows = np.array([motion.row for motion in motions])
        importance = rows[:, _IMPORTANCE]
        rotations = rows[:, _ROTATIONS].reshape(-1, 43, 4)
        self._source = blend(rotations, importance[:, :43], self._source)
        owners = [motion for motion, share in enumerate(importance[:, 43].tolist()) if share > _NOBODY]
        if len(owners) == 1:
            self._source_root = rows[owners[0], _ROOT]
        elif owners:
            increments = rows[:, _ROOT] - np.array([motion.previous_root for motion in motions])
            self._source_root = blend_root(increments, importance[:, 43], self._source_root)
        return self._merge.merge(rows[:, _TARGETS].reshape(-1, 5, 8))

    def _switches(self, motions: Sequence[Contribution]) -> tuple[Rows, Rows, bool, Rows]:
        """What has another source than a frame before: joints, those that lost a target (43,), root, targets (5,)."""
        before, shares = self._shares, _shares(motions)
        self._shares = shares
        total = sum(shares.values(), _NOTHING)
        self._owned = total[:44] > 0.0
        self._merge = _Merge(motions) if len(motions) > 1 else _NO_MERGE
        self._all_owned, self._any_target = bool(self._owned.all()), bool(total[44:].any())
        change, gone, looked = np.zeros(49), np.zeros(5), False
        for number in shares.keys() | before.keys():
            now, then = shares.get(number, _NOTHING), before.get(number, _NOTHING)
            change += np.abs(now - then)
            gone += then[44:] - now[44:]
            looked |= bool(then[44 + GAZE] > _NOBODY >= now[44 + GAZE])
        switched = change > _JUMP
        gazed, self._gazes = self._gazes, bool(total[44 + GAZE] > _NOBODY)
        self._ceased = gazed and not self._gazes
        spine, head = TURNED
        switched[spine] |= switched[44 + GAZE] | looked
        switched[head] |= switched[spine]  # from there it looks
        if not switched.any():
            return _NO_JOINT, _NO_JOINT, _gains_one_owner(shares, before), _NO_END
        joints, lost = switched[:43], np.zeros(43, bool)
        for end in np.flatnonzero(gone[:GAZE] > _JUMP):  # a limb that loses its target falls back to its own rotations
            joints[_CHAINS[end]] = lost[_CHAINS[end]] = True
        return joints, lost, bool(switched[43]) or _gains_one_owner(shares, before), switched[44:]


def _way(motions: Sequence[Contribution]) -> Array:
    """The way (6, 2) of the motion, of those that tell one, to which the root matters most; NaN where none does."""
    told = [motion for motion in motions if motion.way is not None]
    if not told:
        return UNKNOWN
    way = max(told, key=lambda motion: motion.row[_ROOT_IMPORTANCE]).way
    return UNKNOWN if way is None else way


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


class _Merge:
    """Several motions' targets as one, by weight and the importance of the link that each drives.

    A target that one motion alone gives keeps its weight: averages dilute contact.
    """

    def __init__(self, motions: Sequence[Contribution]) -> None:
        weights = np.array([motion.row[_WEIGHTS] for motion in motions])
        share = weights * np.maximum([motion.row[_DRIVEN_IMPORTANCE] for motion in motions], _LEAST)
        total = share.sum(axis=0)
        share = share / np.where(total > 0.0, total, 1.0)
        first, weights = share.argmax(axis=0).tolist(), weights.max(axis=0).tolist()
        shares: list[list[float]] = share.T.tolist()
        self._ends = list(zip(first, shares, (share > 0.0).sum(axis=0).tolist(), weights, strict=True))

    def merge(self, targets: Array) -> Array:
        """(n, 5, 8) as (5, 8); in plain floats, for a handful of them are faster than arrays."""
        rows = targets.tolist()
        merged: list[list[float]] = []
        for end, (first, shares, givers, weight) in enumerate(self._ends):
            mean = rows[first][end][:7] if givers < 2 else _mean([row[end] for row in rows], shares, first)
            merged.append([*mean, weight])
        return np.array(merged)


def _mean(rows: list[list[float]], shares: list[float], first: int) -> tuple[float, ...]:
    """The mean place and rotation (7) of a few targets (8), rotations on the side of the first's."""
    w0, x0, y0, z0 = rows[first][3:7]
    px = py = pz = w = x = y = z = 0.0
    for (ax, ay, az, qw, qx, qy, qz, _), share in zip(rows, shares, strict=True):
        px, py, pz = px + share * ax, py + share * ay, pz + share * az
        if qw * w0 + qx * x0 + qy * y0 + qz * z0 < 0.0:
            share = -share
        w, x, y, z = w + share * qw, x + share * qx, y + share * qy, z + share * qz
    length = math.sqrt(w * w + x * x + y * y + z * z)
    if length <= _NOBODY:
        length = 1.0
    return px, py, pz, w / length, x / length, y / length, z / length


_NO_MERGE = _Merge([Contribution(0, np.zeros(260))])
