"""A planned reach as frames: the trunk along its way (`bearing`), the arm solved for all frames at once (`arm_on_way`).

Where the arm on the plan's way touches things, turns a joint too fast or would have to jump, it is tried on other ways
too, first on ones farther from its own shoulder where it comes near that, and the best of them is taken.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ahmss.body.array import Array
from ahmss.body.inverse import GAZE, LEFT_FOOT, RIGHT_FOOT
from ahmss.body.links import INDEX
from ahmss.motion.steps import Steps
from ahmss.reaching.arm_on_way import ArmOnWay, Sought, farther, fastest_of, solved, swung_clear
from ahmss.reaching.bearing import SHAPED_BY, Bearing, Fingers, bearing_of
from ahmss.reaching.other_arm import other_arm, out_of_things
from ahmss.reaching.plan import Plan
from ahmss.reaching.reacher import SIDES, Reacher
from ahmss.reaching.standing import Posture

__all__ = ["SHAPED_BY", "Fingers", "Performed", "perform"]

_LEGS = [
    *range(INDEX["right_upper_leg"], INDEX["right_foot"] + 1),
    *range(INDEX["left_upper_leg"], INDEX["left_foot"] + 1),
]
_TRUNK = [INDEX["hips"], INDEX["spine"], INDEX["head"]]
_DETOUR = 3.0  # as a metre of way
_RAISES, _HIGHER = 2, np.array([0.0, 0.0, 0.07])  # times, metres
_SLIGHT = 0.005  # of flaw, for which no other way is tried: 0.05 mm in things, a hundredth of a degree
_OTHER = 0.3  # the other arm's importance
_NOTHING_THEN: Array = np.zeros((0, 7))
_NO_FINGERS: Fingers = ([], np.zeros((0, 4)))


@dataclass(frozen=True, eq=False)
class Performed:
    """n frames.

    rotations (n, 43, 4): head and spine as before the gaze turns them, the arm as it fits after it. root (n, 3).
    importance (n, 44). targets (n, 5, 8): the hand all the way, planted feet, the gaze. jumps: whether the arm flipped.
    fastest: radians that a joint of trunk, head or arm turns from one frame to the next at the most, on the way: what
    follows has its own pace. flaw: how bad the arm is on its way, in things, too fast or beyond its limits; 0: it is
    fine. plan: with the way that was taken, and no others.
    """

    rotations: Array
    root: Array
    importance: Array
    targets: Array
    jumps: bool
    fastest: float
    flaw: float
    plan: Plan

    @property
    def looked(self) -> float:
        """How much of its way the gaze has turned in the first frame."""
        return float(self.targets[0, GAZE, 7])


def perform(
    plan: Plan, time: Array, gaze: Array, looked: Array, fingers: Fingers = _NO_FINGERS, then: Array | None = None,
    sought: Sought | None = None,
) -> Steps[Performed]:  # fmt: skip
    """The frames of a plan at shares of its time (n).

    Args:
        plan: the reach.
        time: rising, the first later than 0.
        gaze: (3,) what is looked at. looked: (n,) how much of the way to it the gaze has turned.
        fingers: links and the rotations (m, 4) that they have at the end.
        then: palms (m, 7) of frames that follow, the trunk as it then is; `looked` is of these too.
        sought: tells how deep the hand is in what it comes to on the way; left out: nobody asks.
    """
    then = _NOTHING_THEN if then is None else then
    body = bearing_of(plan, np.concatenate([time, np.ones(len(then))]), gaze, looked, fingers)
    yield
    first = yield from solved(plan, body, then, sought)
    best = yield from swung_clear(first, body, then, sought)
    ways, raises = [*farther(plan, body), *plan.otherwise()], _RAISES
    while best.flaw > _SLIGHT and (ways or raises):
        yield
        way = ways.pop(0) if ways else None
        arm = yield from solved(way or best.plan.moved(_HIGHER), body, then, sought)
        before, best = best, min(best, arm, key=lambda one: one.strain + _DETOUR * one.plan.curve.length)
        if way is None:  # higher, for as long as that helps
            raises = 0 if best is before else raises - 1
    if best.plan is not first.plan:
        best = yield from swung_clear(best, body, then, sought)
    yield
    other = (yield from _other_arm(plan, body)) if plan.helped else None
    return _performed(best, body, other, gaze, looked, fingers[0], len(time))


def _other_arm(plan: Plan, body: Bearing) -> Steps[Array]:
    """The other arm's rows (F, 3, 4): its hand stays where it was beside the hips, upright if it was, as they move,
    but for things that it is over there, a table's top, say.
    """
    reacher = Reacher.of(plan.reacher.skeleton, SIDES[1 - plan.reacher.row])
    hips = np.repeat(plan.hands[reacher.row][None], len(body.time), axis=0)
    hips[:, :3] += body.trunk.root - plan.start.root
    begun = body.begun(plan, reacher.row, hips)
    rows = yield from other_arm(reacher, plan.start.rotations[reacher.links], begun, body.spine)
    if not plan.near:
        return rows
    yield
    rotations = body.seen.copy()
    rotations[:, reacher.links] = rows
    return (yield from out_of_things(reacher, plan.near, plan.start, Posture(rotations, body.trunk.root)))


def _performed(
    arm: ArmOnWay, body: Bearing, other: Array | None, gaze: Array, looked: Array, fingers: list[int], way: int
) -> Performed:
    plan, reacher, n = arm.plan, arm.plan.reacher, len(body.time)
    rotations, root = body.trunk.rotations, body.trunk.root
    rotations[:, reacher.links] = arm.links
    if other is not None:
        rotations[:, reacher.other] = other
    targets = np.zeros((n, 5, 8))
    targets[:, reacher.row, :7], targets[:, reacher.row, 7] = arm.palms, 1.0
    targets[:, GAZE, :3], targets[:, GAZE, 7] = gaze, looked
    if plan.standing is not None:
        targets[:, RIGHT_FOOT : LEFT_FOOT + 1, :7] = plan.standing.feet
        targets[:, RIGHT_FOOT : LEFT_FOOT + 1, 7] = 1.0
    importance = np.zeros(44)
    importance[reacher.links] = 1.0
    importance[INDEX["head"]] = 0.05
    importance[fingers] = 1.0
    if plan.helped:
        importance[INDEX["spine"]] = 1.0
        importance[reacher.other] = _OTHER
        if plan.standing is not None:
            importance[[0, 43, *_LEGS]] = 1.0
    importance = np.repeat(importance[None], n, axis=0)
    fastest = max(arm.paced, fastest_of(body.seen[:way, _TRUNK]))
    return Performed(rotations, root, importance, targets, arm.jumps, fastest, arm.flaw, replace(plan, others=()))
