"""The arm of a hand that closes on a thing while another motion carries the body on: its elbow stays out of things.

The palm is where it is in the world, and the shoulder goes on over it: left to itself the elbow would hang down from
there, into what the thing stands on. So the arm is solved anew from frame to frame, as on the way there.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from ahmss.algorithm.messages import POSE, size
from ahmss.algorithm.pose import HumanPose
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply
from ahmss.errors import AlgorithmError
from ahmss.reaching.reacher import SIDES, Reacher, seat
from ahmss.reaching.tracking import Tracking
from ahmss.skills.giving_way import Things

__all__ = ["closing_carried"]

_ARM = 20.0  # its importance: of an arm that is high up even a little of a walk's, which hangs, is much
_MISSED, _TURNED = 0.008, np.radians(8.0)  # metres, and how far turned, that a palm may be from where it holds
_ROTATIONS, _IMPORTANCE, _TARGETS = slice(4, 176), slice(176, 220), slice(220, 260)  # of a row


def closing_carried(task: HumanTask, side: str, blocks: Iterable[Array | HumanPose]) -> Iterator[Array | HumanPose]:
    """Poses, of blocks (n, 260), of a hand that closes, one by one, the arm in each as the body then is carried.

    Raises:
        AlgorithmError: the body was carried past what the hand was to hold.
    """
    arm = _Arm(task, side)
    links, row = Reacher.of(task.human, side).links, SIDES.index(side)
    for block in blocks:
        for one in _rows(block):
            made = one[None].copy()
            palm = made[0, _TARGETS].reshape(5, 8)[row, :7]
            made[0, _ROTATIONS].reshape(43, 4)[links] = arm.step(palm)
            made[0, _IMPORTANCE][links] = _ARM
            if isinstance(block, HumanPose):
                arm.refuse_missed(palm)
                yield replace(HumanPose.of(made[0]), states=block.states)
            else:
                yield made


def _rows(block: Array | HumanPose) -> Array:
    """A block as POSE rows (n, 260)."""
    if not isinstance(block, HumanPose):
        return block
    row = np.zeros(size(POSE))
    block.pack(row)
    return row[None]


class _Arm:
    """One arm, from frame to frame, beginning as it is shown."""

    def __init__(self, task: HumanTask, side: str) -> None:
        self._task, self._reacher, self._things = task, Reacher.of(task.human, side), Things(task)
        before, present = task.start, task.present
        links = (self._reacher.arm.from_pose(one.rotations[self._reacher.links]) for one in (before, present))
        then, now = links
        self._tracking = Tracking(self._reacher, now, then)
        self._seat = seat(task.human, before.rotations, before.root)
        self._has = before.grip(side).row()

    def step(self, palm: Array) -> Array:
        """The arm's rows (3, 4) of the next pose, the palm as near to (7,) as it comes, the elbow out of things."""
        task, present = self._task, self._task.present
        place, turned = seat(task.human, present.rotations, present.root)
        turn = multiply(conjugate(self._seat[1]), turned)
        spine = 2.0 * place - self._seat[0], multiply(turned, turn)  # about as it will be carried by this frame
        self._seat = place, turned
        near = self._things.about(present.root, palm[:3])
        self._has = self._tracking.step(palm, spine, 1.0, near)
        return self._reacher.arm.into_pose(self._tracking.links)

    def refuse_missed(self, palm: Array) -> None:
        """Refuse to hold what the palm is not at, as it should be (7,), now that the hand has closed.

        Raises:
            AlgorithmError: the body was carried past too fast, or too far off; says by how much the hand missed.
        """
        off = float(np.linalg.norm(self._has[:3] - palm[:3]))
        turn = 2.0 * float(np.arccos(min(1.0, abs(float(self._has[3:] @ palm[3:])))))
        if off > _MISSED or turn > _TURNED:
            thing = "it" if self._task.object is None else self._task.object.name
            raise AlgorithmError(
                f"the {self._reacher.side} hand closed {1000.0 * off:.0f} mm and {np.degrees(turn):.0f} degrees from "
                f"where it holds {thing}, as the body went by; let the walk end at it, as `floor walk to {thing}` does"
            )
