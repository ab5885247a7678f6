"""Where a hand is brought that is to pinch a thing, or to go around a bar: before a grip which its arm can then close.

Pads press from two sides, so the thumb may be on either of them and the hand may come from many directions about the
line between them; fingers go through a loop from one side of it. Which of these is comfortable depends on the arm:
those that hold are sought, the easiest first.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import msgspec
import numpy as np

from ahmss.algorithm.messages import PoseRecord
from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import solve
from ahmss.body.links import fingers
from ahmss.body.quaternion import rotate
from ahmss.errors import AlgorithmError
from ahmss.grasping.field import Field, Solid
from ahmss.grasping.hand import Hand
from ahmss.grasping.holding import Cost, Holding, opener
from ahmss.grasping.power import is_thick, power
from ahmss.grasping.precision import PARTS, TILTED, TILTS, Way, pinch, ways_to
from ahmss.motion.steps import Steps
from ahmss.reaching.comfort import around_axis
from ahmss.reaching.goal import Goal
from ahmss.reaching.plan import Plan
from ahmss.reaching.reacher import Reacher
from ahmss.skills.crowded import crowded
from ahmss.skills.grasping import ArmCost, closing_into, field_at

__all__ = ["Before", "goal_before", "grips_before", "refused"]

_BACK = np.array([0.05, 0.07, 0.09])  # metres by which the palm stays behind where it holds
_CLEAR = 0.01  # metres that the open hand keeps there
_ENOUGH, _TRIED = 2, 6  # grips of each hand that are found, and ways that are tried for them
_CANNOT = 100.0  # what it costs that the arm can't


@dataclass(frozen=True, eq=False)
class Before:
    """A palm (7,) in the world before a grip of one hand, with the fingers (14, 4) open around what it takes."""

    side: str
    palm: Array
    fingers: Array
    holding: Holding

    def turned_from(self, palm: Array) -> float:
        """Radians between its palm and one (7,)."""
        return float(2.0 * np.arccos(min(1.0, abs(float(self.palm[3:] @ palm[3:])))))


def grips_before(task: HumanTask, sides: Sequence[str]) -> Steps[list[Before]]:
    """The places before grips that hold, by hands of either side, those first that an arm takes most easily.

    None where the site has a power grip about what is thick: there the palm stops before the wall.

    Raises:
        AlgorithmError: nothing of the thing is at its site, or what is about it leaves no room for a pinch.
    """
    thing = task.object
    assert thing is not None
    assert task.site is not None
    site = thing.frame.inverse().then(task.site)
    field = crowded(task, field_at(task, site.place), site.place)
    pinched = thing.sites[task.message.site].grip == "precision"
    if not pinched and is_thick(field, site.row()):
        return []
    found: list[tuple[float, Before]] = []
    for side in sides:
        yield
        hand, cost = Hand.of(task.human, side), ArmCost(task, side).cost
        some = yield from _pinches(hand, field, site, cost) if pinched else _bars(task, hand, field, cost)
        for total, holding, inward in some:
            opened = opener(hand, holding) if holding.wide is None else holding.wide
            palms = np.concatenate(
                [holding.palm[:3] - _BACK[:, None] * inward, np.tile(holding.palm[3:], (len(_BACK), 1))], axis=1
            )
            clear = np.flatnonzero(
                (_depth(hand, field.alone, palms, opened) < -_CLEAR) & (_depth(hand, field, palms, opened) < 0.0)
            )
            if len(clear):
                there = thing.frame.then(Transform.of(palms[clear[0]])).row()
                found.append((total, Before(side, there, opened, holding)))
    if pinched and not found and field.alone is not field:
        raise AlgorithmError(
            f"thumb and fingers can't close on {thing.name} there: what it stands on or beside is in the way; put it "
            "where its edge is free, or stand elsewhere"
        )
    return [one for _, one in sorted(found, key=lambda one: one[0])]


def _depth(hand: Hand, solid: Solid, palms: Array, opened: Array) -> Array:
    """Metres (n) by which skin of a hand with fingers (14, 4) is in a solid at palms (n, 7), negative outside."""
    skin = np.array([hand.depth(solid, palm[None], opened[None]) for palm in palms])
    return np.maximum(skin, hand.palm_depth(solid, palms))


def refused(task: HumanTask, before: Before, plan: Plan) -> Steps[AlgorithmError | None]:
    """Why the hand that has come there as planned can't close into the grip; None where it can."""
    targets, rotations = np.zeros((5, 8)), plan.end.rotations.copy()
    targets[plan.reacher.row, :7], targets[plan.reacher.row, 7] = plan.palm, 1.0
    rotations[list(fingers(before.side))] = before.fingers
    pose = PoseRecord.of(solve(task.human, rotations, plan.end.root, targets), plan.end.root)
    there = HumanTask(msgspec.structs.replace(task.message, pose=pose, frames=0))
    try:
        yield from closing_into(there, before.side, before.holding, np.inf)
    except AlgorithmError as error:
        return error
    return None


_Grip = tuple[float, Holding, Array]  # what it costs, the grip, and the direction (3,) in which the hand comes to it


def _pinches(hand: Hand, field: Field, site: Transform, cost: Cost) -> Steps[list[_Grip]]:
    """Grips between thumb and fingers at a site."""
    ways: list[Way] = []
    for tilts in np.split(TILTS, PARTS):
        ways += ways_to(hand, field, site.row(), tilts)
        yield
    if not ways:
        return []
    palms, inward = np.array([way.palm for way in ways]), np.array([way.inward for way in ways])
    back = np.concatenate([palms[:, :3] - _BACK[0] * inward, palms[:, 3:]], axis=1)
    (held, can), (before, comes) = cost(palms), cost(back)
    total = held + before + TILTED * np.abs([way.tilt for way in ways]) + np.where(can & comes, 0.0, _CANNOT)
    found: list[_Grip] = []
    for i in np.argsort(total, kind="stable")[:_TRIED]:
        yield
        holding = yield from pinch(hand, field, ways[i])
        if holding is not None and holding.holds:
            found.append((float(total[i]), holding, inward[i]))
        if len(found) == _ENOUGH:
            break
    return found


def _bars(task: HumanTask, hand: Hand, field: Field, cost: Cost) -> Steps[list[_Grip]]:
    """The grip around the bar at the action's site."""
    assert task.object is not None
    assert task.site is not None
    reacher, to_object = Reacher.of(task.human, hand.side), task.object.frame.inverse()
    turned = around_axis(task.site.row(), reacher.sign)
    palms = to_object.then(Transform(np.tile(task.site.place, (len(turned), 1)), turned)).row()
    easiest = palms[int(cost(palms)[0].argmin())]
    yield
    holding = yield from power(hand, field, easiest, to_object.then(task.site).row(), cost)
    if holding is None or not holding.holds:
        return []
    return [(float(cost(holding.palm[None])[0][0]), holding, rotate(holding.palm[3:], np.array([1.0, 0.0, 0.0])))]


def goal_before(goal: Goal, some: Sequence[Before]) -> Goal:
    """The goal with the palms of those places."""
    palms: dict[str, list[Array]] = {}
    for one in some:
        palms.setdefault(one.side, []).append(one.palm)
    made: Mapping[str, Array] = {side: np.array(own) for side, own in palms.items()}
    return replace(goal, palms=made)
