"""What is upright in a hand stays so, however the trunk bends: a cup is not spilt by who leans or bows.

The arm swings at the shoulder, as one that hangs does; hand and forearm are turned against the world as they were.
"""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import between, conjugate, from_rotation_vector, multiply, rotate, to_rotation_vector

__all__ = ["LEANS", "Upright"]

LEANS = np.radians(5.0)
"""How far it may lean, softly."""

_UPRIGHT = np.cos(np.radians(15.0))  # as the motion begins: what leans farther is not kept upright
_SWINGS = np.radians(80.0)  # that an arm swings at the most
_SPINE = INDEX["spine"]
_UP = np.array([0.0, 0.0, 1.0])


class Upright:
    """One arm, from frame to frame.

    Args:
        task: of who holds something.
        side: the arm.
    """

    def __init__(self, task: HumanTask, side: str) -> None:
        self._skeleton, self._hand, self._arm = task.human, INDEX[f"{side}_hand"], INDEX[f"{side}_upper_arm"]
        thing = task.in_hand(side)
        up = _UP if thing is None else rotate(thing.rotation, _UP)
        self._is_kept = thing is not None and float(up @ _UP) >= _UPRIGHT
        _, turned = forward(task.start.rotations, task.start.root, task.human.offsets)
        self._up = rotate(conjugate(turned[self._hand]), up)  # in the hand's frame

    def swing(self, rotations: Array, root: Array) -> Array:
        """Swing the arm in poses (n, 43, 4), (n, 3), so that what is held is upright; by how much (n,), radians."""
        if not self._is_kept:
            return np.zeros(len(root))
        _, turned = forward(rotations, root, self._skeleton.offsets)
        leans = to_rotation_vector(between(rotate(turned[:, self._hand], self._up), _UP))
        angle = np.linalg.norm(leans, axis=-1)
        swung = np.minimum(angle + LEANS * np.expm1(-angle / LEANS), _SWINGS)
        turn = from_rotation_vector(leans * (swung / np.maximum(angle, 1e-9))[:, None])
        trunk = turned[:, _SPINE]
        against_trunk = multiply(conjugate(trunk), multiply(turn, trunk))
        rotations[:, self._arm] = multiply(against_trunk, rotations[:, self._arm])
        return swung
