"""An object that follows the hand (Ichiguchi 2000, 5.3.4).

It is caught when the hand has closed, as main tells of the motion that closes it, and is at it. From then on it keeps
its pose in the palm as it was at that moment, so it does not jump, and stays caught for as long as this algorithm runs,
whatever the human does.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import HumanFrame, ObjectPose, ObjectTask, Transform, run
from ahmss.body.quaternion import normalize, rotate
from ahmss.skills.grasping import from_skin, read_shape


def follow_hand(task: ObjectTask) -> Iterator[ObjectPose]:
    """The object's pose at each frame of the human."""
    side = task.hand or "right"
    in_palm: Transform | None = None
    read_shape(task)
    for human in task.frames():
        grip = human.grip(side)
        if in_palm is None:
            if not task.closed or _apart(task, human, side) > task.parameter("threshold", 0.03):
                yield task.pose()
                continue
            in_palm = grip.inverse().then(task.object.frame)
        followed = grip.then(in_palm)
        yield task.pose(followed.place, normalize(followed.rotation))


def _apart(task: ObjectTask, human: HumanFrame, side: str) -> float:
    """How far the hand is from the object, metres."""
    if task.object.shape is not None and task.parameter("diameter", 0.0) <= 0.0:
        return max(from_skin(task, human, side), 0.0)
    return abs(_from_wall(task, human.grip(side)))


def _from_wall(task: ObjectTask, grip: Transform) -> float:
    """The palm's distance from the object's wall, metres, negative inside; the axis is the z of the action's site."""
    named = task.object.sites.get(task.message.site)
    axis = task.object.frame
    if named is not None:
        axis = axis.then(Transform(np.array(named.position), np.array(named.rotation)))
    diameter = task.parameter("diameter", 0.0) or float(task.object.properties.get("diameter", 0.0))
    apart = grip.place - axis.place
    along = rotate(axis.rotation, np.array([0.0, 0.0, 1.0]))
    if diameter > 0.0:
        apart = apart - (apart @ along) * along
    return float(np.linalg.norm(apart)) - 0.5 * diameter


if __name__ == "__main__":
    run(follow_hand)
