"""The head of who has something at it, a telephone's handset say: it does not turn into that; the eyes go there alone.

What the shipped algorithms share, and an author may use.
"""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, rotate
from ahmss.skills.company import eye_of
from ahmss.skills.own_head import at_own_head

__all__ = ["SteadyHead"]

_NEAR = 0.3  # metres from the eyes to a palm, beyond which nothing in it is at the head
_AWAY = 3.0  # metres to what is looked at
_FREE = np.radians(35.0)  # that it turns to the free side: from there on hair would be in it
_SHARE = 0.9  # of an angle that the head makes, the rest is the eyes'
_FACES = np.array([0.0, 0.0, -1.0])  # in the head: where it looks


class SteadyHead:
    """A gaze that goes along with the head to the free side, some way, and to that of the hand no farther than ahead.

    Nor than it looks as this begins.

    Args:
        task: who. side: of the hand that has something at the head.
    """

    def __init__(self, task: HumanTask, side: str) -> None:
        self._task, self._sign = task, 1.0 if side == "left" else -1.0
        yaw, self._pitch = self._looks(task.start.rotations)
        self._most = max(self._sign * yaw, 0.0)

    @classmethod
    def of(cls, task: HumanTask, side: str) -> SteadyHead | None:
        """The one of a hand that has the task's object at the head; None where it has not."""
        palm, thing = task.start.grip(side), task.object
        if thing is None or float(np.linalg.norm(palm.place - eye_of(task))) > _NEAR:
            return None
        held = Transform.of(palm.row()).inverse().then(thing.frame)
        return cls(task, side) if at_own_head(task, side, held) else None

    def target(self) -> Array:
        """The gaze's target (8) in the next frame."""
        present, eye = self._task.present, eye_of(self._task)
        now, _ = self._looks(present.rotations)
        yaw = self._sign * float(np.clip(self._sign * now, -_FREE, self._most)) / _SHARE
        pitch = self._pitch / _SHARE
        ahead = np.array([np.sin(pitch), np.cos(pitch) * np.sin(yaw), -np.cos(pitch) * np.cos(yaw)])
        return np.array([*(eye + _AWAY * rotate(present.rotations[0], ahead)), 0.0, 0.0, 0.0, 0.0, 1.0])

    def _looks(self, rotations: Array) -> tuple[float, float]:
        """How far to the left of the hips' front, and how far up from it, a head (43, 4) looks, radians."""
        _, turned = forward(rotations, np.zeros(3), self._task.human.offsets)
        up, left, back = rotate(conjugate(turned[0]), rotate(turned[INDEX["head"]], _FACES))
        return float(np.arctan2(left, -back)), float(np.arcsin(np.clip(up, -1.0, 1.0)))
