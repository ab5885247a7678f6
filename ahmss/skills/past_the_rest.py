"""A hand on its way to a part of a thing goes round the rest of it: over a tap's spout, not through it, to its lever.

Nor does it go through the part.

What is in the way of a reach leaves out the thing that is sought, which fingers come close to; so what of it stays
while its part is moved is looked at here, by its own shape.
"""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.links import fingers
from ahmss.body.quaternion import slerp
from ahmss.grasping.field import Field
from ahmss.grasping.hand import Hand
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.steps import Steps
from ahmss.reaching.arm_on_way import Sought
from ahmss.reaching.performing import SHAPED_BY
from ahmss.reaching.plan import Plan
from ahmss.reaching.reacher import SIDES
from ahmss.skills.in_part import InPart
from ahmss.skills.part_ways import Part

__all__ = ["Rest"]

_TIME = np.linspace(0.05, 1.0, 32)  # shares of a way at which it is looked at
_EVERY = 2  # frames of what is made
_AIR = 0.004  # metres that a planned hand keeps, as an arm is not always where it is planned to be
_SOME = 0.001  # metres that count as none
# Metres by which the middle of a way goes elsewhere, higher and farther before the part, the least first.
_HIGHER, _FARTHER = (0.0, 0.06, 0.12, 0.18), (0.0, 0.08)


class Rest:
    """What of a task's object stays while its part is moved, as far as it is known and a hand comes near it."""

    def __init__(self, task: HumanTask, part: InPart) -> None:
        self._task, self._field, self._part = task, _field_of(task), part

    def round(self, plan: Plan, part: Part, wide: Array) -> Steps[Plan]:
        """The plan of a hand that opens to (14, 4) on the way, by the first way round the rest.

        part: to which it comes.
        """
        best: tuple[float, Plan] = (np.inf, plan)
        for farther in _FARTHER:
            for higher in _HIGHER:
                way = plan.moved(np.array([0.0, 0.0, higher]) + farther * part.off) if higher or farther else plan
                deep = self._planned(way, part, wide)
                if deep < best[0] - _SOME:
                    best = deep, way
                if deep < -_AIR:
                    return way
                yield
        return best[1]

    def _planned(self, plan: Plan, part: Part, wide: Array) -> float:
        """Metres by which the hand is in the rest on a plan's way at the most, as far as that can be helped."""
        links = list(fingers(plan.reacher.side))
        shapes = slerp(plan.start.rotations[links], wide, minimum_jerk(_TIME / SHAPED_BY)[:, None])
        side, palms, shapes = plan.reacher.side, plan.palms(_TIME)[:-1], shapes[:-1]
        return max(self._depth(side, palms, shapes), self._part.at_rest(side, part, palms, shapes))

    def on_way(self, side: str, part: Part) -> Sought:
        """How deep that hand is in the rest or in the part, as an arm brings it there."""

        def deep(rotations: Array, root: Array) -> float:
            seen = rotations[::_EVERY]
            palms = grips(self._task.human, seen, root[::_EVERY])[:, SIDES.index(side)]
            shapes = seen[:, list(fingers(side))]
            return max(self._depth(side, palms, shapes), self._part.at_rest(side, part, palms, shapes)) - _SOME

        return deep

    def depth(self, side: str, rotations: Array, root: Array) -> float:
        """Metres by which a hand is in the rest, at the most, in frames (n, 43, 4), (n, 3); 0 where in none."""
        if self._field is None:
            return 0.0
        seen, at = rotations[::_EVERY], root[::_EVERY]
        palms = grips(self._task.human, seen, at)[:, SIDES.index(side)]
        return max(self._depth(side, palms, seen[:, list(fingers(side))]) - _SOME, 0.0)

    def _depth(self, side: str, palms: Array, shapes: Array) -> float:
        """The same for palms (n, 7) in the world and fingers (n, 14, 4); negative outside."""
        if self._field is None:
            return -np.inf
        assert self._task.object is not None
        hand = Hand.of(self._task.human, side)
        seen = self._task.object.frame.inverse().then(Transform.of(palms)).row()
        return max(hand.depth(self._field, seen, shapes), float(hand.palm_depth(self._field, seen).max()))


def _field_of(task: HumanTask) -> Field | None:
    """The distances from the rest around the action's site; None where there is none."""
    thing = task.object
    if thing is None or thing.shape is None or task.site is None or thing.shape.rest is None:
        return None
    try:
        return thing.shape.rest.field(thing.frame.inverse().then(task.site).place)
    except ValueError:
        return None
