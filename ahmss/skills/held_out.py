"""Waiting until somebody holds something out: it is about half-way between both, low enough, and still."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator

import numpy as np

from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.pose import HumanPose
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE
from ahmss.body.links import INDEX
from ahmss.errors import AlgorithmError
from ahmss.motion.edit import floor_frame
from ahmss.skills.company import Watching, aside_of, settled
from ahmss.skills.meeting import FACING, HANDING, come_to
from ahmss.skills.sitting import seat_of, seat_under
from ahmss.skills.who_sits import height_of_both

__all__ = ["until_held_out"]

_NEAR = 1.45  # metres to who gives, from where on it may be held out
_SHARES = (0.35, 0.68)  # of the way to them, between which it is held out
_LOW = 0.66  # of the height of both: up to where a thing is held out
_STILL, _FRAMES = 0.004, 10  # metres in so many frames
_TELLS = 0.5  # seconds after which it is told that one waits
_CAME, _LONG = 0.06, 2.5  # metres from where the giver had it at first; seconds that it is still where it has not come


def until_held_out(task: HumanTask, whom: WorldObject) -> Iterator[Array | HumanPose]:
    """One looks at them, turns to them when they are near, and sees whether the thing is between both and still.

    Who stands comes to who sits; who sits stays there.

    Raises:
        AlgorithmError: it is not held out within the parameter `patience`, seconds. Rested: one was to come to rest.
    """
    assert task.object is not None
    sits = seat_of(task) is not None
    if not sits and seat_under(task, whom) is not None:
        yield from come_to(task, whom, HANDING, courteous=False)
    watching, track, stands = Watching(task, whom), deque[Array](maxlen=_FRAMES), deque[Array](maxlen=_FRAMES)
    importance = np.zeros(44)
    importance[INDEX["head"]] = 1.0
    had = whom.frame.inverse().apply(task.object.place)
    still, eyes = 0, 0.0
    for k in range(1, round(task.parameter("patience", 30.0) * task.rate) + 1):
        task.refuse_rest()
        targets = np.zeros((5, 8))
        targets[GAZE] = watching.gaze(0.0, 0.0, k)
        yield task.pose({}, None, importance, targets)
        if k == round(_TELLS * task.rate):
            task.note(f"waits for {whom.name} to hold {task.object.name} out")
        here, _ = floor_frame(task.present.rotations, task.present.root)
        way = (whom.place - here)[:2]
        distance = float(np.hypot(*way))
        track.append(task.object.place.copy())
        stands.append(whom.place.copy())
        eyes = max(eyes, float(watching.eyes[2]))  # who bows to hold it out is as tall as before
        if distance > _NEAR or not settled(stands, _FRAMES, 5.0 * _STILL):
            continue
        if not sits and abs(aside_of(task, whom.place)) > FACING:
            yield from come_to(task, whom, (0.0, distance, _NEAR))
        share = float((task.object.place - here)[:2] @ way) / distance**2
        # What is held before the eyes is read, not held out.
        low = float(task.object.place[2]) < _LOW * height_of_both(task, eyes)
        still = still + 1 if settled(track, _FRAMES, _STILL) else 0
        came = float(np.linalg.norm(whom.frame.inverse().apply(task.object.place) - had)) > _CAME
        if _SHARES[0] < share < _SHARES[1] and low and still > (0 if came else _LONG * task.rate):
            return
    seconds = task.parameter("patience", 30.0)
    raise AlgorithmError(f"{whom.name} has not held out {task.object.name} within {seconds:g} s")
