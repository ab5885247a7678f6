"""A part comes as far as the hand that holds it brings it, which may be less far than that was to go, or farther, where
a wrist at its limit turns about the part. Then the hand goes on, or less far, until the part is where it is to be.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import replace

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import grips, solve
from ahmss.reaching.performing import Performed
from ahmss.reaching.plan import Plan
from ahmss.skills.part_course import moved
from ahmss.skills.part_ways import Part

__all__ = ["brought_there", "held_ends"]

_THERE = 0.0004  # metres: so near to where it is to be it is there
_MOST = 3  # times that its way is changed
_CLOSED, _OPENED = 0.99, 0.92  # of how far fingers close: so far they have hold of it, and have it no more
_LEAST, _FARTHEST = 0.5, 1.6  # shares of its way that the hand may go


def held_ends(task: HumanTask, part: Part, plan: Plan, made: Performed) -> tuple[Array, Array]:
    """The palms (7,) that hold the part when it sets out and when it is there, as it is shown."""
    closed = moved(task, part, plan.palm)[1]
    held = np.array([np.flatnonzero(closed >= _CLOSED)[0], np.flatnonzero(closed >= _OPENED)[-1]]) - len(closed)
    shown = solve(task.human, made.rotations[held], made.root[held], made.targets[held])
    first, last = grips(task.human, shown, made.root[held])[:, plan.reacher.row]
    return first, last


def brought_there(
    task: HumanTask, part: Part, plan: Plan, perform: Callable[[Part], Generator[Array, None, Performed]]
) -> Generator[Array, None, Performed]:
    """What is performed of a plan so that the part comes where it is to go, as nearly as the arm brings it there.

    perform: makes the frames of a hand that goes as a part says.
    """
    made = yield from perform(part)
    if part.came is None:
        return made
    ends = part.way(np.array([0.0, 1.0]))[0]
    length, goes = float(np.linalg.norm(ends[1] - ends[0])), 1.0
    off = 1.0 - part.came(*held_ends(task, part, plan, made))
    for _ in range(_MOST):
        farther = float(np.clip(goes + off, _LEAST, _FARTHEST))
        if abs(off) * length <= _THERE or farther == goes:
            break
        other = yield from perform(_going(part, farther))
        left = 1.0 - part.came(*held_ends(task, part, plan, other))
        if abs(left) >= abs(off):  # the arm goes no farther
            return (yield from perform(_going(part, goes)))
        made, off, goes = other, left, farther
    return made


def _going(part: Part, share: float) -> Part:
    """The part, if it went that share of its way."""
    return part if share == 1.0 else replace(part, way=lambda shares: part.way(share * shares))
