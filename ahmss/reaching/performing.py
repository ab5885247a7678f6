"""A planned reach as frames: the trunk along its way, the arm solved for all frames at once.

Where the arm on the plan's way touches things, turns a joint too fast or would have to jump, it is tried on the plan's
other ways too, and the best of them is taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.ndimage import gaussian_filter1d

from ahmss.body.arm import hand_angles, with_hand
from ahmss.body.arm_path import Way, follow
from ahmss.body.arm_yielding import yielding
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE, LEFT_FOOT, RIGHT_FOOT, grips
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, slerp, to_rotation_vector
from ahmss.motion.easing import minimum_jerk
from ahmss.reaching.leaning import looking
from ahmss.reaching.other_arm import other_arm
from ahmss.reaching.plan import HAND_BY, Plan
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.reacher import SIDES, Reacher, seat
from ahmss.reaching.skin import skin_of
from ahmss.reaching.standing import Posture
from ahmss.reaching.steps import Steps
from ahmss.reaching.twist import handed_back, untwisted

__all__ = ["AIMED", "FASTEST", "SHAPED_BY", "Fingers", "Performed", "perform"]

_LEGS = [
    *range(INDEX["right_upper_leg"], INDEX["right_foot"] + 1),
    *range(INDEX["left_upper_leg"], INDEX["left_foot"] + 1),
]


_TRUNK = [INDEX["hips"], INDEX["spine"], INDEX["head"]]

SHAPED_BY = 0.8
"""The share of the time by which the fingers have their shape."""

Fingers = tuple[list[int], Array]
"""Links of fingers and the rotations (n, 4) that they come to."""

FASTEST = np.radians(6.0)
"""What a joint turns in a frame at the most, where that can be helped."""

AIMED = 0.88 * FASTEST
"""What is aimed at for that: what is shown goes on from how the body moves, and catches up."""

_DEEP, _FAST, _BEYOND = 0.01, np.radians(3.0), np.radians(5.0)  # metres in things, radians too fast and beyond limits
_JUMPS = 10.0  # which are as bad as these
_SWING = np.radians(4.5)  # of an elbow whose joints give way, in a frame at the most
_SLOWER = np.radians([4.5, 3.0])  # the same, where its joints turn too fast else
_SOFTLY = 10  # frames
_DETOUR = 3.0  # as a metre of way
_RAISES, _HIGHER = 2, 0.07  # times, metres
_AIR = 0.002  # metres between the skin and things on the way
_NEARLY, _FULLY = 0.94, 0.985  # of the arm's length, on the way: from where on it is spared, and what it never is
_ENDS = 0.15  # of the time, at either end, in which it may be stretched as it is there
_SOFT, _RAMP = 3.0, 8  # frames: over which a hand that meets a limit is slowed down, and at either end not
_GOES_ON = 0.4  # of the time, in which a hand parts from a trunk that turns after the gaze
_UNTURNED = np.array([1.0, 0.0, 0.0, 0.0])
_OTHER = 0.3  # the other arm's importance
_NOTHING_THEN: Array = np.zeros((0, 7))
_NO_FINGERS: Fingers = ([], np.zeros((0, 4)))


@dataclass(frozen=True, eq=False)
class Performed:
    """n frames.

    rotations (n, 43, 4): head and spine as before the gaze turns them, the arm as it fits after it. root (n, 3).
    importance (n, 44). targets (n, 5, 8): the hand all the way, planted feet, the gaze. jumps: whether the arm flipped.
    fastest: radians that a joint of trunk, head or arm turns from one frame to the next at the most, on the way: what
    follows has its own pace. flaw: how bad the
    arm is on its way, in things, too fast or beyond its limits; 0: it is fine. plan: with the way that was taken, and
    no others.
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
    plan: Plan, time: Array, gaze: Array, looked: Array, fingers: Fingers = _NO_FINGERS, then: Array | None = None
) -> Steps[Performed]:
    """The frames of a plan at shares of its time (n).

    Args:
        plan: the reach.
        time: rising, the first later than 0.
        gaze: (3,) what is looked at. looked: (n,) how much of the way to it the gaze has turned.
        fingers: links and the rotations (m, 4) that they have at the end.
        then: palms (m, 7) of frames that follow, the trunk as it then is; `looked` is of these too.
    """
    then = _NOTHING_THEN if then is None else then
    body = _carried(plan, np.concatenate([time, np.ones(len(then))]), gaze, looked, fingers)
    yield
    best = yield from _solved(plan, body, then)
    ways, raises = plan.otherwise(), _RAISES
    while best.flaw > 0.0 and (ways or raises):
        yield
        way = ways.pop(0) if ways else None
        arm = yield from _solved(way or best.plan.raised(_HIGHER), body, then)
        before, best = best, min(best, arm, key=lambda one: one.strain + _DETOUR * one.plan.curve.length)
        if way is None:  # higher, for as long as that helps
            raises = 0 if best is before else raises - 1
    yield
    other = (yield from _other_arm(plan, body)) if plan.helped else None
    return _performed(best, body, other, gaze, looked, fingers[0], len(time))


@dataclass(frozen=True, eq=False)
class _Body:
    """F frames of a body but for the arm that reaches.

    time (F,). trunk: hips, spine, legs and root as before the gaze turns anything, the fingers as they go. seen
    (F, 43, 4): as it is shown. spine: its place (F, 3) and rotation (F, 4). hands (2, F, 7): where the palms would be
    if nothing moved but the gaze.
    """

    time: Array
    trunk: Posture
    seen: Array
    spine: tuple[Array, Array]
    hands: Array

    def begun(self, plan: Plan, row: int, palms: Array) -> Array:
        """Palms (F, 7) of a hand that, at first, goes on with a trunk which still turns after the gaze."""
        start, still = plan.hands[row], self.hands[row]
        left = 1.0 - minimum_jerk(self.time / _GOES_ON)
        turn = slerp(_UNTURNED, multiply(still[:, 3:], conjugate(start[3:])), left)
        place = palms[:, :3] + left[:, None] * (still[:, :3] - start[:3])
        return np.concatenate([place, multiply(turn, palms[:, 3:])], axis=-1)


@dataclass(frozen=True, eq=False)
class _Arm:
    """The plan that it follows, its links (F, 3, 4), the palms (F, 7) that it has, and the rest as of `Performed`.

    fastest is of all frames, paced of those on the way.
    """

    plan: Plan
    links: Array
    palms: Array
    jumps: bool
    fastest: float
    paced: float
    beyond: float
    deep: float = 0.0

    @property
    def flaw(self) -> float:
        """How bad it is, 0: it is fine."""
        return self._worse_than(FASTEST)

    @property
    def strain(self) -> float:
        """The same by what is aimed at: of two ways one takes that which has less."""
        return self._worse_than(AIMED)

    def _worse_than(self, fastest: float) -> float:
        too_fast = max(self.fastest - fastest, 0.0)
        return max(self.deep, 0.0) / _DEEP + too_fast / _FAST + self.beyond / _BEYOND + _JUMPS * self.jumps


def _carried(plan: Plan, time: Array, gaze: Array, looked: Array, fingers: Fingers) -> _Body:
    trunk, skeleton = plan.trunk(time), plan.reacher.skeleton
    rotations = trunk.rotations
    if plan.standing is not None and plan.helped:
        rotations = plan.standing.on_feet(rotations, trunk.root)
    links, shape = fingers
    rotations[:, links] = slerp(plan.start.rotations[links], shape, minimum_jerk(time / SHAPED_BY)[:, None])
    seen = looking(skeleton, rotations, trunk.root, gaze, looked)
    start, n = plan.start, len(time)
    root = np.repeat(start.root[None], n, axis=0)
    still = looking(skeleton, np.repeat(start.rotations[None], n, axis=0), root, gaze, looked)
    hands = np.moveaxis(grips(skeleton, still, root), 1, 0)
    return _Body(time, Posture(rotations, trunk.root), seen, seat(skeleton, seen, trunk.root), hands)


def _asked(plan: Plan, body: _Body, then: Array) -> Array:
    """The palms (F, 7) along the plan's way, and then those (m, 7) that follow."""
    palms = np.concatenate([plan.palms(body.time[: len(body.time) - len(then)]), then])
    palms = body.begun(plan, plan.reacher.row, palms)
    return _within_reach(plan.reacher, palms, body.spine, body.time)


def _solved(plan: Plan, body: _Body, then: Array) -> Steps[_Arm]:
    """The arm on a plan's way, and then after palms (m, 7) that follow."""
    n = len(body.time) - len(then)
    arm = yield from _reached(plan, body, _asked(plan, body, then), n)
    near = [prism for prism in plan.near if not prism.sought]
    if not near:
        return arm
    yield
    return replace(arm, deep=_touch(plan.reacher, near, body, arm, n))


def _reached(plan: Plan, body: _Body, palms: Array, n: int) -> Steps[_Arm]:
    """The arm after palms (F, 7), of which the first n are on the way."""
    reacher = plan.reacher
    present, _ = untwisted(reacher.arm.from_pose(plan.start.rotations[reacher.links]))
    wrist = reacher.wrist(palms, body.spine)
    way = follow(reacher.arm, wrist, present, softly=_SOFTLY)
    if way.jumps.any():
        yield
        way = yielding(reacher.arm, wrist, present, _SWING, _SOFTLY)
    made = _along(plan, body, palms, way, n)
    for step in _SLOWER:
        if made.fastest <= AIMED:
            break
        yield
        way = follow(reacher.arm, wrist, present, step, _SOFTLY)
        if way.jumps.any():
            yield
            way = yielding(reacher.arm, wrist, present, step, _SOFTLY)
        made = min(made, _along(plan, body, palms, way, n), key=lambda one: one.strain)
    return made


def _along(plan: Plan, body: _Body, palms: Array, way: Way, n: int) -> _Arm:
    """The arm that goes such a way after palms (F, 7), as it is shown."""
    reacher = plan.reacher
    begun = reacher.arm.from_pose(plan.start.rotations[reacher.links])
    links, own = _slowed(way, n)
    if own.any():  # on the way a hand is turned as its joints allow, not as the shortest turn would have it
        palms = np.where(own[:, None], reacher.palm(links, body.spine), palms)
    links = handed_back(links, untwisted(begun)[1])
    moved = np.concatenate([begun[None], links])
    fastest, paced = _fastest(moved), _fastest(moved[: n + 1])
    beyond = float(way.beyond[len(links) // 4 :].max())  # not where an arm begins beyond its limits
    return _Arm(plan, reacher.arm.into_pose(links), palms, bool(way.jumps.any()), fastest, paced, beyond)


def _other_arm(plan: Plan, body: _Body) -> Steps[Array]:
    """The other arm's rows (F, 3, 4): its hand stays where it was beside the hips, upright if it was, as they move."""
    reacher = Reacher.of(plan.reacher.skeleton, SIDES[1 - plan.reacher.row])
    hips = np.repeat(plan.hands[reacher.row][None], len(body.time), axis=0)
    hips[:, :3] += body.trunk.root - plan.start.root
    return other_arm(reacher, plan.start.rotations[reacher.links], body.begun(plan, reacher.row, hips), body.spine)


def _performed(
    arm: _Arm, body: _Body, other: Array | None, gaze: Array, looked: Array, fingers: list[int], way: int
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
    fastest = max(arm.paced, _fastest(body.seen[:way, _TRUNK]))
    return Performed(rotations, root, importance, targets, arm.jumps, fastest, arm.flaw, replace(plan, others=()))


def _fastest(rotations: Array) -> float:
    """Radians that any joint (F, n, 4) turns from one frame to the next at the most."""
    steps = multiply(conjugate(rotations[:-1]), rotations[1:])
    return float(np.linalg.norm(to_rotation_vector(steps), axis=-1).max(initial=0.0))


def _slowed(way: Way, n: int) -> tuple[Array, Any]:
    """The arm's links (F, 3, 4), a hand that meets a limit in the first n frames slowed down before, and where the hand
    is not turned as asked (F,).
    """
    own: Any = way.turned > 0.0
    if not own[:n].any():
        return way.links, own
    angles = hand_angles(way.links)
    frames = np.arange(len(angles))
    share = np.clip(np.minimum(frames, n - 1 - frames) / _RAMP, 0.0, 1.0)[:, None]
    smooth = gaussian_filter1d(angles, _SOFT, axis=0, mode="nearest")
    return with_hand(way.links, angles + share * (smooth - angles)), own | (share[:, 0] > 0.0)


def _within_reach(reacher: Reacher, palms: Array, spine: tuple[Array, Array], time: Array) -> Array:
    """Palms (n, 7) that wait, on the way, for a trunk which is not there yet: an arm stretched out is stiff."""
    shoulder = reacher.shoulder(spine)
    off = reacher.hand(palms)[0] - shoulder
    distance = np.linalg.norm(off, axis=-1)
    stretched, span = distance / reacher.length, _FULLY - _NEARLY
    kept = _NEARLY + span * (1.0 - np.exp(-np.maximum(stretched - _NEARLY, 0.0) / span))
    back = np.maximum(stretched - kept, 0.0) * np.where(stretched > _NEARLY, 1.0, 0.0)
    # An elbow bends by the root of what is drawn in: squared, it begins as softly.
    on_the_way = minimum_jerk(time / _ENDS) ** 2 * minimum_jerk((HAND_BY - time) / _ENDS)
    out = palms.copy()
    out[:, :3] -= (back * on_the_way * reacher.length / np.maximum(distance, 1e-9))[:, None] * off
    return out


def _touch(reacher: Reacher, prisms: Sequence[Prism], body: _Body, arm: _Arm, n: int) -> float:
    """How deep, metres, the skin of forearm, hand and fingers is in things in the first n frames; below 0 in none.

    Towards either end it may be as near as it is there.
    """
    seen = body.seen[:n].copy()
    seen[:, reacher.links] = arm.links[:n]
    points, radii = skin_of(reacher, seen, body.trunk.root[:n])
    gap = clearance(prisms, points, _AIR + float(radii.max())) - radii
    time = np.arange(1, n + 1) / n
    first, last = np.minimum(gap[0], _AIR), np.minimum(gap[-1], _AIR)
    leaving = np.where(first < 0.0, 0.4, 0.2)  # what begins in a thing has to come out of it first
    least = np.where(time[:, None] < leaving, first, np.where(time[:, None] > 0.75, last, _AIR))
    return float((least - gap).max())
