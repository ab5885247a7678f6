"""Where a hand is brought that is to pinch a thing: before a grip which its arm can then close, the fingers around.

Pads press from two sides, so the thumb may be on either of them and the hand may come from many directions about the
line between them. Which of these is comfortable depends on the arm: those that hold are sought, the easiest first.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ahmss.algorithm.grasping import ArmCost, field_at
from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.grasping.hand import Hand
from ahmss.grasping.holding import opener
from ahmss.grasping.precision import TILTED, pinch, ways_to
from ahmss.reaching.goal import Goal
from ahmss.reaching.steps import Steps

__all__ = ["Before", "goal_before", "is_pinched", "pinches"]

_BACK = (0.05, 0.07, 0.09)  # metres by which the palm stays behind where it holds
_CLEAR = 0.01  # metres that the open hand keeps there
_ENOUGH, _TRIED = 2, 6  # grips of each hand that are found, and ways that are tried for them
_CANNOT = 100.0  # what it costs that the arm can't


@dataclass(frozen=True, eq=False)
class Before:
    """A palm (7,) in the world before a grip of one hand, with the fingers (14, 4) open around what it takes."""

    side: str
    palm: Array
    fingers: Array

    def turned_from(self, palm: Array) -> float:
        """Radians between its palm and one (7,)."""
        return float(2.0 * np.arccos(min(1.0, abs(float(self.palm[3:] @ palm[3:])))))


def is_pinched(task: HumanTask) -> bool:
    """Whether what is reached for is a site that thumb and fingers close on, of a thing whose shape is known."""
    thing = task.object
    if thing is None or thing.shape is None or task.site is None or task.goal_place is not None:
        return False
    said = task.goal_rotation is not None or task.parameter("turn", "site") == "free"
    return not said and thing.sites[task.message.site].grip == "precision"


def pinches(task: HumanTask, sides: Sequence[str]) -> Steps[list[Before]]:
    """The places before grips that hold, by hands of either side, those first that an arm takes most easily.

    Raises:
        AlgorithmError: nothing of the thing is at its site.
    """
    thing = task.object
    assert thing is not None
    assert task.site is not None
    site = thing.frame.inverse().then(task.site)
    field = field_at(task, site.place)
    found: list[tuple[float, Before]] = []
    for side in sides:
        yield
        hand = Hand.of(task.human, side)
        ways = ways_to(hand, field, site.row())
        if not ways:
            continue
        yield
        cost = ArmCost(task, side).cost
        palms = np.array([way.palm for way in ways])
        back = palms.copy()
        back[:, :3] -= _BACK[0] * np.array([way.inward for way in ways])
        (held, can), (before, comes) = cost(palms), cost(back)
        tilt = np.abs([way.tilt for way in ways])
        total = held + before + TILTED * tilt + np.where(can & comes, 0.0, _CANNOT)
        count = 0
        for i in np.argsort(total, kind="stable")[:_TRIED]:
            yield
            holding = pinch(hand, field, ways[i])
            if holding is None or not holding.holds:
                continue
            fingers = opener(hand, holding) if holding.wide is None else holding.wide
            for off in _BACK:
                palm = np.concatenate([holding.palm[:3] - off * ways[i].inward, holding.palm[3:]])
                gap = -max(hand.depth(field, palm[None], fingers[None]), float(hand.palm_depth(field, palm[None])[0]))
                if gap > _CLEAR:
                    there = thing.frame.then(Transform.of(palm)).row()
                    found.append((float(total[i]), Before(side, there, fingers)))
                    count += 1
                    break
            if count == _ENOUGH:
                break
    return [one for _, one in sorted(found, key=lambda one: one[0])]


def goal_before(goal: Goal, some: Sequence[Before]) -> Goal:
    """The goal with the palms of those places."""
    palms: dict[str, list[Array]] = {}
    for one in some:
        palms.setdefault(one.side, []).append(one.palm)
    made: Mapping[str, Array] = {side: np.array(own) for side, own in palms.items()}
    return replace(goal, palms=made)
