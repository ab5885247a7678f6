"""The step that brings a place into reach, as one types it: found by trying how the arm would come there from it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.motion.steps import Steps
from ahmss.reaching.goal import Goal
from ahmss.reaching.prism import Prism
from ahmss.skills.out_of_reach import walk_to
from ahmss.skills.stands import stance_at, stands_at

__all__ = ["step_nearer"]

_TRIED, _APART = 8, 0.2  # stands that are tried, metres between them
_WELL = 0.005  # metres: who comes there does not stand just as was thought


def step_nearer(task: HumanTask, goal: Goal, sides: Sequence[str], prisms: Sequence[Prism]) -> Steps[str]:
    """What to do for a hand of several to come to a goal, in any direction from here: a walk, where one helps."""
    tried: list[Array] = []
    for _, stand in stands_at(task, goal.place):
        assert stand.facing is not None
        if len(tried) == _TRIED:
            break
        if any(float(np.linalg.norm(stand.place - other)) < _APART for other in tried):
            continue
        tried.append(stand.place)
        _, (_, _, arm) = yield from stance_at(task, stand).better(goal, sides, prisms)
        if arm.missing < _WELL:
            return f"{walk_to(task, stand.place, stand.facing)} first"
        yield
    return "no step from here brings one nearer; say another place"
