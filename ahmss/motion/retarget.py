"""A motion given to a human of other lengths: feet on the ground, hands where they were relative to the body.

Rotations are kept; what must meet something is then solved for. Hips and feet keep their way, in leg lengths, so that
strides fit the legs. Hands keep their place as seen from the shoulder, in arm lengths, except across the body, where
what lies between the shoulders is measured by their width: hands that met in the middle still do. Within 2 cm of that
the elbows keep their bend.
"""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.inverse import solve
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, PARENTS
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.alignment import TRACKED, BodyMotion
from ahmss.motion.refining import standing

__all__ = ["arm_length", "hand_places", "leg_length", "own_arm_length", "own_leg_length", "retarget"]

_UP = np.array([0.0, 0.0, 1.0])
_SLACK = 0.015  # metres that a hand may be off for its elbow's sake
_OFF = 0.032  # metres that a hand may be nearer or farther in all; half of it is for its elbow's sake
_BEYOND = 0.016  # metres that a hand may be beyond reach; the arm then only points at it
_MOST_SHIFT, _STEPS = 0.03, 60  # metres by which shoulders may be shifted for that
_SOFT = 0.03  # metres over which the scale across the body changes at the shoulder
_FEET = [INDEX["right_foot"], INDEX["left_foot"]]
_HANDS = [INDEX["right_hand"], INDEX["left_hand"]]
_LEGS = [INDEX["right_upper_leg"], INDEX["left_upper_leg"]]
_SHOULDERS = [INDEX["right_upper_arm"], INDEX["left_upper_arm"]]
_SPINE, _HEAD = INDEX["spine"], INDEX["head"]


def retarget(body: BodyMotion, skeleton: Skeleton) -> tuple[Array, Array]:
    """The motion on another human.

    Args:
        body: the motion with its performer's lengths.
        skeleton: the human's measures.

    Returns:
        rotations (F, 43, 4), parent <- child, fingers relaxed, and root (F, 3), metres, the floor at z = 0, beginning
        over the origin with heading 0.
    """
    rotations = _joint_rotations(body, skeleton)
    root, ankles = _hips_and_ankles(body, skeleton)
    targets = np.zeros((body.frames, 5, 8))
    targets[:, 2:4, :3], targets[:, 2:4, 3:7], targets[:, 2:4, 7] = ankles, body.rotations[:, _FEET], 1.0
    wrists = hand_places(body, skeleton, rotations, root)
    grips = body.rotations[:, _HANDS]
    targets[:, :2, :3] = wrists + rotate(grips, skeleton.grips[:, :3])
    targets[:, :2, 3:7], targets[:, :2, 7] = multiply(grips, skeleton.grips[:, 3:]), 1.0
    rotations = solve(skeleton, rotations, root, targets)
    return _begun_here(rotations, root)


def _joint_rotations(body: BodyMotion, skeleton: Skeleton) -> Array:
    """Rotations (F, 43, 4), parent <- child, of the body's own, the fingers relaxed."""
    rotations = np.tile(skeleton.relaxed()[0], (body.frames, 1, 1))
    rotations[:, 0] = body.rotations[:, 0]
    for link in range(1, len(TRACKED)):
        rotations[:, link] = multiply(conjugate(body.rotations[:, PARENTS[link]]), body.rotations[:, link])
    return rotations


def _hips_and_ankles(body: BodyMotion, skeleton: Skeleton) -> tuple[Array, Array]:
    """The hips' way (F, 3) and the ankles' (F, 2, 3) in the human's leg lengths, standing feet on the floor."""
    scale = own_leg_length(skeleton) / leg_length(body)
    ankle = -float(skeleton.soles[:, 2].min())
    floor = np.array([0.0, 0.0, standing_height(body)])
    root = scale * (body.places[:, 0] - floor) + ankle * _UP
    # From hip joint to ankle, so that a straight leg is straight on a pelvis of another width too.
    joints = root[:, None] + rotate(body.rotations[:, None, 0], skeleton.offsets[_LEGS])
    return root, joints + scale * (body.places[:, _FEET] - body.places[:, _LEGS])


def leg_length(body: BodyMotion) -> float:
    """Thigh and shank together, metres."""
    return _chain_length(body, "upper_leg", "lower_leg", "foot")


def arm_length(body: BodyMotion) -> float:
    """From shoulder to wrist along the bones, metres."""
    return _chain_length(body, "upper_arm", "lower_arm", "hand")


def own_leg_length(skeleton: Skeleton) -> float:
    """A human's thigh and shank together, metres."""
    return _own_length(skeleton, "right_lower_leg", "right_foot")


def own_arm_length(skeleton: Skeleton) -> float:
    """A human's length from shoulder to wrist along the bones, metres."""
    return _own_length(skeleton, "right_lower_arm", "right_hand")


def _own_length(skeleton: Skeleton, *links: str) -> float:
    return float(np.linalg.norm(skeleton.offsets[[INDEX[link] for link in links]], axis=-1).sum())


def _chain_length(body: BodyMotion, *links: str) -> float:
    sides = [body.places[:, [INDEX[f"{side}_{link}"] for link in links]] for side in ("right", "left")]
    return float(np.mean([np.median(np.linalg.norm(np.diff(side, axis=1), axis=-1).sum(axis=1)) for side in sides]))


def standing_height(body: BodyMotion) -> float:
    """How high the ankles are when the feet stand flat, metres."""
    heights, flat = body.places[:, _FEET, 2], standing(body)
    return float(np.percentile(heights[flat] if flat.any() else heights, 20.0))


def hand_places(body: BodyMotion, skeleton: Skeleton, rotations: Array, root: Array) -> Array:
    """Where the wrists (F, 2, 3) belong on this human, world, metres.

    The performer's shoulder is one place on the trunk: what the collarbone does is the arm's here.
    """
    trunk = conjugate(body.rotations[:, None, _SPINE])
    neck = body.places[:, None, _HEAD]
    hands = rotate(trunk, body.places[:, _HANDS] - neck)
    reach = arm_length(body)
    scale = own_arm_length(skeleton) / reach
    shoulders = _pivots(hands, rotate(trunk, body.places[:, _SHOULDERS] - neck), reach, _OFF / scale)
    hands = hands - shoulders
    half, own_half = float(np.ptp(shoulders[:, 1])) / 2.0, float(np.ptp(skeleton.offsets[_SHOULDERS, 1])) / 2.0
    outward = np.array([-1.0, 1.0])
    placed = scale * hands
    placed[..., 1] = outward * _across(outward * hands[..., 1], own_half / half, scale)
    places, world = forward(rotations, root, skeleton.offsets)
    placed = _with_elbows_kept(placed, np.linalg.norm(places[:, _HANDS] - places[:, _SHOULDERS], axis=-1))
    return places[:, _SHOULDERS] + rotate(world[:, None, _SPINE], placed)


def _with_elbows_kept(placed: Array, given: Array) -> Array:
    """Places of hands (F, 2, 3) from the shoulder, nearer or farther by up to `_SLACK`, so that elbows bend as before.

    Where the performer's shoulder moved on the trunk, the elbow makes up for it, by much when it is nearly straight.
    `given` (F, 2) is how far away the hand is with the performer's own elbow, metres.
    """
    far = np.linalg.norm(placed, axis=-1)
    kept = far + _SLACK * np.tanh((given - far) / _SLACK)
    return placed * (kept / np.maximum(far, 1e-9))[..., None]


def _pivots(hands: Array, shoulders: Array, reach: float, off: float) -> Array:
    """Where on the trunk the shoulders (2, 3) are taken to be: in the middle of their places, as a rule.

    Where a hand would then in some frame, such as before the first step, be much nearer or farther than it was from
    the shoulder that moved, or beyond reach, the place is shifted, by no more than that takes.

    Args:
        hands: (F, 2, 3) from the neck, in the trunk's axes, metres.
        shoulders: (F, 2, 3) likewise.
        reach: how far an arm reaches, metres.
        off: by how much hands may be nearer or farther than they were, metres.
    """
    given, usual = np.linalg.norm(hands - shoulders, axis=-1), np.median(shoulders, axis=0)
    pivots, least, most = usual.copy(), given - off, np.minimum(given + off, reach + _BEYOND)
    for side in range(2):
        for _ in range(_STEPS):
            ways = hands[:, side] - pivots[side]
            far = np.linalg.norm(ways, axis=-1)
            beyond = np.maximum(far - most[:, side], 0.0) + np.minimum(far - least[:, side], 0.0)
            worst = int(np.abs(beyond).argmax())
            if beyond[worst] == 0.0 or np.linalg.norm(pivots[side] - usual[side]) > _MOST_SHIFT:
                break
            pivots[side] += 0.5 * beyond[worst] * ways[worst] / far[worst]
    return pivots


def _across(out: Array, inner: float, outer: float) -> Array:
    """Distances out from the shoulder, scaled by one number towards the middle and another away from it, smoothly."""
    bend = 0.5 * (out + np.sqrt(out * out + _SOFT * _SOFT) - _SOFT)
    return inner * out + (outer - inner) * bend


def _begun_here(rotations: Array, root: Array) -> tuple[Array, Array]:
    """The motion turned and moved on the floor so that it begins over the origin with heading 0."""
    ahead = rotate(rotations[0, 0], np.array([0.0, 0.0, -1.0]))
    turn = from_axis_angle(_UP, -np.arctan2(ahead[1], ahead[0]))
    turned = rotations.copy()
    turned[:, 0] = multiply(turn, rotations[:, 0])
    return turned, rotate(turn, root - root[0] * (1.0, 1.0, 0.0))
