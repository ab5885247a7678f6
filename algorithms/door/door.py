"""A door that the hand opens and closes (Ichiguchi 2000, 5.3.4).

It turns about its hinge only, the z axis of its frame, as far as the hand that holds its knob goes along the knob's
arc. When the hand opens, or leaves the arc by more than the threshold, the door stays where it is.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import HumanFrame, ObjectPose, ObjectTask, Transform, run
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, multiply, rotate

UP = np.array([0.0, 0.0, 1.0])
FINGERS = ("index", "middle", "ring", "little")
LARGEST = 1.75  # radians that a door opens, where its state `angle` does not say


def door(task: ObjectTask) -> Iterator[ObjectPose]:
    """The door's pose at each frame of the human."""
    side = task.hand or "right"
    angle = float(task.object.states.get("angle", 0.0))
    closed = Transform(task.object.place.copy(), multiply(task.object.rotation, from_axis_angle(UP, -angle)))
    knob = np.array(task.object.sites[task.message.site].position)
    from_hand: float | None = None  # what the door's angle is beyond the hand's, from the moment that it is held
    for human in task.frames():
        hand = closed.inverse().apply(human.grip(side).place)
        leaf = from_axis_angle(UP, angle)
        near = float(np.linalg.norm(rotate(leaf, knob) - hand)) <= task.parameter("threshold", 0.05)
        if not near or not _holds(human, side, task.parameter("closed_hand", 85.0)):
            from_hand = None
        else:
            bearing = float(np.arctan2(hand[1], hand[0]))
            if from_hand is None:
                from_hand = angle - bearing
            angle = float(np.clip(bearing + from_hand, 0.0, LARGEST))
        yield task.pose(None, multiply(closed.rotation, from_axis_angle(UP, angle)), _told(task, angle))


def _holds(human: HumanFrame, side: str, degrees: float) -> bool:
    """Whether the four fingers are bent so far, knuckle and middle joint together, on the average."""
    links = [INDEX[f"{side}_{finger}_{segment}"] for finger in FINGERS for segment in ("proximal", "intermediate")]
    bent = 2.0 * np.arccos(np.clip(np.abs(human.rotations[links, 0]), 0.0, 1.0))
    return bool(np.degrees(bent.sum()) >= degrees * len(FINGERS))


def _told(task: ObjectTask, angle: float) -> dict[str, float]:
    """The state `angle`, to a tenth of a degree, so that it is told only when it changes."""
    return {"angle": round(float(np.radians(round(np.degrees(angle), 1))), 4)} if "angle" in task.object.states else {}


if __name__ == "__main__":
    run(door)
