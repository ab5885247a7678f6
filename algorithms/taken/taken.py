"""An object that a hand takes, carries and lays down.

It is caught when the fingers, at it, have closed and are still; what was given into the hand is at once. From then on
it keeps its pose in the palm. It is let go when the fingers open while the hand is still. A state `taken`, where the
kind has it, says "yes" in between.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import HumanFrame, ObjectPose, ObjectTask, Transform, run
from ahmss.body.links import INDEX
from ahmss.body.quaternion import normalize
from ahmss.skills.grasping import from_skin, read_shape

NEAR, AT_IT = 0.008, 0.025  # metres between skin and shape, when it holds and when it is about to
CLOSES = 5.0  # degrees by which the fingers have bent there
MOVES, STILL = 0.4, 4  # degrees that fingers bend in a frame; frames in which they don't
OPENS = 8.0  # degrees by which they have opened
RESTS = 0.002  # metres that the palm moves in a frame at the most while it lets go
BONES = [
    (finger, segment) for finger in ("index", "middle", "ring", "little") for segment in ("proximal", "intermediate")
]


def taken(task: ObjectTask) -> Iterator[ObjectPose]:
    """The object's pose at each frame of the human."""
    side = task.hand or "right"
    read_shape(task)
    held: Transform | None = None
    before, still, wide, tight = _bent(task.start, side), 0, np.inf, 0.0
    place = task.start.grip(side).place.copy()
    told: dict[str, str] = {}
    if task.hold == "keep":  # it came from another hand
        held, tight, told = task.start.grip(side).inverse().then(task.object.frame), before, {"taken": "yes"}
    for human in task.frames():
        palm, bent = human.grip(side), _bent(human, side)
        still = still + 1 if abs(bent - before) < MOVES else 0
        if held is None:
            apart = from_skin(task, human, side)
            wide = min(wide, bent) if apart < AT_IT else np.inf  # how far the hand was open, here
            if bent > wide + CLOSES and still >= STILL and apart < NEAR:
                held, tight, told = palm.inverse().then(task.object.frame), bent, {"taken": "yes"}
        elif bent < tight - OPENS and float(np.linalg.norm(palm.place - place)) < RESTS:
            held, wide, told = None, np.inf, {"taken": "no"}
        before, place = bent, palm.place.copy()
        told = told if "taken" in task.object.states else {}
        if held is None:
            yield task.pose(None, None, told)
        else:
            tight = max(tight, bent)
            followed = palm.then(held)
            yield task.pose(followed.place, normalize(followed.rotation), told)
        told = {}


def _bent(human: HumanFrame, side: str) -> float:
    """How far the four fingers are bent, knuckle and middle joint together, on the average, degrees."""
    links = [INDEX[f"{side}_{finger}_{segment}"] for finger, segment in BONES]
    return float(np.degrees(2.0 * np.arccos(np.clip(np.abs(human.rotations[links, 0]), 0.0, 1.0)).sum())) / 4.0


if __name__ == "__main__":
    run(taken)
