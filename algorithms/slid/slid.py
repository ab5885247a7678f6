"""A knob that slides along a slot with the hand that holds it; it stays where it is let go.

The property `slide` is its way in the object's frame, metres; how far it is on it is shown by a state, 0 to 1.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import ObjectPose, ObjectTask, Transform, run
from ahmss.body.array import Array
from ahmss.skills.leading import led


def slid(task: ObjectTask) -> Iterator[ObjectPose]:
    """How far it is, at each frame of the human."""
    state = task.parameter("state", "level")
    way = np.array(task.object.properties.get("slide", (0.0, 0.0, 0.1)), float)
    length = float(np.linalg.norm(way))
    site = np.array(task.object.sites[task.message.site].position)

    def at(level: float) -> Array:
        return site + level * way

    def gone(before: Transform, now: Transform) -> float:
        return float((now.place - before.place) @ way) / length**2

    for level in led(task, float(task.object.states.get(state, 0.0)), (0.0, 1.0), at, gone, lambda level: level):
        yield task.pose(None, None, {state: round(level, 3)} if state in task.object.states else {})


if __name__ == "__main__":
    run(slid)
