"""Steps to where a hand comes to a place that it does not come to from here: round a table to its other side, say.

What the shipped algorithms that lay something down share, and an author may use.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence

import numpy as np
import shapely

from ahmss.algorithm.controls import gone_to, is_taken, stance_at, standing, stretch_from
from ahmss.algorithm.out_of_reach import MOST_MISSING
from ahmss.algorithm.reaching import Looking
from ahmss.algorithm.stepping import ground_of
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.errors import AlgorithmError
from ahmss.motion.steps import Steps
from ahmss.reaching.goal import Goal
from ahmss.reaching.leaning import Stretch
from ahmss.reaching.prism import Prism
from ahmss.reaching.reacher import SIDES
from ahmss.walking import goals
from ahmss.walking.obstacles import nearest_free

__all__ = ["gone_nearer"]

_CLEAR = 0.26  # metres from things on the floor to the middle of who stands at them
_DIRECTIONS, _AWAY, _FARTHEST = 24, (0.5, 0.4, 0.62), 0.85  # metres from the place to who stands there
_SAME = 0.06  # metres: places so near to each other are one
_EASY = 0.9  # of the arm's length
_LOOKED_AT = 16  # stands whose arm is looked at
_A_METRE, _BETWEEN = 0.3, 5.0  # what it costs to go farther, and that a thing is between


def gone_nearer(
    task: HumanTask,
    place: Array,
    goal: Callable[[float], Goal],
    gaze: Looking,
    prisms: Sequence[Prism],
    most: float = MOST_MISSING,
) -> Generator[Array, None, tuple[HumanTask, Looking]]:
    """The task from where a hand comes to a place (3,), after steps (n, 260) to there, the eyes on it if it is ahead.

    Args:
        task: with a walk library; whose hand it is.
        goal: the hand's goal there, for who faces so many radians.
        gaze: where it is on its way. prisms: what may be in the hand's way.
        most: metres that the arm may be too short for it there.

    Raises:
        AlgorithmError: nobody can stand where it is in reach, or gets there.
    """
    stand = yield from gaze.during(_best(task, place, goal, prisms, most))
    task.note(f"goes to {stand.place[0]:.2f} {stand.place[1]:.2f}, from where the arm comes there")
    return (yield from gone_to(task, stand, gaze, "that place"))


def _best(
    task: HumanTask, place: Array, goal: Callable[[float], Goal], prisms: Sequence[Prism], most: float
) -> Steps[goals.Goal]:
    """Where one stands: of the near places the first from which it is easy, else the easiest."""
    best: tuple[float, goals.Goal, Stretch] | None = None
    for stand in _stands(task, place)[:_LOOKED_AT]:
        assert stand.facing is not None
        arm = yield from stretch_from(task, stand, goal(stand.facing))
        if arm.found and arm.stretched < _EASY:
            return stand
        worth = arm.cost + 40.0 * max(arm.stretched - _EASY, 0.0) + (0.0 if arm.found else 20.0)
        if best is None or worth < best[0]:
            best = worth, stand, arm
        yield
    x, y, z = place.tolist()
    if best is None:
        raise AlgorithmError(f"there is no free place to stand near {x:.2f} {y:.2f} {z:.2f}; say another place")
    stand = best[1]
    assert stand.facing is not None
    wanted, leaning = goal(stand.facing), stance_at(task, stand)
    reacher = yield from leaning.better_side(wanted, [side for side in SIDES if side in wanted.palms])
    _, _, arm = yield from leaning.posture(reacher, wanted, prisms)
    if arm.missing > most:
        raise AlgorithmError(
            f"{x:.2f} {y:.2f} {z:.2f} is out of reach: the arm is {arm.missing:.2f} m too short, even from where "
            f"one stands nearest to it, at {stand.place[0]:.2f} {stand.place[1]:.2f}; say a place nearer to an edge"
        )
    return stand


def _stands(task: HumanTask, place: Array) -> list[goals.Goal]:
    """Where one might stand and face a place (3,), the places that serve best first."""
    ground, taken, here = ground_of(task), standing(task), task.start.root[:2]
    shapes = np.array([shapely.Polygon(ring) for ring in ground.outlines if len(ring) > 2], dtype=object)
    others = shapes[shapely.distance(shapes, shapely.Point(place[:2])) > 0.0] if len(shapes) else shapes
    found: list[tuple[float, goals.Goal]] = []
    for away in _AWAY:
        for angle in np.linspace(0.0, 2.0 * np.pi, _DIRECTIONS, endpoint=False).tolist():
            wanted = place[:2] + away * np.array([np.cos(angle), np.sin(angle)])
            free = nearest_free(wanted, ground.outlines, _CLEAR)
            way = place[:2] - free
            length = float(np.linalg.norm(way))
            stand = goals.Goal(free, float(np.arctan2(way[1], way[0])))
            near = any(float(np.linalg.norm(free - other.place)) < _SAME for _, other in found)
            if length > _FARTHEST or near or is_taken(stand, taken):
                continue
            cost = 3.0 * abs(length - _AWAY[0]) + _A_METRE * float(np.linalg.norm(free - here))
            if len(others):
                cost += _BETWEEN * bool(shapely.intersects(others, shapely.LineString([free, place[:2]])).any())
            found.append((cost, stand))
    return [stand for _, stand in sorted(found, key=lambda one: one[0])]
