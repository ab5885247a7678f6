"""The room before a seat that one stands in to sit down on it, and how far the seat is drawn back to have it."""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.quaternion import rotate
from ahmss.skills.stepping import ground_of
from ahmss.walking.obstacles import Obstacles

__all__ = ["drawn_back", "in_its_room"]

_ROOM = 0.4  # metres free about who stands before a seat that has been drawn out
_LEAST = 0.12  # metres free about who can stand there at all: half a trunk's depth
_STEP, _MOST = 0.02, 1.2  # metres: how finely, and how far back


def in_its_room(task: HumanTask, seat: WorldObject) -> str:
    """What stands where one stands to sit down; "" where nothing does."""
    around, near = _near(task, seat, np.zeros(1))
    if not len(around.shapes):
        return ""
    i = int(near[0].argmin())
    return around.names[i] if near[0, i] < _LEAST else ""


def drawn_back(task: HumanTask, seat: WorldObject) -> float:
    """Metres by which it is to be drawn back so that there is room before it; 0: there is; at most 1.2."""
    far = np.arange(0.0, _MOST, _STEP)
    _, near = _near(task, seat, far)
    free = np.flatnonzero(near.min(axis=1, initial=np.inf) >= _ROOM)
    return float(far[free[0]]) if len(free) else _MOST


def _near(task: HumanTask, seat: WorldObject, far: Array) -> tuple[Obstacles, Array]:
    """What else stands about, and metres (n, m) to it from where one stands before the seat drawn back by (n,)."""
    ground = ground_of(task)
    others = [(ring, name) for ring, name in zip(ground.outlines, ground.names, strict=True) if name != seat.name]
    around = Obstacles.of([ring for ring, _ in others], 0.0, names=[name for _, name in others])
    stand = seat.site("stand", task.start.root).place[:2]
    ahead = rotate(seat.rotation, np.array([1.0, 0.0, 0.0]))[:2]
    return around, np.array([around.clearance(stand - back * ahead) for back in far])
