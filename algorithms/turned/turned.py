"""A lever that turns about an axis of the object, as a tap's, with the hand that holds it.

It turns as far as the hand goes around its axis, from its lowest angle 0 to its `largest`. When the hand opens, or
leaves the lever by more than the threshold, it stays where it is. A fist holds it in the palm, a pinch between thumb
and index: whichever is nearer when it is caught leads it. The object itself stays where it is; what turns is shown by
the state of its angle.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import HumanFrame, ObjectPose, ObjectTask, run
from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, rotate

FINGERS = ("index", "middle", "ring", "little")
LARGEST = 1.57  # radians, where its properties do not say


def turned(task: ObjectTask) -> Iterator[ObjectPose]:
    """The lever's angle at each frame of the human."""
    side = task.hand or "right"
    state = task.parameter("state", "turn")
    axis = np.array(task.object.properties.get("axis", (0.0, 0.0, 1.0)), float)
    axis /= np.linalg.norm(axis)
    pivot = np.array(task.object.properties.get("pivot", (0.0, 0.0, 0.0)), float)
    largest = float(task.object.properties.get("largest", LARGEST))
    lever = np.array(task.object.sites[task.message.site].position) - pivot
    angle = hand = float(task.object.states.get(state, 0.0))
    leads: int | None = None  # palm or pinch
    before = np.zeros(3)
    for human in task.frames():
        points = _points(task, human, side) - pivot
        apart = np.linalg.norm(points - rotate(from_axis_angle(axis, angle), lever), axis=1)
        if apart.min() > task.parameter("threshold", 0.05) or not _holds(
            human, side, task.parameter("closed_hand", 85.0)
        ):
            leads = None
        elif leads is None:
            leads, hand = int(apart.argmin()), angle
        else:
            hand += _between(before, points[leads], axis)
            angle = float(np.clip(hand, 0.0, largest))
        if leads is not None:
            before = points[leads]
        told = {state: round(float(np.radians(round(np.degrees(angle), 1))), 4)}
        yield task.pose(None, None, told if state in task.object.states else {})


def _points(task: ObjectTask, human: HumanFrame, side: str) -> Array:
    """The palm and the middle between the tips of thumb and index (2, 3), in the object's frame."""
    pinch = 0.5 * (task.fingertip(side, "thumb") + task.fingertip(side, "index"))
    return task.object.frame.inverse().apply(np.array([human.grip(side).place, pinch]))


def _between(before: Array, now: Array, axis: Array) -> float:
    """How far a point has gone around the axis, radians."""
    a, b = before - (before @ axis) * axis, now - (now @ axis) * axis
    return float(np.arctan2(np.cross(a, b) @ axis, a @ b))


def _holds(human: HumanFrame, side: str, degrees: float) -> bool:
    """Whether the four fingers are bent so far, knuckle and middle joint together, on the average."""
    links = [INDEX[f"{side}_{finger}_{segment}"] for finger in FINGERS for segment in ("proximal", "intermediate")]
    bent = 2.0 * np.arccos(np.clip(np.abs(human.rotations[links, 0]), 0.0, 1.0))
    return bool(np.degrees(bent.sum()) >= degrees * len(FINGERS))


if __name__ == "__main__":
    run(turned)
