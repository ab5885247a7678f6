"""Points of legs and arms that walk, how thick they are there, and how they are to be moved out of things."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.walking.fence import Fence
from ahmss.walking.shaping import Shaped

__all__ = ["OF_FOOT", "Limbs", "held_arms"]

OF_FOOT = slice(4, 7)
"""Which of a leg's points are of its foot."""

_UPPER, _LOWER = ([INDEX[f"{side}_{part}_leg"] for side in ("right", "left")] for part in ("upper", "lower"))
_SPINE = INDEX["spine"]
_SHOULDERS, _ELBOWS = ([INDEX[f"{side}_{part}_arm"] for side in ("right", "left")] for part in ("upper", "lower"))
_MIRROR = np.array([1.0, -1.0, 1.0])
# Hip joint, thigh, knee, shank, ankle, heel, toes; shoulder, elbow, forearm, wrist, fingers: how thick it is there in
# the stouter of the bodies that ship, and a little more, metres; by how much it goes with the foot, else with the hips.
_THICK = np.array([0.116, 0.086, 0.068, 0.072, 0.068, 0.051, 0.051, 0.06, 0.065, 0.055, 0.05, 0.05])
_WITH_FOOT = np.array([0.0, 0.3, 0.5, 0.75, 0.95, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
_OF_ARM = 4
_THING = 0.02  # metres that a point of what is in a hand keeps


class Limbs:
    """Points (f, 2, P, 3) of legs and elbows at the frames that are looked at, and how clear of things they are."""

    def __init__(self, frames: NDArray[np.intp], points: Array, fence: Fence) -> None:
        self._frames, self._points, self._fence = frames, points[..., :2], fence
        more = points.shape[2] - len(_THICK)
        thick, self._with_foot = np.append(_THICK, np.full(more, _THING)), np.append(_WITH_FOOT, np.zeros(more))
        self._lows = (points[..., 2] - thick).reshape(-1)
        self._thick = np.broadcast_to(thick, points.shape[:-1]).reshape(-1)
        self._seen = self._points.reshape(-1, 2).copy()  # where points were when it was looked at how far they are
        self._away, self._out = fence.away(self._seen, self._lows)

    @classmethod
    def of(
        cls, skeleton: Skeleton, shaped: Shaped, frames: NDArray[np.intp], fence: Fence, held: Array | None
    ) -> Limbs:
        """Of a walk."""
        hips, root = shaped.rotations[frames, :1], shaped.root[frames]
        joints = root[:, None] + rotate(hips, skeleton.offsets[_UPPER])
        thighs = multiply(hips, shaped.rotations[frames][:, _UPPER])
        knees = joints + rotate(thighs, skeleton.offsets[_LOWER])
        ankles, feet = shaped.ankles[frames], shaped.feet[frames]
        soles = np.stack([skeleton.soles, skeleton.soles * _MIRROR])
        heels, toes = soles[:, 0] * (0.5, 1.0, 0.5), soles[:, 2] * (0.82, 1.0, 0.5)
        points = np.stack([
            joints, joints + 0.65 * (knees - joints), knees, 0.5 * (knees + ankles), ankles,
            ankles + rotate(feet, heels), ankles + rotate(feet, toes),
        ], axis=2)  # fmt: skip
        count = _OF_ARM if held is None else held.shape[1]
        shoulders, elbows = _hanging(skeleton, shaped, frames)
        arms = np.repeat(elbows[:, :, None], count, axis=2)
        if held is not None:
            stay = root[:, None, None] + rotate(hips[:, :, None], held)
            arms = np.where(np.isnan(held), arms, stay)
        return cls(frames, np.concatenate([points, shoulders[:, :, None], arms], axis=2), fence)

    def push(self, body: Array, feet: Sequence[Array]) -> Array:
        """By how much the points are to be moved (f, 2, P, 2) out of things when body and feet are moved (F, 2)."""
        by_body = body[self._frames][:, None, None]
        by_foot = np.stack([foot[self._frames] for foot in feet], axis=1)[:, :, None]
        at = (self._points + by_body + self._with_foot[:, None] * (by_foot - by_body)).reshape(-1, 2)
        moved = at - self._seen
        doubtful = np.flatnonzero(self._away - np.sqrt((moved * moved).sum(axis=-1)) < self._thick)
        if len(doubtful):
            self._seen[doubtful] = at[doubtful]
            self._away[doubtful], self._out[doubtful] = self._fence.away(at[doubtful], self._lows[doubtful])
        lack = np.zeros(len(at))
        lack[doubtful] = np.maximum(self._thick - self._away, 0.0)[doubtful]
        return (lack[:, None] * self._out).reshape(self._points.shape)


def held_arms(
    skeleton: Skeleton, rotations: Array, root: Array, sides: Sequence[str], things: Mapping[str, Array] | None = None
) -> Array:
    """Elbow, forearm, wrist and fingers of arms that stay as they are in a pose (43, 4), (3,), against its hips.

    Args:
        skeleton: whose. rotations, root: the pose. sides: of the arms.
        things: points (n, 3) of what is in the hand of a side, in the hand's frame.

    Returns:
        (2, 4 + n, 3) right and left, with what is in their hands; nan for an arm that is not among the sides.
    """
    places, turned = forward(rotations, root, skeleton.offsets)
    things = things or {}
    out = np.full((2, _OF_ARM + max((len(points) for points in things.values()), default=0), 3), np.nan)
    for i, side in enumerate(("right", "left")):
        if side in sides:
            elbow, wrist, finger = (INDEX[f"{side}_{name}"] for name in ("lower_arm", "hand", "middle_intermediate"))
            points = [places[elbow], 0.5 * (places[elbow] + places[wrist]), places[wrist], places[finger]]
            points += [*(places[wrist] + rotate(turned[wrist], things.get(side, np.zeros((0, 3)))))]
            out[i, : len(points)] = rotate(conjugate(turned[0]), np.array(points) - root)
    return out


def _hanging(skeleton: Skeleton, shaped: Shaped, frames: NDArray[np.intp]) -> tuple[Array, Array]:
    """Both shoulders and elbows (f, 2, 3), as they are where nothing else has the arms."""
    hips, trunk = shaped.rotations[frames, 0], shaped.rotations[frames, _SPINE]
    spine = multiply(hips, trunk)[:, None]
    shoulders = rotate(hips, skeleton.offsets[_SPINE])[:, None] + rotate(spine, skeleton.offsets[_SHOULDERS])
    arms = multiply(spine, shaped.rotations[frames][:, _SHOULDERS])
    shoulders = shaped.root[frames, None] + shoulders
    return shoulders, shoulders + rotate(arms, skeleton.offsets[_ELBOWS])
