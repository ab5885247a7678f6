"""Where one might stand to reach a place: near it, facing it, clear of things and others, and through no wall."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.reaching.plan import Reaching
from ahmss.skills.stepping import ground_of, walkers
from ahmss.walking import goals
from ahmss.walking.obstacles import Obstacles

__all__ = ["CLEAR", "FARTHEST", "facing_it", "is_taken", "stance_at", "standing", "stands_at"]

CLEAR = 0.26
"""Metres from things on the floor to the middle of who stands at them."""

FARTHEST = 0.85
"""Metres, level, from a place to who stands at it, at the most."""

_UP = np.array([0.0, 0.0, 1.0])
_ROOM, _STANDING = 0.66, 0.1  # metres between the middles of two who stand side by side; m/s: who is slower stands
_DIRECTIONS, _AWAY = 24, (0.5, 0.4, 0.62)  # metres from the place to who stands there
_SAME = 0.06  # metres: places so near to each other are one
_A_METRE, _BETWEEN = 0.3, 5.0  # what it costs to go farther, and that a thing is between
_OVER = 0.25  # metres over the place, up to which an arm comes over a thing


def stands_at(task: HumanTask, place: Array) -> list[tuple[float, goals.Goal]]:
    """Where one might stand and face a place (3,), and what each costs, those that serve best first."""
    ground, taken, here = ground_of(task), standing(task), task.start.root[:2]
    floor = Obstacles.of(ground.outlines, CLEAR)
    shapes = floor.shapes
    beside = shapely.distance(shapes, shapely.Point(place[:2])) > 0.0
    high = np.array(ground.tops, float) > place[2] + _OVER
    low, walls = shapes[beside & ~high], shapes[beside & high]
    found: list[tuple[float, goals.Goal]] = []
    for away in _AWAY:
        for angle in np.linspace(0.0, 2.0 * np.pi, _DIRECTIONS, endpoint=False).tolist():
            wanted = place[:2] + away * np.array([np.cos(angle), np.sin(angle)])
            free = floor.nearest_free(wanted)
            stand, length = facing_it(free, place), float(np.linalg.norm(place[:2] - free))
            near = any(float(np.linalg.norm(free - other.place)) < _SAME for _, other in found)
            if length > FARTHEST or near or is_taken(stand, taken):
                continue
            line = shapely.LineString([free, place[:2]])
            if shapely.intersects(walls, line).any():
                continue  # nobody reaches through a wall
            cost = 3.0 * abs(length - _AWAY[0]) + _A_METRE * float(np.linalg.norm(free - here))
            cost += _BETWEEN * bool(shapely.intersects(low, line).any())
            found.append((cost, stand))
    return sorted(found, key=lambda one: one[0])


def facing_it(place: Array, towards: Array) -> goals.Goal:
    """Standing at a place (2,), facing another (3,)."""
    way = towards[:2] - place
    return goals.Goal(place, float(np.arctan2(way[1], way[0])))


def stance_at(task: HumanTask, stand: goals.Goal) -> Reaching:
    """Who would stand there, the arms hanging as of who has come to stand."""
    rotations, root = task.human.relaxed()
    turn = from_axis_angle(_UP, np.array(stand.facing or 0.0))
    rotations[0] = multiply(turn, rotations[0])
    return Reaching(task.human, rotations, rotate(turn, root) + np.append(stand.place, 0.0))


def standing(task: HumanTask) -> list[Array]:
    """Where others stand (2,)."""
    return [other.place for other in walkers(task) if float(np.linalg.norm(other.velocity)) < _STANDING]


def is_taken(stand: goals.Goal, taken: Sequence[Array]) -> bool:
    """Whether somebody stands too near to a place."""
    return any(float(np.linalg.norm(stand.place - place)) < _ROOM for place in taken)
