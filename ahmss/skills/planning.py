"""A reach planned while the eyes turn to what is reached for; or refused, with the step that helps."""

from __future__ import annotations

from collections.abc import Generator, Sequence

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.reaching.goal import Goal
from ahmss.reaching.plan import Plan, Reaching
from ahmss.reaching.prism import Prism
from ahmss.skills.out_of_reach import MOST_MISSING, refuse_far
from ahmss.skills.reaching import Looking, sides_of
from ahmss.skills.sitting import stands
from ahmss.skills.step_nearer import step_nearer

__all__ = ["planned"]


def planned(
    task: HumanTask,
    reaching: Reaching,
    goal: Goal,
    gaze: Looking,
    prisms: Sequence[Prism],
    off: Array | None = None,
    sides: Sequence[str] = (),
    most: float = MOST_MISSING,
) -> Generator[Array, None, Plan]:
    """The plan of a reach, made a part in each of a few frames (1, 260) in which only the gaze moves.

    How short it stops is not told: that does `tell_missed`, of the plan that is carried out in the end.

    Args:
        task: whose. reaching: who. goal: where. gaze: on its way there.
        prisms: what may be in the way.
        off: (3,) metres by which the hand is first brought elsewhere, on its way to the goal.
        sides: the hands that may be used; left out: all that `sides_of` has.
        most: metres that the arm may be too short for it.

    Raises:
        AlgorithmError: it is out of reach; says by how much, and what to do.
    """
    yield gaze.alone()
    sides = [side for side in sides or sides_of(task) if not goal.palms or side in goal.palms]
    reacher, (posture, palm, arm) = yield from gaze.during(reaching.better(goal, sides, prisms))
    if arm.missing > most:
        helps = ""
        if task.goal_place is not None and stands(task):
            helps = yield from gaze.during(step_nearer(task, goal, sides, prisms))
        refuse_far(task, reacher.side, arm, most, helps)
    if off is not None:
        palm = np.concatenate([palm[:3] + off, palm[3:]])
    yield from gaze.if_there_is_time()
    looked = float(gaze.turned(np.array([gaze.frames + 1]))[0])
    plan = yield from gaze.during(reaching.way(reacher, (posture, palm, arm), goal.place, prisms, looked))
    yield from gaze.if_there_is_time()
    return plan
