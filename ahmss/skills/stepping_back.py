"""A step or two back from things for who would be in them: from before a panel, to wave or bow, say."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.reacher import SIDES, Reacher
from ahmss.reaching.skin import arm_skin
from ahmss.reaching.trunk import trunk_points
from ahmss.skills.controls import begun_at
from ahmss.skills.reaching import prisms_of
from ahmss.skills.sitting import heading_of, stands
from ahmss.skills.stands import is_taken, standing
from ahmss.skills.stepping import ground_of, stepped
from ahmss.walking.goals import Goal
from ahmss.walking.obstacles import nearest_free

__all__ = ["deep_in", "stepped_back"]

_BACK = (0.15, 0.25, 0.35, 0.5, 0.65)  # metres
_EVERY = 4  # frames
_CLEAR, _FREE = 0.26, 0.02  # metres to things on the floor; by which a place may be nearer to them
_THERE = (0.04, np.radians(6.0))  # metres, radians: that is near enough


def deep_in(task: HumanTask, rows: Array) -> float:
    """Metres by which skin of arms, trunk or head is in things at the most in POSE rows (n, 260); below 0 in none.

    As deep as it is in one before, it may be.
    """
    return _deepest(task, rows, prisms_of(task), np.zeros(3))


def _deepest(task: HumanTask, rows: Array, prisms: Sequence[Prism], off: Array) -> float:
    """The same for rows that are moved by (3,)."""
    if not prisms:
        return -np.inf
    poses, root = rows[::_EVERY, 4:176].reshape(-1, 43, 4), rows[::_EVERY, 1:4] + off
    deep, start = -np.inf, task.start
    parts = zip(_parts(task, start.rotations, start.root), _parts(task, poses, root), strict=True)
    for (before, radii), (points, _) in parts:
        most = float(radii.max())
        gap = clearance(prisms, points, most) - radii
        begun = np.minimum(clearance(prisms, before, most) - radii, 0.0)
        deep = max(deep, float((begun - gap).max()))
    return deep


def _parts(task: HumanTask, rotations: Array, root: Array) -> Iterator[tuple[Array, Array]]:
    """Points (..., m, 3) in trunk and head and in each arm of poses (..., 43, 4), and how thick skin is around (m,)."""
    yield trunk_points(task.human, rotations, root)
    for side in SIDES:
        yield arm_skin(Reacher.of(task.human, side), rotations, root)


def stepped_back(task: HumanTask, rows: Array) -> Generator[Array, None, HumanTask]:
    """The task from so far back that nothing of the body is in things in POSE rows (n, 260), after steps (n, 272).

    As it is where there is no such place, or nobody steps.
    """
    if task.library is None or task.carried or not stands(task):
        return task
    heading, ground, taken = heading_of(task.start.rotations), ground_of(task), standing(task)
    back, prisms = -np.array([np.cos(heading), np.sin(heading), 0.0]), prisms_of(task)
    for by in _BACK:
        yield task.block(task.start.rotations[None], task.start.root[None], np.zeros(44))
        place = task.start.root[:2] + by * back[:2]
        free = float(np.linalg.norm(nearest_free(place, ground.outlines, _CLEAR) - place)) < _FREE
        goal = Goal(place, heading)
        if free and not is_taken(goal, taken) and _deepest(task, rows, prisms, by * back) < 0.0:
            stance = yield from stepped(task, goal, ground, near=_THERE, most=2.0, to="there")
            return begun_at(task, stance.rotations, stance.root)
    return task
