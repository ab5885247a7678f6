"""Arms kept out of things as a motion is known: the one that goes along as the trunk bends, or one that is raised.

What the shipped algorithms share, and an author may use.
"""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.motion.steps import Steps
from ahmss.reaching.other_arm import out_of_things
from ahmss.reaching.reacher import SIDES, Reacher
from ahmss.reaching.standing import Posture
from ahmss.skills.reaching import prisms_of

__all__ = ["arm_kept_out", "free_arm_kept_out"]

_CARES = 1.0  # its importance where it is moved: as that of the arm that acts
_ROTATIONS, _IMPORTANCE = slice(4, 176), slice(176, 219)  # of a row


def free_arm_kept_out(task: HumanTask, side: str, rows: Array) -> Steps[Array]:
    """POSE rows (n, 260) of a motion of one side's hand, the other arm, if it is free, moved out of things."""
    other = SIDES[1 - SIDES.index(side)]
    return rows if other in task.busy else (yield from arm_kept_out(task, other, rows))


def arm_kept_out(task: HumanTask, side: str, rows: Array) -> Steps[Array]:
    """POSE rows (n, 260) of who stands, an arm moved out of things; as they are where one is carried."""
    if task.carried:
        return rows
    reacher, start = Reacher.of(task.human, side), Posture(task.start.rotations, task.start.root)
    poses = Posture(rows[:, _ROTATIONS].reshape(-1, 43, 4), rows[:, 1:4])
    made = yield from out_of_things(reacher, prisms_of(task), start, poses)
    if np.array_equal(made, poses.rotations[:, reacher.links]):
        return rows
    out = rows.copy()
    out[:, _ROTATIONS].reshape(-1, 43, 4)[:, reacher.links] = made
    out[:, _IMPORTANCE][:, reacher.links] = np.maximum(out[:, _IMPORTANCE][:, reacher.links], _CARES)
    return out
