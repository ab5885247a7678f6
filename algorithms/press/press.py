"""Pressing a button: the extended index finger comes along the -x of the site, pushes by the travel, and draws back.

The reach is that of `reach`, to a place a little before the face. A button with a travel takes 150 to 300 ms to press.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import HumanTask, run
from ahmss.algorithm.reaching import Looking, performed, planned, prisms_of, sides_of
from ahmss.body.array import Array
from ahmss.body.links import fingers
from ahmss.body.quaternion import rotate
from ahmss.errors import AlgorithmError
from ahmss.motion.easing import minimum_jerk
from ahmss.reaching.goal import Goal
from ahmss.reaching.plan import Reaching
from ahmss.reaching.pointing import palms_pointing, pointing

TRAVEL = 0.004  # metres, where neither parameter nor property says
BEFORE, BACK = 0.035, 0.06  # metres before the face at which the finger is set, and to which it is drawn back
OVER = 0.0005  # metres beyond the travel, so that it is pushed all the way
COMES, PUSHES, STAYS, LEAVES = 0.16, 0.12, 0.07, 0.3  # seconds


def press(task: HumanTask) -> Iterator[Array]:
    """Frames (n, 260): the hand comes, presses, and is drawn back."""
    if task.site is None or task.object is None:
        raise AlgorithmError("press needs a site: the button's face, its x out of it")
    if task.carried:
        raise AlgorithmError("a button is pressed standing; walk there first, then press it")
    out = rotate(task.site.rotation, np.array([1.0, 0.0, 0.0]))
    palms = {side: palms_pointing(task.human, side, task.site.place, -out) for side in sides_of(task)}
    gaze = Looking(task, task.site.place)
    reaching = Reaching(task.human, task.start.rotations, task.start.root)
    plan = yield from planned(task, reaching, Goal(task.site.place, palms=palms), gaze, prisms_of(task), BEFORE * out)
    pushed = _pushed(task, plan.palm, out)
    if task.length:
        pushed = pushed[np.linspace(0, len(pushed) - 1, min(len(pushed), task.length // 2)).round().astype(int)]
    shape = list(fingers(plan.reacher.side)), pointing(plan.reacher.side)
    made = yield from performed(task, reaching, plan, gaze, shape, pushed)
    yield task.block(made.rotations, made.root, made.importance, made.targets)


def _pushed(task: HumanTask, palm: Array, out: Array) -> Array:
    """Palms (n, 7) from before the face into it, by the travel, and back again."""
    assert task.object is not None
    travel = task.parameter("travel", 0.0) or float(task.object.properties.get("travel", TRAVEL))
    way = [(0.0, COMES), (BEFORE, COMES), (BEFORE + travel + OVER, PUSHES), (BEFORE + travel + OVER, STAYS)]
    way.append((BEFORE - BACK, LEAVES))
    depth: list[Array] = []
    for (before, _), (after, seconds) in itertools.pairwise(way):
        time = np.arange(1, round(seconds * task.rate) + 1) / round(seconds * task.rate)
        depth.append(before + minimum_jerk(time) * (after - before))
    palms = np.repeat(palm[None], sum(map(len, depth)), axis=0)
    palms[:, :3] -= np.concatenate(depth)[:, None] * out
    return palms


if __name__ == "__main__":
    run(press)
