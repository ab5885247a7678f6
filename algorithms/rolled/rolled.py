"""A seat on castors that goes with who sits on it.

It stays while they sit down, and while they stand up. As long as the hips are on it, it goes level, and turns about
the vertical, as they do: how it stood under them when they had come down is how it stands under them from then on.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import ObjectPose, ObjectTask, Transform, run
from ahmss.body.quaternion import from_axis_angle, multiply
from ahmss.skills.sitting import heading_of

ON = 0.2, 0.3  # metres: hips so near to the seat's middle, and so high over it at the most, are on it
RESTS, RISES = 0.0003, 0.003  # metres a frame: hips that sink less have come down; metres over there: they stand up
UPWARD = np.array([0.0, 0.0, 1.0])


def rolled(task: ObjectTask) -> Iterator[ObjectPose]:
    """The seat's pose at each frame of the human."""
    under: Transform | None = None
    height = float(task.start.root[2])
    rests = height
    for human in task.frames():
        root, sank = human.root, abs(float(human.root[2]) - height)
        height = float(root[2])
        hips = Transform(root * (1.0, 1.0, 0.0), from_axis_angle(UPWARD, heading_of(human.rotations)))
        if under is None and sank < RESTS and _is_on(task, root):
            under, rests = hips.inverse().then(task.object.frame), height
        elif under is not None and height > rests + RISES:
            under = None
        if under is None:
            yield task.pose()
            continue
        frame = hips.then(under)
        yield task.pose(frame.place, multiply(frame.rotation, np.array([1.0, 0.0, 0.0, 0.0])))


def _is_on(task: ObjectTask, root: np.ndarray) -> bool:
    """Whether hips at a place (3,) are on the seat."""
    off = root - task.object.site("seat", root).place
    return bool(np.hypot(off[0], off[1]) < ON[0] and 0.0 < off[2] < ON[1])


if __name__ == "__main__":
    run(rolled)
