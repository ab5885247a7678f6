"""Turning around on the spot to what is behind one's back, before one looks at it, waves or points.

What the shipped algorithms that are made to somebody, or at something, share, and an author may use.
"""

from __future__ import annotations

from collections.abc import Generator

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.errors import AlgorithmError
from ahmss.reaching.reacher import heading_of
from ahmss.skills.controls import gone_to
from ahmss.skills.reaching import Looking
from ahmss.skills.stepping import walk_library
from ahmss.walking.goals import Goal
from ahmss.walking.journey import Standing, footing

__all__ = ["BEHIND", "faced"]

BEHIND = np.radians(115.0)  # from straight ahead: farther round neither neck nor waist goes


def faced(task: HumanTask, place: Array, most: float, name: str) -> Generator[Array, None, HumanTask]:
    """The task from where a place is ahead, as it is or after turning to it on the spot (n, 272).

    Args:
        task: who is carried goes on as they do. place: (3,) in the world.
        most: radians that it may be aside. name: of what is there.

    Raises:
        AlgorithmError: it is farther aside, and the action has no walk library to turn by, or one sits.
    """
    aside = _aside(task, place)
    if task.carried or abs(aside) <= most:
        return task
    if task.library is None:
        raise AlgorithmError(f"{name} is {np.degrees(abs(aside)):.0f} degrees aside, behind the back; turn to it first")
    here = footing(task.human, task.start.rotations, task.start.root, Standing.of(task.human, walk_library(task)))
    off = place[:2] - here.place
    goal = Goal(here.place, float(np.arctan2(off[1], off[0])))
    task, _ = yield from gone_to(task, goal, Looking(task, place), name)
    return task


def _aside(task: HumanTask, place: Array) -> float:
    """How far a place (3,) is to the left of where one's hips face at the start, radians."""
    off, faces = place - task.start.root, heading_of(task.start.rotations, task.start.root)
    return float((np.arctan2(off[1], off[0]) - faces + np.pi) % (2.0 * np.pi) - np.pi)
