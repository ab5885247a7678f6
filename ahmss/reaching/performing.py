"""A planned reach as frames: the trunk along its way, the arm solved for all frames at once, so that it never flips."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.body.arm_path import follow
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE, LEFT_FOOT, RIGHT_FOOT
from ahmss.body.links import INDEX
from ahmss.body.quaternion import slerp
from ahmss.motion.easing import minimum_jerk
from ahmss.reaching.leaning import looking
from ahmss.reaching.plan import Plan
from ahmss.reaching.reacher import seat

__all__ = ["SHAPED_BY", "Fingers", "Performed", "perform"]

_LEGS = [
    *range(INDEX["right_upper_leg"], INDEX["right_foot"] + 1),
    *range(INDEX["left_upper_leg"], INDEX["left_foot"] + 1),
]


SHAPED_BY = 0.8
"""The share of the time by which the fingers have their shape."""

Fingers = tuple[list[int], Array]
"""Links of fingers and the rotations (n, 4) that they come to."""

_NO_FINGERS: Fingers = ([], np.zeros((0, 4)))


@dataclass(frozen=True, eq=False)
class Performed:
    """n frames.

    rotations (n, 43, 4): head and spine as before the gaze turns them, the arm as it fits after it. root (n, 3).
    importance (n, 44). targets (n, 5, 8): the hand all the way, planted feet, the gaze. jumps: whether the arm flipped.
    """

    rotations: Array
    root: Array
    importance: Array
    targets: Array
    jumps: bool


def perform(plan: Plan, time: Array, gaze: Array, looked: Array, fingers: Fingers = _NO_FINGERS) -> Performed:
    """The frames of a plan at shares of its time (n).

    Args:
        plan: the reach.
        time: rising, the first later than 0.
        gaze: (3,) what is looked at. looked: (n,) how much of the way to it the gaze has turned.
        fingers: links and the rotations (m, 4) that they have at the end.
    """
    reacher, skeleton = plan.reacher, plan.reacher.skeleton
    trunk, n = plan.trunk(time), len(time)
    palms = plan.palms(time)
    rotations = trunk.rotations
    if plan.standing is not None and plan.helped:
        rotations = plan.standing.on_feet(rotations, trunk.root)
    seen = looking(skeleton, rotations, trunk.root, gaze, looked)
    wrist = reacher.wrist(palms, seat(skeleton, seen, trunk.root))
    present = reacher.arm.from_pose(plan.start.rotations[reacher.links])
    way = follow(reacher.arm, wrist, present)
    rotations[:, reacher.links] = reacher.arm.into_pose(way.links)
    targets = np.zeros((n, 5, 8))
    targets[:, reacher.row, :7], targets[:, reacher.row, 7] = palms, 1.0
    targets[:, GAZE, :3], targets[:, GAZE, 7] = gaze, looked
    if plan.standing is not None:
        targets[:, RIGHT_FOOT : LEFT_FOOT + 1, :7] = plan.standing.feet
        targets[:, RIGHT_FOOT : LEFT_FOOT + 1, 7] = 1.0
    importance = np.zeros(44)
    importance[reacher.links] = 1.0
    importance[INDEX["head"]] = 0.05
    links, shape = fingers
    rotations[:, links] = slerp(plan.start.rotations[links], shape, minimum_jerk(time / SHAPED_BY)[:, None])
    importance[links] = 1.0
    if plan.helped:
        importance[INDEX["spine"]] = 1.0
        if plan.standing is not None:
            importance[[0, 43, *_LEGS]] = 1.0
    return Performed(rotations, trunk.root, np.repeat(importance[None], n, axis=0), targets, bool(way.jumps.any()))
