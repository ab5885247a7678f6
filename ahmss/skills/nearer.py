"""Steps to where a hand comes to a place that it does not come to from here: round a table to its other side, say.

What the shipped algorithms that lay something down share, and an author may use.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import replace

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.errors import AlgorithmError
from ahmss.motion.steps import Steps
from ahmss.reaching.goal import Goal
from ahmss.reaching.leaning import Stretch
from ahmss.reaching.prism import Prism
from ahmss.reaching.reacher import SIDES
from ahmss.skills.controls import gone_to, stretch_from
from ahmss.skills.out_of_reach import MOST_MISSING
from ahmss.skills.reaching import Looking
from ahmss.skills.stands import CLEAR, FARTHEST, facing_it, stance_at, stands_at
from ahmss.skills.stepping import ground_of, walk_library
from ahmss.walking import goals
from ahmss.walking.obstacles import nearest_free

__all__ = ["gone_nearer", "said", "short_of"]

_EASY = 0.9  # of the arm's length
_LOOKED_AT = 16  # stands whose arm is looked at
_LEANT_FROM = 4  # of these, from which one leans
_MOST = 12.0  # metres that are stepped
_LOW = 0.6  # of the hips' height: what is so far under them is on the floor, or nearly
_BACK, _ON_IT = np.arange(0.05, 1.2, 0.05), 0.05  # metres towards oneself that are tried; from a top


def short_of(arm: Stretch, most: float = MOST_MISSING) -> str:
    """What an arm lacks that is too short for its place by more than so many metres, as a clause; ""."""
    return f"the arm is {max(arm.missing, 0.01):.2f} m too short" if arm.missing > most else ""


def gone_nearer(
    task: HumanTask,
    place: Array,
    goal: Callable[[float], Goal],
    gaze: Looking,
    prisms: Sequence[Prism],
    lacks: Callable[[Stretch], str] = short_of,
) -> Generator[Array, None, tuple[HumanTask, Looking]]:
    """The task from where a hand comes to a place (3,), after steps (n, 260) to there, the eyes on it if it is ahead.

    Args:
        task: with a walk library; whose hand it is.
        goal: the hand's goal there, for who faces so many radians.
        gaze: where it is on its way. prisms: what may be in the hand's way.
        lacks: what an arm lacks there, as a clause; "" where it comes there as it is to.

    Raises:
        AlgorithmError: one sits, nobody can stand where it is in reach, or gets there, or it is too far to step there;
            nobody has moved then.
    """
    walk_library(task)
    away = float(np.linalg.norm(place[:2] - task.start.root[:2]))
    if away > _MOST:
        raise AlgorithmError(f"{said(place)} is {away:.1f} m from here, too far to step there; walk to it first")
    stand = yield from gaze.during(_best(task, place, goal, prisms, lacks))
    task.note(f"goes to {stand.place[0]:.2f} {stand.place[1]:.2f}, from where the arm comes there")
    return (yield from gone_to(task, stand, gaze, "that place"))


def said(place: Array) -> str:
    """A place (2,) or (3,) as one types it."""
    return " ".join(f"{x:.2f}" for x in place.tolist())


def _best(
    task: HumanTask,
    place: Array,
    goal: Callable[[float], Goal],
    prisms: Sequence[Prism],
    lacks: Callable[[Stretch], str],
) -> Steps[goals.Goal]:
    """Where one stands: of the near places the first from which it is easy, else the best of those one leans from."""
    found: list[tuple[float, goals.Goal]] = []
    for cost, stand in stands_at(task, place)[:_LOOKED_AT]:
        assert stand.facing is not None
        arm = yield from stretch_from(task, stand, goal(stand.facing))
        if arm.found and arm.stretched < _EASY:
            return stand
        found.append((cost + arm.cost + 40.0 * max(arm.stretched - _EASY, 0.0) + (0.0 if arm.found else 20.0), stand))
        yield
    if not found:
        stand = facing_it(nearest_free(place[:2], ground_of(task).outlines, CLEAR), place)
        away = float(np.linalg.norm(place[:2] - stand.place))
        instead = yield from _instead(task, place, stand, goal, prisms, lacks)
        raise AlgorithmError(f"nobody can stand nearer to {said(place)} than {away:.2f} m; {instead}")
    nearest: tuple[float, goals.Goal, str] | None = None
    for _, stand in sorted(found, key=lambda one: one[0])[:_LEANT_FROM]:
        assert stand.facing is not None
        arm = yield from _leant(task, stand, goal(stand.facing), prisms)
        if not (lack := lacks(arm)):
            return stand
        if nearest is None or arm.stretched < nearest[0]:
            nearest = arm.stretched, stand, lack
        yield
    assert nearest is not None
    _, stand, lack = nearest
    under = float(task.start.root[2] - place[2])
    if under > _LOW * task.start.root[2]:
        where = (
            f"too low, {under:.2f} m under the hips: no arm comes there well, even from where one stands nearest to it"
        )
        raise AlgorithmError(f"{said(place)} is {where}; say a place that is higher, a table's top")
    instead = yield from _instead(task, place, stand, goal, prisms, lacks)
    raise AlgorithmError(f"{said(place)} is out of reach: {lack}, even from {said(stand.place)}; {instead}")


def _leant(task: HumanTask, stand: goals.Goal, wanted: Goal, prisms: Sequence[Prism]) -> Steps[Stretch]:
    """How the better arm of who would stand there comes to a goal, leaning."""
    leaning = stance_at(task, stand)
    sides = [side for side in SIDES if side in wanted.palms]
    _, (_, _, arm) = yield from leaning.better(wanted, sides, prisms)
    return arm


def _instead(
    task: HumanTask,
    place: Array,
    stand: goals.Goal,
    goal: Callable[[float], Goal],
    prisms: Sequence[Prism],
    lacks: Callable[[Stretch], str],
) -> Steps[str]:
    """What to say instead of a place (3,): the nearest on the same thing, towards who would stand there, that the arm
    comes to well.
    """
    assert stand.facing is not None
    wanted, back = goal(stand.facing), np.append(stand.place - place[:2], 0.0)
    under = [prism for prism in prisms if prism.over(place[None])[0] and abs(prism.high - place[2]) < _ON_IT]
    away, served = float(np.linalg.norm(back)), False
    for by in _BACK[away - _BACK < FARTHEST]:
        off = by * back / away
        if not any(prism.over((place + off)[None])[0] for prism in under):
            break
        if served:  # one step of these more: nobody stands just where they are to
            return f"the nearest place that serves is {said(place + off)}"
        palms = {side: np.concatenate([rows[:, :3] + off, rows[:, 3:]], axis=1) for side, rows in wanted.palms.items()}
        arm = yield from _leant(task, stand, replace(wanted, place=wanted.place + off, palms=palms), prisms)
        served = not lacks(arm)
        yield
    return "say a place nearer to an edge"
