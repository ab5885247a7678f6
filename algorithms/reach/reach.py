"""Reaching: a palm travels to a site of the object or to a place (Ichiguchi 2000, 5.3.3; numbers in the docs).

The eyes and the head go first. The hand goes by a minimum-jerk path around what is in the way, its orientation set
before its place; the trunk helps where the arm alone is too short. The plan is made in the first frames, a part in
each, while only the gaze moves. Who is carried reaches for the place in the world, from wherever the body then is.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import HumanTask, run
from ahmss.algorithm.reaching import Looking, goal_of, prisms_of, refuse_far, sides_of
from ahmss.body.array import Array
from ahmss.body.links import fingers
from ahmss.motion.fingers import opened
from ahmss.reaching.performing import perform
from ahmss.reaching.plan import Reaching


def reach(task: HumanTask) -> Iterator[Array]:
    """Frames (n, 260): a few in which the head turns while the way is planned, then all others."""
    goal = goal_of(task)
    gaze = Looking(task, goal.place)
    reaching = Reaching(task.human, task.start.rotations, task.start.root, carried=task.carried)
    prisms = prisms_of(task)
    yield gaze.alone()
    reacher = reaching.better_side(goal, sides_of(task), prisms)
    yield gaze.alone()
    found = None
    for found in reaching.postures(reacher, goal, prisms):
        yield gaze.alone()
    assert found is not None
    refuse_far(task, reacher.side, found[2])
    plan = reaching.way(reacher, found, goal.place, prisms)
    length = task.length or round(plan.seconds * task.rate)
    first = gaze.frames
    time = np.arange(1, length - first + 1) / (length - first)
    shape = (list(fingers(reacher.side)), opened(reacher.side)) if task.parameter("open", True) else None
    made = perform(plan, time, goal.place, gaze.turned(np.arange(first + 1, length + 1)), shape)
    yield task.block(made.rotations, made.root, made.importance, made.targets)


if __name__ == "__main__":
    run(reach)
