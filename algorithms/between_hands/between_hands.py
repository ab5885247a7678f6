"""An object that is carried between both palms, level, and stands again where they put it down.

The palms take it where each is at its site, `right` and `left`, and pressed to that side. It goes with the middle
between them and turns with the line that joins them. It is never lower than where it stood, as on a floor; while it
stands there, palms that go down slide along it, and palms that go apart leave it. In the air nothing else bears it: it
goes with them there, whatever they do, until it stands again.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import HumanFrame, ObjectPose, ObjectTask, Transform, run
from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle

HANDS = ("right", "left")
PRESSED = 0.002  # metres that a palm may be off the object's side to hold it
SETTLES, STEP = (
    0.03,
    0.003,
)  # metres above where it stood from which it sinks down when it is let go, and a frame's sinking
UP = np.array([0.0, 0.0, 1.0])


def between_hands(task: ObjectTask) -> Iterator[ObjectPose]:
    """The object's pose at each frame of the human."""
    sites = np.array([task.object.sites[hand].position for hand in HANDS])
    floor, threshold = float(task.object.place[2]), task.parameter("threshold", 0.05)
    frame, in_hands = task.object.frame, None
    for human in task.frames():
        palms = np.array([human.grip(hand).place for hand in HANDS])
        carried = _between(palms)
        held = None if in_hands is None else carried.then(in_hands)
        in_air = frame.place[2] > floor + SETTLES
        if in_hands is not None and held is not None and (in_air or _holds(human, palms, held, sites, threshold)):
            if held.place[2] > floor or frame.place[2] > floor:
                frame = Transform(np.array([*held.place[:2], max(held.place[2], floor)]), held.rotation)
            if held.place[2] <= floor:  # it stands, and the palms slide
                in_hands = carried.inverse().then(frame)
        elif _holds(human, palms, frame, sites, threshold):
            in_hands = carried.inverse().then(frame)
        else:
            in_hands = None
            if frame.place[2] < floor + SETTLES:
                frame = Transform(np.array([*frame.place[:2], max(floor, frame.place[2] - STEP)]), frame.rotation)
        yield task.pose(frame.place, frame.rotation)


def _holds(human: HumanFrame, palms: Array, frame: Transform, sites: Array, threshold: float) -> bool:
    """Whether both palms (2, 3) are near their sites (2, 3), face the object and are pressed to it, it being there."""
    apart = frame.inverse().apply(palms) - sites
    outwards = sites * np.array([0.0, 1.0, 0.0])
    outwards = outwards / np.linalg.norm(outwards, axis=-1, keepdims=True)
    facing = [Transform(np.zeros(3), human.grip(hand).rotation).apply(np.array([1.0, 0.0, 0.0])) for hand in HANDS]
    seen = frame.inverse().apply(frame.place + np.array(facing))
    pressed = np.einsum("hc,hc->h", apart, outwards) < PRESSED
    inwards = np.einsum("hc,hc->h", seen, outwards) < 0.0
    return bool((np.linalg.norm(apart, axis=-1) < threshold).all() and pressed.all() and inwards.all())


def _between(palms: Array) -> Transform:
    """The level frame in the middle of the palms (2, 3), right and left, y from the one to the other."""
    right, left = palms
    aside = left - right
    return Transform(0.5 * (right + left), from_axis_angle(UP, float(np.arctan2(-aside[0], aside[1]))))


if __name__ == "__main__":
    run(between_hands)
