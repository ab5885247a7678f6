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
BENDS = 1.0  # degrees a frame from which on fingers are closing or opening


def turned(task: ObjectTask) -> Iterator[ObjectPose]:
    """The lever's angle at each frame of the human."""
    sides = (task.hand,) if task.hand else ("right", "left")
    state = task.parameter("state", "turn")
    axis = np.array(task.object.properties.get("axis", (0.0, 0.0, 1.0)), float)
    axis /= np.linalg.norm(axis)
    pivot = np.array(task.object.properties.get("pivot", (0.0, 0.0, 0.0)), float)
    largest = float(task.object.properties.get("largest", LARGEST))
    lever = np.array(task.object.sites[task.message.site].position) - pivot
    angle = way = float(task.object.states.get(state, 0.0))
    leads: tuple[str, int] | None = None  # a hand, and its palm or pinch
    before, bent = np.zeros(3), {side: _bent(task.start, side) for side in sides}
    for human in task.frames():
        points = {side: _points(task, human, side) - pivot for side in sides}
        end = rotate(from_axis_angle(axis, angle), lever)
        side, apart = _nearest(points, end)
        now = {hand: _bent(human, hand) for hand in sides}
        bends, bent = abs(now[side] - bent[side]) > BENDS, now  # while they close and open, fingertips go a long way
        near = apart.min() <= task.parameter("threshold", 0.05)
        if bends or not near or now[side] < task.parameter("closed_hand", 85.0):
            leads = None
        elif leads is None:
            leads, way = (side, int(apart.argmin())), angle
        else:
            way += _between(before, points[leads[0]][leads[1]], axis)
            angle = float(np.clip(way, 0.0, largest))
        if leads is not None:
            before = points[leads[0]][leads[1]]
        told = {state: round(float(np.radians(round(np.degrees(angle), 1))), 4)}
        yield task.pose(None, None, told if state in task.object.states else {})


def _nearest(points: dict[str, Array], end: Array) -> tuple[str, Array]:
    """The hand that is nearest to the lever's end, and how far its palm and its pinch are from it (2,)."""
    apart = {side: np.linalg.norm(place - end, axis=1) for side, place in points.items()}
    side = min(apart, key=lambda side: float(apart[side].min()))
    return side, apart[side]


def _points(task: ObjectTask, human: HumanFrame, side: str) -> Array:
    """The palm and the middle between the tips of thumb and index (2, 3), in the object's frame."""
    pinch = 0.5 * (task.fingertip(side, "thumb") + task.fingertip(side, "index"))
    return task.object.frame.inverse().apply(np.array([human.grip(side).place, pinch]))


def _between(before: Array, now: Array, axis: Array) -> float:
    """How far a point has gone around the axis, radians."""
    a, b = before - (before @ axis) * axis, now - (now @ axis) * axis
    return float(np.arctan2(np.cross(a, b) @ axis, a @ b))


def _bent(human: HumanFrame, side: str) -> float:
    """How far the four fingers are bent, knuckle and middle joint together, on the average, degrees."""
    links = [INDEX[f"{side}_{finger}_{segment}"] for finger in FINGERS for segment in ("proximal", "intermediate")]
    bent = 2.0 * np.arccos(np.clip(np.abs(human.rotations[links, 0]), 0.0, 1.0))
    return float(np.degrees(bent.sum())) / len(FINGERS)


if __name__ == "__main__":
    run(turned)
