"""What a hand has done as rows, and the way back that it then goes: the one that it came, which is clear of things."""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import LEFT_HAND, RIGHT_HAND
from ahmss.body.quaternion import IDENTITY, conjugate, multiply, slerp
from ahmss.motion.easing import minimum_jerk
from ahmss.reaching.performing import Performed

__all__ = ["gone_back", "rows_made"]

_GOES_OVER = 30  # frames in which the elbow comes back to where it was at the part
_HANDS = slice(RIGHT_HAND, LEFT_HAND + 1)


def rows_made(task: HumanTask, made: Performed) -> Array:
    """The frames (n, 260) of what was performed."""
    return task.block(made.rotations, made.root, made.importance, made.targets)


def gone_back(task: HumanTask, made: Performed, length: int, arm: slice) -> Array:
    """Frames (n, 260) in which all goes back the way that it came in the first so many, which is clear of things.

    Elbow and palm may have come to another place meanwhile, as a wrist at its limit does: the arm goes over from there.
    """
    rotations, targets = made.rotations[:length][::-1].copy(), made.targets[:length][::-1].copy()
    share = minimum_jerk(np.arange(1, length + 1) / _GOES_OVER)[:, None]
    rotations[:, arm] = slerp(
        np.broadcast_to(made.rotations[-1, arm], rotations[:, arm].shape), rotations[:, arm], share
    )
    for was, gone in zip(made.targets[-1, _HANDS], targets[:, _HANDS].swapaxes(0, 1), strict=True):
        if was[7] > 0.0 and gone[0, 7] > 0.0:
            gone[:, :3] += (1.0 - share) * (was[:3] - gone[0, :3])
            off = multiply(was[3:7], conjugate(gone[0, 3:7]))
            gone[:, 3:7] = multiply(slerp(np.tile(off, (length, 1)), IDENTITY, share[:, 0]), gone[:, 3:7])
    return task.block(rotations, made.root[:length][::-1], made.importance[:length][::-1], targets)
