"""Who sits, and on what; what one must stand for is told in a sentence."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.quaternion import rotate

__all__ = ["LOWEST", "Seated", "heading_of", "must_stand", "seat_of", "seat_under", "stands"]

LOWEST = 0.75
"""Of the upright hips' height: who is lower sits or kneels."""

_ON = 0.2, 0.3  # metres: hips so near to a seat's middle, and so high over it at the most, are on it
_EYES_OVER = 0.95  # metres: eyes that are no higher over a seat are of one who sits on it
_LEFT = np.array([0.0, 1.0, 0.0])


@dataclass(frozen=True, eq=False)
class Seated:
    """What a human sits on; `castors`, whether it rolls."""

    thing: WorldObject

    @property
    def castors(self) -> bool:
        """Whether it rolls."""
        return self.thing.properties.get("castors") is True


def seat_of(task: HumanTask) -> Seated | None:
    """What the human sits on; None who sits on nothing that tells a site `seat`."""
    root = task.start.root
    for thing in _seats(task):
        over = root - thing.site("seat", root).place
        if np.hypot(over[0], over[1]) < _ON[0] and 0.0 < over[2] < _ON[1]:
            return Seated(thing)
    return None


def seat_under(task: HumanTask, whom: WorldObject) -> WorldObject | None:
    """What another human sits on, as their eyes tell; None who stands, or sits on nothing that tells a site `seat`."""
    root = task.start.root
    eyes = whom.site("eyes", root).place
    for thing in _seats(task):
        seat = thing.site("seat", root).place
        if np.hypot(*(whom.place - seat)[:2]) < _ON[0] and 0.0 < eyes[2] - seat[2] < _EYES_OVER:
            return thing
    return None


def _seats(task: HumanTask) -> list[WorldObject]:
    things = (*task.world.values(), task.object)
    return [thing for thing in things if thing is not None and "seat" in thing.sites]


def stands(task: HumanTask) -> bool:
    """Whether the human stands: neither sits nor crouches."""
    return bool(task.start.root[2] >= LOWEST * task.human.upright()[1][2])


def must_stand(task: HumanTask, what: str) -> str:
    """That one must stand for something, and what to do, in words."""
    seat = seat_of(task)
    stands = f"`do {seat.thing.name} stand_up` first" if seat else "stand up first: `do floor stand`"
    return f"one must stand to {what}; {stands}"


def heading_of(rotations: Array) -> float:
    """Which way hips (43, 4) look, level, radians: as their left says, however they lean."""
    left = rotate(rotations[0], _LEFT)
    return float(np.arctan2(-left[0], left[1]))
