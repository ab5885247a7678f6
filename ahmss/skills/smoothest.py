"""Of several ways to bring a hand to something that on which it touches nothing and the arm does not leap."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import replace

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.errors import AlgorithmError
from ahmss.reaching.goal import Goal
from ahmss.reaching.performing import Performed
from ahmss.reaching.plan import Plan, Reaching
from ahmss.reaching.prism import Prism
from ahmss.skills.out_of_reach import EXACT, refuse_short
from ahmss.skills.planning import planned
from ahmss.skills.reaching import Looking

__all__ = ["smoothest"]

_TRIES = 4  # of palms, where the elbow would leap on the way or something is touched
_LEAP = np.radians(9.0)  # that an arm's link turns in a frame
_OTHERWISE = np.radians(25.0)  # that palms differ by, which come by another way


def smoothest(
    task: HumanTask, reaching: Reaching, goal: Goal, gaze: Looking, prisms: Sequence[Prism], off: Array,
    perform: Callable[[Plan], Generator[Array, None, Performed]],
    touches: Callable[[Plan, Performed], float] | None = None, lacks: Callable[[Plan], float] | None = None,
) -> Generator[Array, None, tuple[Plan, Performed]]:  # fmt: skip
    """The plan of a reach that touches nothing and whose arm does not leap on the way, and what is performed of it.

    Where all do so, that which touches least, and of those that touch nothing the smoothest. A plan of an arm that is
    too short is not performed: nothing would come of it.

    Args:
        task, reaching, goal, gaze, prisms, off: as of `planned`. perform: makes a plan's frames.
        touches: metres by which those come too near to what they should not touch; 0: they keep clear.
        lacks: metres by which a plan's arm is too short for what it is to do; left out: as the plan says.

    Raises:
        AlgorithmError: it is out of reach with all palms that are tried; says by how much with the nearest.
    """
    best: tuple[float, float, Plan, Performed] | None = None
    nearest: tuple[float, Plan] | None = None
    made, left = None, goal
    for tried in range(_TRIES):
        try:
            plan = yield from planned(task, reaching, left, gaze, prisms, off)
        except AlgorithmError:
            if best is None and nearest is None:
                raise
            break  # what is left is out of reach
        short = plan.short if lacks is None else lacks(plan)
        nearest = (short, plan) if nearest is None or short < nearest[0] else nearest
        if short <= EXACT:
            made = yield from perform(plan)
            leap = _leap(task, plan, made)
            touch = touches(plan, made) if touches is not None else 0.0
            if best is None or (touch, leap) < best[:2]:
                best = touch, leap, plan, made
            if leap < _LEAP and touch <= 0.0:
                break
        other = _otherwise(left, plan, other_hand=tried % 2 == 1)
        if other is None:
            break
        left = other
    if best is None:
        assert nearest is not None
        refuse_short(task, nearest[1], nearest[0])
    assert best is not None
    _, _, plan, first = best
    if first is not made and first.looked < 1.0:  # the eyes have gone on since it was made
        first = yield from perform(plan)
    return plan, first


def _leap(task: HumanTask, plan: Plan, made: Performed) -> float:
    """Radians that a link of the arm turns in a frame, at the most."""
    links = plan.reacher.links
    arm = np.concatenate([task.start.rotations[None, links], made.rotations[:, links]])
    cos = np.abs((arm[1:] * arm[:-1]).sum(axis=-1))
    return float(2.0 * np.arccos(np.clip(cos, 0.0, 1.0)).max(initial=0.0))


def _otherwise(goal: Goal, plan: Plan, *, other_hand: bool) -> Goal | None:
    """The goal without the palms that are turned about as a plan's is, or that hand; None where nothing is left."""
    palms = dict(goal.palms)
    own = palms.pop(plan.reacher.side)
    turned = 2.0 * np.arccos(np.clip(np.abs(own[:, 3:] @ plan.palm[3:]), 0.0, 1.0))
    if (turned > _OTHERWISE).any() and not (other_hand and palms):
        palms[plan.reacher.side] = own[turned > _OTHERWISE]
    return replace(goal, palms=palms) if palms else None
