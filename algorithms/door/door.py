"""A door that the hand opens and closes (Ichiguchi 2000, 5.3.4).

It turns about its hinge only, the z axis of its frame, as far as the hand that holds its knob, on either side of it,
goes along the knob's arc. When the hand opens, or leaves the arc by more than the threshold, it stays where it is.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import HumanFrame, ObjectPose, ObjectTask, Transform, run
from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, multiply, rotate

UP = np.array([0.0, 0.0, 1.0])
FINGERS = ("index", "middle", "ring", "little")
LEVEL = 0.1  # of a lever's direction, its z at the most
FIST = {"right": np.array([0.0175, -0.0165, 0.0]), "left": np.array([0.0175, 0.0165, 0.0])}  # its middle, in the palm's
LARGEST = 1.75  # radians that a door opens, where its state `angle` does not say


def door(task: ObjectTask) -> Iterator[ObjectPose]:
    """The door's pose at each frame of the human."""
    sides = (task.hand,) if task.hand else ("right", "left")
    angle = float(task.object.states.get("angle", 0.0))
    closed = Transform(task.object.place.copy(), multiply(task.object.rotation, from_axis_angle(UP, -angle)))
    names = (task.message.site, f"{task.message.site}_back")
    sites = [task.object.sites[name] for name in names if name in task.object.sites]
    knobs = np.array([site.position for site in sites])
    is_lever = np.abs(rotate(np.array([site.rotation for site in sites]), UP)[:, 2]) < LEVEL  # z goes along one
    # What of the knob, or where on the lever, the palm has from the moment that it is held, in the palm's frame.
    held: Array | None = None
    from_hand, held_by = 0.0, ""  # what the door's angle is beyond that place's bearing
    for human in task.frames():
        palms = {side: closed.inverse().apply(human.grip(side).place) for side in sides}
        at = rotate(from_axis_angle(UP, angle), knobs)
        near = {side: float(np.linalg.norm(at - palm, axis=1).min()) for side, palm in palms.items()}
        side = held_by or min(near, key=lambda side: near[side])
        there = near[side] <= task.parameter("threshold", 0.05)
        if not there or not _holds(human, side, task.parameter("closed_hand", 85.0)):
            held, held_by = None, ""
        else:
            if held is None:
                nearest = int(np.linalg.norm(at - palms[side], axis=1).argmin())
                held, held_by = FIST[side], side
                if not is_lever[nearest]:
                    held = human.grip(side).inverse().apply(closed.apply(at[nearest]))
                from_hand = angle - _bearing(closed.inverse().apply(human.grip(side).apply(held)))
            # The palm may turn on the knob: what goes along the arc is the place where it has it.
            place = closed.inverse().apply(human.grip(side).apply(held))
            angle = float(np.clip(_bearing(place) + from_hand, 0.0, LARGEST))
        yield task.pose(None, multiply(closed.rotation, from_axis_angle(UP, angle)), _told(task, angle))


def _bearing(place: Array) -> float:
    """Where a place (3,) of the closed door's frame is, radians about the hinge."""
    return float(np.arctan2(place[1], place[0]))


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
