"""What is carried between both hands, as it takes up of the floor before who stands: kept out of things there.

No hand is free to act meanwhile, so nobody has to stand just where they would without it: who comes to stand beside a
thing stops so far from it that load and arms have room, and that it has where it is put down there.
"""

from __future__ import annotations

import itertools

import numpy as np

from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, rotate
from ahmss.motion.edit import floor_frame
from ahmss.reaching.reacher import SIDES, Reacher, heading_of
from ahmss.reaching.skin import skin_of
from ahmss.walking.goals import Goal
from ahmss.walking.pieces import Ground
from ahmss.walking.standing_room import Load, Room, with_room

__all__ = ["load_of", "with_load"]

_PUT_DOWN = 0.1  # metres that a load is farther ahead where it is put down
_AIR = 0.03  # metres that it is kept from things
_TURNS = 0.3  # metres: who goes farther comes to look along the way


def load_of(task: HumanTask) -> Load | None:
    """What the task's human carries between both hands, and the arms; None where that is nothing."""
    thing = task.in_hand("right") if task.between else None
    if thing is None:
        return None
    rotations, root = task.start.rotations, task.start.root
    skins = [skin_of(Reacher.of(task.human, side), rotations, root) for side in SIDES]
    place, turn = floor_frame(rotations, root)
    points = rotate(conjugate(turn), np.concatenate([_corners(thing), *(points for points, _ in skins)]) - place)
    ahead = points[:8] + np.array([_PUT_DOWN, 0.0, 0.0])
    lowest = min(float(points[:8, 2].min()), *(float((skin[:, 2] - radii).min()) for skin, radii in skins))
    return Load(np.concatenate([points, ahead])[:, :2], lowest, _AIR)


def with_load(task: HumanTask, there: Room, facing: float | None, ground: Ground) -> Room:
    """Where one would stand, or where beside that what is carried between both hands is in nothing, if anywhere.

    Args:
        task: who walks. there: where. facing: and which way one looks, radians; None: as one comes there.
        ground: what stands on the floor.
    """
    load = load_of(task)
    if load is None:
        return there
    way = there.place - task.start.root[:2]
    if facing is None and float(np.hypot(*way)) > _TURNS:
        facing = float(np.arctan2(way[1], way[0]))
    if facing is None:
        facing = heading_of(task.start.rotations, task.start.root)
    room = with_room(task.human, Goal(there.place, facing), ground, load, body=False)
    return there if room is None or not room.beside else room


def _corners(thing: WorldObject) -> Array:
    """Where the corners (8, 3) of a thing are, of one that does not say its size its middle."""
    size = thing.properties.get("size")
    length = np.array(size, float) if isinstance(size, (list, tuple)) and len(size) == 3 else np.zeros(3)
    ends = np.array(list(itertools.product((-0.5, 0.5), (-0.5, 0.5), (0.0, 1.0))))
    return thing.frame.apply(ends * length)
