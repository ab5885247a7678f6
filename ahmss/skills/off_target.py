"""How far a hand is off what it is to touch: as its arm really brings it there, not as that was planned."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import grips, solve
from ahmss.reaching.performing import Performed
from ahmss.reaching.plan import Plan
from ahmss.reaching.reacher import seat

__all__ = ["off_target", "too_short"]


def off_target(
    task: HumanTask, plan: Plan, made: Performed, palms: Array, at: NDArray[np.bool_], place: Array
) -> float:
    """Metres by which what of a hand touches is off where it is to be, at the most, and the plan stops short of it.

    Args:
        plan, made: of the hand, and what is performed of it. palms: (n, 7) that it is to have in the last frames.
        at: (n,) in which of them it touches. place: (3,) in the world, of what touches when the palm is the plan's.
    """
    frames = np.flatnonzero(at) - len(palms)
    shown = solve(task.human, made.rotations[frames], made.root[frames], made.targets[frames])
    got = Transform.of(grips(task.human, shown, made.root[frames])[:, plan.reacher.row])
    touches = Transform.of(plan.palm).inverse().apply(place)
    off = got.apply(touches) - Transform.of(palms[frames]).apply(touches)
    return plan.short + float(np.linalg.norm(off, axis=-1).max(initial=0.0))


def too_short(task: HumanTask, plan: Plan, made: Performed, palms: Array, at: NDArray[np.bool_]) -> float:
    """Metres by which the arm is too short for its palm, however it turns that; at the least what the plan says.

    Args:
        plan, made, palms, at: as of `off_target`.
    """
    frames, reacher = np.flatnonzero(at) - len(palms), plan.reacher
    shoulder = reacher.shoulder(seat(task.human, made.rotations[frames], made.root[frames]))
    far = np.linalg.norm(reacher.hand(palms[frames])[0] - shoulder, axis=-1)
    return max(plan.short, plan.short + float(far.max(initial=0.0)) - reacher.length)
