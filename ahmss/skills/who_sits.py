"""Meeting somebody when one of the two sits: who stands comes, to where who sits has them before the eyes."""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.pose import HumanPose
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE
from ahmss.body.links import INDEX
from ahmss.errors import AlgorithmError
from ahmss.motion.edit import floor_frame
from ahmss.skills.company import Watching, aside_of, eye_of, settled
from ahmss.skills.sitting import must_stand, seat_under, stands

__all__ = ["OUT_OF_REACH", "height_of_both", "until_they_come", "views"]

OUT_OF_REACH = 2
"""How `views` calls a place that is too far aside for who sits."""

_BEFORE, _TO_REACH = np.radians([40.0, 90.0])  # aside of where who sits faces: before them; as far as arms come
_EYES = 0.936  # of the stature
_PATIENCE, _TELLS = 10.0, 0.5  # seconds that one waits for somebody who does not move; after which it is told
_LOOKS = 1.0, 3.3  # seconds that who stands aside is looked at: who faces one there to talk, and others
_FACING = np.radians(25.0)
_STILL = 10, 0.03  # frames, metres: who has moved no more than that stands


def views(whom: WorldObject, places: Array) -> NDArray[np.int_]:
    """How well somebody who sits has who comes to places (n, 2) before them: 0 well, 1 aside, 2 out of their reach."""
    return _how_well(_bearing(whom, places))


def _bearing(whom: WorldObject, places: Array) -> Array:
    """How far places (..., 2) are to the left of where somebody faces, radians."""
    heading = 2.0 * np.arctan2(whom.rotation[3], whom.rotation[0])
    off = places - whom.place[:2]
    return (np.arctan2(off[..., 1], off[..., 0]) - heading + np.pi) % (2.0 * np.pi) - np.pi


def _faces(task: HumanTask, whom: WorldObject) -> bool:
    return bool(abs(_bearing(whom, task.present.root[:2])) <= _FACING)


def _how_well(aside: Array | float) -> NDArray[np.int_]:
    aside = np.abs(aside)
    return np.where(aside <= _BEFORE, 0, np.where(aside <= _TO_REACH, 1, OUT_OF_REACH))


def height_of_both(task: HumanTask, eyes: float) -> float:
    """What stature (metres) one would have who stands with the eyes as high as both have them, in the mean.

    eyes: how high the other's are, metres. Who stands and bows oneself is as tall as ever.
    """
    own = task.human.stature if stands(task) else float(eye_of(task)[2]) / _EYES
    return 0.5 * (own + eyes / _EYES)


def until_they_come(
    task: HumanTask, whom: WorldObject, most: float, *, beside: bool = False, handing: bool = False
) -> Iterator[HumanPose]:
    """Frames in which who sits looks at somebody until these stand before them, no farther than `most` metres.

    Who stands aside, where arms come as well, may be about to come round, and is looked at for a while. beside: to
    either side they are where they should be. handing: once something is held out to them they are not to go on.

    Raises:
        AlgorithmError: they sit elsewhere, or do not come within the parameter `patience`; says who is to do what.
            Rested: one was to come to rest.
    """
    watching, track = Watching(task, whom), deque[Array](maxlen=_STILL[0])
    importance = np.zeros(44)
    importance[INDEX["head"]] = 1.0
    stood, told = 0, False
    for k in itertools.count(1):
        track.append(whom.place.copy())
        stood = stood + 1 if settled(track, *_STILL) else 0
        sits = seat_under(task, whom) if stood else None
        seen = int(_how_well(aside_of(task, whom.place)))
        if seen < OUT_OF_REACH and stood and _distance(task, whom) <= most:
            looks = _LOOKS[handing or not _faces(task, whom)]
            if seen == 0 or beside or sits or stood > looks * task.rate:
                return
        elif sits or stood > task.parameter("patience", _PATIENCE) * task.rate:
            _refuse(task, whom, sits)
        if k > _TELLS * task.rate and not told:
            told = True
            task.note(f"waits for {whom.name} to come")
        task.refuse_rest()
        targets = np.zeros((5, 8))
        targets[GAZE] = watching.gaze(0.0, 0.0, k)
        yield task.pose({}, None, importance, targets)


def _distance(task: HumanTask, whom: WorldObject) -> float:
    here, _ = floor_frame(task.present.rotations, task.present.root)
    return float(np.hypot(*(whom.place - here)[:2]))


def _refuse(task: HumanTask, whom: WorldObject, sits: WorldObject | None) -> None:
    """Refuse to meet who is not before one who sits.

    Raises:
        AlgorithmError: says where they are, and who is to do what.
    """
    aside = abs(aside_of(task, whom.place))
    where = f"{_distance(task, whom):.1f} m off" if aside <= _TO_REACH else f"{np.degrees(aside):.0f} degrees aside"
    where += f" and sits on {sits.name}" if sits is not None else " and does not come"
    raise AlgorithmError(
        f"{whom.name} is {where}; {must_stand(task, 'meet them there')}, or ask {whom.name} to come before you"
    )
