"""A reach planned: which hand, how its palm is turned at the end, from what posture, and by which way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.steps import Steps
from ahmss.reaching.comfort import across
from ahmss.reaching.duration import reach_time
from ahmss.reaching.goal import Goal, palms_of
from ahmss.reaching.leaning import EASY, Stretch, looking, posture_for, stretch_of
from ahmss.reaching.path import TURNED_LATE, Curve, clear_curves, curves
from ahmss.reaching.prism import Prism, in_the_way, over_hand
from ahmss.reaching.reacher import Reacher, heading_of, seat
from ahmss.reaching.skin import skin_of
from ahmss.reaching.standing import Posture, Standing
from ahmss.reaching.trunk_way import between, drawn_towards
from ahmss.reaching.waist import bent_towards

__all__ = ["HAND_BY", "Found", "Plan", "Reaching"]

_SPINE = INDEX["spine"]
_SAMPLES = 20  # of the trunk along the way
_ENOUGH = 40  # palms by which one sees which arm comes there more easily
_STRAIGHT, _BENT = 0.998, 1.002  # of an arm's length and of what it is bent altogether: no farther, no nearer
_ENDS_SHORT = 0.001  # metres
_STRETCH = 25.0  # what an arm's length beyond what is easy costs
HAND_BY = 0.95
"""The share of the time by which the hand is there where the trunk helps: that begins with it and ends last."""


Found = tuple[Posture, Array, Stretch]
"""A posture to reach from, the palm (7,) at the end, and how the arm then is."""


@dataclass(frozen=True, eq=False)
class Plan:
    """What `Reaching.way` found.

    reacher: the arm. standing: None where the hips stay. start, end: postures (43, 4), (3,), the arm as at the start.
    hands (2, 7): the palms at the start, as they are shown. palm (7,): where the one comes to. curve: its way.
    arm: how it then is. leant: radians that hips or spine turn. near: what is to be kept clear of. others: ways for
    where the arm itself does not keep clear on this one, or would have to flip, the best first. short: metres that the
    hand stops before where it was to come to. towards: the posture that the trunk is drawn towards on its way; None: it
    goes straight.
    """

    reacher: Reacher
    standing: Standing | None
    start: Posture
    end: Posture
    hands: Array
    palm: Array
    curve: Curve
    arm: Stretch
    leant: float
    near: Sequence[Prism]
    others: Sequence[Curve] = ()
    short: float = 0.0
    towards: Posture | None = None

    @property
    def helped(self) -> bool:
        """Whether the trunk moves."""
        return self.leant > np.radians(0.5) or float(np.linalg.norm(self.end.root - self.start.root)) > 0.003

    @property
    def seconds(self) -> float:
        """How long it takes at ease."""
        turn = _angle(self.curve.start, self.curve.end)
        return reach_time(self.curve.length, turn, self.leant)

    def otherwise(self) -> list[Plan]:
        """The same by its other ways."""
        return [replace(self, curve=curve) for curve in self.others]

    def moved(self, by: Array) -> Plan:
        """The same by a way whose middle is elsewhere by (3,), metres."""
        points = self.curve.points + np.array([[0.0], [1.0], [1.0], [0.0]]) * by
        return replace(self, curve=replace(self.curve, points=points))

    def turned_late(self) -> Plan:
        """The same with a hand that turns when it has come off from where it is."""
        curve, *others = (replace(one, turns=TURNED_LATE) for one in (self.curve, *self.others))
        return replace(self, curve=curve, others=others)

    def trunk(self, time: Array) -> Posture:
        """Hips, spine and root at shares of the time (n); the rest as at the start."""
        return between(self.start, self.end, self.towards, minimum_jerk(time))

    def palms(self, time: Array) -> Array:
        """The palm (n, 7) at shares of the time (n)."""
        return self.curve.at(time / HAND_BY if self.helped else time)


class Reaching:
    """A human about to reach, planned in steps, so that who has frames to give can give them in between.

    Args:
        skeleton: the human's measures.
        rotations: (43, 4) the present pose. root: (3,).
        carried: whether hips and legs belong to another motion.
    """

    def __init__(self, skeleton: Skeleton, rotations: Array, root: Array, *, carried: bool = False) -> None:
        self.skeleton = skeleton
        self.start = Posture(rotations, root)
        self.standing = None if carried else Standing.of(skeleton, rotations, root)
        self.heading = heading_of(rotations, root)
        self.base = self.start if self.standing is None else self.standing.base

    def present(self, reacher: Reacher) -> Array:
        """The arm's links (3, 4) now."""
        return reacher.arm.from_pose(self.start.rotations[reacher.links])

    def palms(self, reacher: Reacher, goal: Goal) -> Array:
        """The palms (n, 7) that fulfil a goal."""
        spine = seat(self.skeleton, self.base.rotations, self.base.root)
        return palms_of(goal, reacher, reacher.shoulder(spine))

    def better_side(self, goal: Goal, sides: Sequence[str], prisms: Sequence[Prism] = ()) -> Steps[Reacher]:
        """The arm of several that comes to the goal more easily; the right one, where it makes no difference."""
        costs: list[tuple[float, int]] = []
        arms = [Reacher.of(self.skeleton, side) for side in sides]
        for i, reacher in enumerate(arms if len(arms) > 1 else ()):
            if i:
                yield
            palms, present = self.palms(reacher, goal), self.present(reacher)
            palms = palms[:: 1 + (len(palms) - 1) // _ENOUGH]
            near = in_the_way(prisms, self.base.root, goal.place)
            _, arm = yield from stretch_of(reacher, palms, self.base, present, near)
            beyond = max(arm.stretched - EASY, 0.0)
            shoulder = reacher.shoulder(seat(self.skeleton, self.base.rotations, self.base.root))
            costs.append((arm.cost + _STRETCH * beyond + across(reacher, goal.place, shoulder, self.heading), i))
        return arms[min(costs)[1]] if costs else arms[0]

    def posture(self, reacher: Reacher, goal: Goal, prisms: Sequence[Prism]) -> Steps[Found]:
        """The posture to reach from, the palm (7,) at its end, and how the arm then is."""
        palms, present = self.palms(reacher, goal), self.present(reacher)
        if self.standing is not None:
            posture, best, arm = yield from posture_for(self.standing, reacher, palms, present, prisms)
            return posture, palms[best], arm
        best, _ = yield from stretch_of(reacher, palms, self.base, present, prisms)
        rotations, root = self.base.rotations.copy(), self.base.root
        wrist, _ = reacher.hand(palms[best])
        rotations[_SPINE] = bent_towards(reacher, rotations[0], root, rotations[_SPINE], wrist)
        bent = Posture(rotations, root)
        yield
        best, arm = yield from stretch_of(reacher, palms, bent, present, prisms)
        return bent, palms[best], arm

    def better(self, goal: Goal, sides: Sequence[str], prisms: Sequence[Prism]) -> Steps[tuple[Reacher, Found]]:
        """The arm of several that comes to the goal more easily, or nearer where that one ends short, and how."""
        reacher = yield from self.better_side(goal, sides, prisms)
        yield
        best = reacher, (yield from self.posture(reacher, goal, prisms))
        for side in sides:
            if best[1][2].missing <= _ENDS_SHORT:
                break
            if side == reacher.side:
                continue
            yield
            other = Reacher.of(self.skeleton, side)
            found = yield from self.posture(other, goal, prisms)
            best = min(best, (other, found), key=lambda one: one[1][2].missing)
        return best

    def way(
        self, reacher: Reacher, found: Found, gaze: Array, prisms: Sequence[Prism], looked: float = 0.0
    ) -> Steps[Plan]:
        """The plan for a posture, palm and arm that `posture` found.

        Args:
            reacher: the arm. found: what for. prisms: the things near by.
            gaze: (3,) what is looked at meanwhile. looked: how much of the way to it the gaze has turned before.
        """
        end, wanted, arm = found
        palm = self.in_reach(reacher, end, wanted, gaze)
        hands = self._hands(gaze, looked)
        start = hands[reacher.row]
        leant = max(_angle(self.start.rotations[link], end.rotations[link]) for link in (0, _SPINE))
        family = curves(start, palm, self.heading)
        near = self._near(reacher, prisms, palm)
        plan = Plan(reacher, self.standing, self.start, end, hands, palm, family[0], arm, leant, near)
        if self.standing is not None and plan.helped:
            yield
            around = in_the_way(prisms, self.start.root, self.start.root)
            towards = yield from drawn_towards(self.standing, self.start, end, gaze, around)
            plan = replace(plan, towards=towards)
        trunk = plan.trunk(np.linspace(0.0, 1.0, _SAMPLES))
        seen = looking(self.skeleton, trunk.rotations, trunk.root, gaze)
        seats = seat(self.skeleton, seen, trunk.root)
        yield
        curve, *others = yield from clear_curves(reacher, family, seats, self.present(reacher), near)
        return replace(plan, curve=curve, others=others, short=float(np.linalg.norm(palm[:3] - wanted[:3])))

    def set_out(self, plan: Plan, gaze: Array, looked: float) -> Plan:
        """The plan of a hand that sets out when the gaze (3,) has turned so much of its way, the trunk with it."""
        hands = self._hands(gaze, looked)
        start = hands[plan.reacher.row]
        moved = np.array([[1.0], [1.0], [0.0], [0.0]]) * (start[:3] - plan.curve.points[0])
        curve, *others = (
            replace(curve, points=curve.points + moved, start=start[3:]) for curve in (plan.curve, *plan.others)
        )
        return replace(plan, hands=hands, curve=curve, others=others)

    def _near(self, reacher: Reacher, prisms: Sequence[Prism], palm: Array) -> list[Prism]:
        """What a hand on its way to a palm (7,) is to keep clear of."""
        points, radii = skin_of(reacher, self.start.rotations, self.start.root)
        near = in_the_way(prisms, self.start.root, palm[:3])
        over = (over_hand(prism, self.start.root, points, radii) for prism in near)
        return [prism for prism in over if prism is not None]

    def _hands(self, gaze: Array, looked: float) -> Array:
        """The palms (2, 7) as they are shown before anything moves but the gaze."""
        begun = looking(self.skeleton, self.start.rotations, self.start.root, gaze, looked)
        return grips(self.skeleton, begun, self.start.root)

    def in_reach(self, reacher: Reacher, end: Posture, palms: Array, gaze: Array) -> Array:
        """Palms (..., 7), or as near to them as the arm comes without being stretched out or bent altogether."""
        seen = looking(self.skeleton, end.rotations, end.root, gaze)
        off = reacher.hand(palms)[0] - reacher.shoulder(seat(self.skeleton, seen, end.root))
        distance = np.linalg.norm(off, axis=-1, keepdims=True)
        kept = np.clip(distance, _BENT * reacher.shortest, _STRAIGHT * reacher.length)
        places = palms[..., :3] + (kept - distance) / np.maximum(distance, 1e-9) * off
        return np.concatenate([places, palms[..., 3:]], axis=-1)


def _angle(a: Array, b: Array) -> float:
    """Radians between two rotations (4,)."""
    return float(np.linalg.norm(to_rotation_vector(multiply(conjugate(a), b))))
