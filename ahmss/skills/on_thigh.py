"""Where a free hand is at rest: it hangs from who stands, and lies on the thigh of who sits."""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import solve
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import from_axis_angle, from_matrix, multiply
from ahmss.body.skeleton import Skeleton
from ahmss.reaching.reacher import SIDES
from ahmss.skills.sitting import heading_of, seat_of

__all__ = ["at_rest", "on_thigh"]

_ALONG, _OVER, _INWARD = 0.62, 0.062, np.radians(12.0)  # of the thigh; metres at 1.76 m; of a resting hand
_UP = np.array([0.0, 0.0, 1.0])


def on_thigh(skeleton: Skeleton, places: Array, side: str, heading: float) -> Transform:
    """The palm (n) that lies on a thigh, the fingers ahead and a little inward.

    Args:
        places: (n, 43, 3) of the links of who sits, world. heading: radians, which way a sitter looks.
    """
    upper, lower = places[..., INDEX[f"{side}_upper_leg"], :], places[..., INDEX[f"{side}_lower_leg"], :]
    place = upper + _ALONG * (lower - upper) + _OVER / 1.76 * skeleton.stature * _UP
    sign = 1.0 if side == "right" else -1.0
    flat = np.array([[0.0, -sign, 0.0], [0.0, 0.0, sign], [-1.0, 0.0, 0.0]])  # columns: out of the palm, y, the thumb
    return Transform(place, multiply(from_axis_angle(_UP, heading + sign * _INWARD), from_matrix(flat)))


def at_rest(task: HumanTask, rotations: Array, root: Array, side: str) -> Array:
    """A pose (43, 4), (3,) whose arm and hand of one side are at rest."""
    rotations, hand = rotations.copy(), list(fingers(side))
    arm = [*range(INDEX[f"{side}_upper_arm"], INDEX[f"{side}_hand"] + 1), *hand]
    rotations[arm] = task.human.relaxed()[0][arm]
    if seat_of(task) is None:
        return rotations
    places, _ = forward(rotations, root, task.human.offsets)
    targets = np.zeros((5, 8))
    targets[SIDES.index(side), :7] = on_thigh(task.human, places, side, heading_of(rotations)).row()
    targets[SIDES.index(side), 7] = 1.0
    return solve(task.human, rotations, root, targets)
