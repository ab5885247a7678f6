"""A part that turns about an axis of the object, as a tap's lever or a knob, with the hand that holds it.

It turns as far as the hand goes around its axis, or turns there, from its lowest angle 0 to its `largest`, and stays
where it is let go; one that has `positions` goes on to the nearest of these, one that `falls` when the hand has left.
The object itself stays where it is; what turns is shown by the state of its angle.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import ObjectPose, ObjectTask, Transform, run
from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, rotate
from ahmss.skills.leading import led

ON_AXIS = 0.01  # metres: what is taken so near to its axis, as a knob, turns as the hand turns
LARGEST = 1.57  # radians, where its properties do not say


def turned(task: ObjectTask) -> Iterator[ObjectPose]:
    """Its angle at each frame of the human."""
    state, part = task.parameter("state", "turn"), task.parameter("part", "")
    told = task.object.properties.get(part, {}) if part else task.object.properties
    axis = np.array(told.get("axis", (0.0, 0.0, 1.0)), float)
    axis /= np.linalg.norm(axis)
    pivot = np.array(told.get("pivot", (0.0, 0.0, 0.0)), float)
    lever = np.array(task.object.sites[task.message.site].position) - pivot
    positions = [float(at) for at in told.get("positions", {}).values()]
    limits = (0.0, float(told.get("largest", LARGEST)))

    def at(angle: float) -> Array:
        return pivot + rotate(from_axis_angle(axis, np.array(angle)), lever)

    on_axis = float(np.linalg.norm(lever - (lever @ axis) * axis)) < ON_AXIS

    def gone(before: Transform, now: Transform) -> float:
        """How far a point has gone around the axis, radians; on the axis how far it was turned."""
        if on_axis:
            turn = multiply(now.rotation, conjugate(before.rotation))
            return 2.0 * float(np.arctan2(turn[1:] @ axis, turn[0])) / task.parameter("along", 0.5)
        a, b = before.place - pivot, now.place - pivot
        a, b = a - (a @ axis) * axis, b - (b @ axis) * axis
        return float(np.arctan2(np.cross(a, b) @ axis, a @ b))

    def settled(angle: float) -> float:
        return min(positions, key=lambda position: abs(position - angle)) if positions else angle

    now, falls = float(task.object.states.get(state, 0.0)), bool(told.get("falls", False))
    for angle in led(task, now, limits, at, gone, settled, falls=falls):
        value = angle if angle in positions else float(np.radians(round(np.degrees(angle), 1)))
        yield task.pose(None, None, {state: round(value, 4)} if state in task.object.states else {})


if __name__ == "__main__":
    run(turned)
