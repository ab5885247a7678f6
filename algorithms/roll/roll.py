"""Rolling on a seat with castors: to a place, drawn up before a thing, or round on the spot.

A place is where the seat shall stand. Before a thing one comes as near as trunk, knees and castors have room, as far
from it as one works at it.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import HumanTask, WorldObject, run
from ahmss.body.array import Array
from ahmss.errors import AlgorithmError
from ahmss.skills.castors import drawn_up, rolled_to
from ahmss.skills.sitting import heading_of, seat_of


def roll(task: HumanTask) -> Iterator[Array]:
    """Frames (n, 260) of the way there."""
    seat = seat_of(task)
    if task.object is None or seat is None or seat.thing.id != task.object.id:
        name = "it" if task.object is None else task.object.name
        raise AlgorithmError(f"one must sit on {name} to roll on it; `do {name} sit` first")
    yield from rolled_to(task, seat, _goals(task, task.object))


def _goals(task: HumanTask, seat: WorldObject) -> list[tuple[Array, float]]:
    """Where the hips may be, and which way they look, the best first."""
    now, facing = heading_of(task.start.rotations), task.goal_facing
    if task.goal_object is not None:
        return drawn_up(task.goal_object)
    if task.goal_place is None:
        if facing is None:
            raise AlgorithmError("where to? add `to X Y`, `to` and an object, or `facing` and degrees")
        return [(task.start.root[:2].copy(), facing)]
    off, turn = task.start.root[:2] - seat.place[:2], 0.0 if facing is None else facing - now
    cos, sin = np.cos(turn), np.sin(turn)
    over = np.array([cos * off[0] - sin * off[1], sin * off[0] + cos * off[1]])
    return [(task.goal_place[:2] + over, now + turn)]


if __name__ == "__main__":
    run(roll)
