"""What is out of reach: refused with what brings one nearer, as a person would type it; or told, by how much."""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.errors import AlgorithmError
from ahmss.reaching.leaning import Stretch
from ahmss.reaching.plan import Plan
from ahmss.skills.sitting import heading_of, must_stand, stands
from ahmss.walking.obstacles import nearest_free

__all__ = [
    "EXACT", "MOST_MISSING", "come_nearer", "refuse_far", "refuse_short", "stand_there", "tell_missed",
    "walk_there", "walk_to",
]  # fmt: skip

MOST_MISSING = 0.03
"""Metres beyond a stretched arm, or nearer than a bent one, that are still tried for, and told of."""

EXACT = 0.002
"""Metres within which fingers are at what they press, touch or hold."""

_TOLD = 0.001  # metres
_AT_IT = 0.9  # metres, level, from a thing's middle: who walks to it comes so near as a rule
_BEFORE, _CLEAR, _SAME = 0.45, 0.26, 0.15  # metres: before a place; from things; from here, where a step is none
_FACES = np.radians(60.0)  # to either side: who walks to a thing comes to face it


def refuse_far(task: HumanTask, side: str, arm: Stretch, most: float = MOST_MISSING, helps: str = "") -> None:
    """Refuse what is out of reach rather than stretch for it in the air.

    Args:
        task: whose. side, arm: how it comes there. most: metres that it may be too short.
        helps: what to do; left out: to come nearer.

    Raises:
        AlgorithmError: says by how much, and what to do.
    """
    if arm.missing <= most:
        return
    if arm.folded:
        by = f"{arm.missing:.2f} m"
        raise AlgorithmError(f"that is {by} nearer to the {side} shoulder than its elbow bends; use the other hand")
    raise AlgorithmError(
        f"the {side} arm is {arm.missing:.2f} m too short for that from here; {helps or come_nearer(task)}"
    )


def tell_missed(task: HumanTask, plan: Plan) -> None:
    """Tell by how much the hand stops short, as near as the arm comes; of the plan that is carried out in the end."""
    if plan.short > _TOLD:
        goes = "as far as the elbow bends" if plan.arm.folded else "as far as the arm goes"
        task.note(f"the {plan.reacher.side} hand stops {1000.0 * plan.short:.0f} mm short of it, {goes}")


def refuse_short(task: HumanTask, plan: Plan, off: float) -> None:
    """Refuse to press, touch or hold what fingers do not come to: they would do it beside that.

    Who uses a control has looked for another place to stand already.

    off: metres by which they are beside it as that is performed, at the most.

    Raises:
        AlgorithmError: says by how much, and what to do.
    """
    if off > EXACT:
        thing = task.object
        tried = task.library is not None and thing is not None and "box" in thing.properties
        helps = "have somebody taller do it, or move it" if tried else come_nearer(task)
        raise AlgorithmError(
            f"the {plan.reacher.side} hand stops {1000.0 * off:.0f} mm short of it, as far as the arm goes "
            f"past what is in the way from here; {helps}"
        )
    tell_missed(task, plan)


def come_nearer(task: HumanTask) -> str:
    """What to do for an arm to come there: a line to be typed where one helps."""
    if not stands(task):
        return must_stand(task, "come nearer")
    thing = _meant(task)
    if thing is None:
        return _step_nearer(task)
    way = (thing.place - task.start.root)[:2]
    aside = float(np.arctan2(way[1], way[0])) - heading_of(task.start.rotations)
    faces = abs((aside + np.pi) % (2.0 * np.pi) - np.pi) < _FACES
    if faces and float(np.hypot(*way)) < _AT_IT:
        return stand_there(task) or "stand elsewhere, or move it nearer"
    return walk_there(task, thing.name)


def stand_there(task: HumanTask) -> str:
    """What brings one as near to a thing as it is used from, at any side of it, as a line to be typed.

    "" where one stands so already, or it names no such place.
    """
    thing = _meant(task)
    site = None if thing is None else thing.sites.get("stand")
    if thing is None or site is None or not site.free_axis or not stands(task):
        return ""
    way = (task.start.root - thing.place)[:2]
    near = thing.place[:2] + float(np.hypot(*site.position[:2])) * way / max(float(np.hypot(*way)), 1e-9)
    away = float(np.linalg.norm(nearest_free(near, _rings(task), _CLEAR) - task.start.root[:2]))
    return walk_there(task, thing.name) if away > _SAME else ""


def _step_nearer(task: HumanTask) -> str:
    """What brings one nearer to a place: to where one can stand before it, on the way that one comes."""
    assert task.goal_place is not None
    place, here = task.goal_place[:2], task.start.root[:2]
    away = float(np.linalg.norm(place - here))
    stand = nearest_free(place + min(_BEFORE / max(away, 1e-9), 1.0) * (here - place), _rings(task), _CLEAR)
    if (away < _AT_IT and float(np.linalg.norm(stand - here)) < _SAME) or float(np.linalg.norm(stand - place)) > _AT_IT:
        return "say another place"
    facing = float(np.arctan2(*(place - stand)[::-1]))
    return f"{walk_to(task, stand, facing)} first"


def _rings(task: HumanTask) -> list[Array]:
    """The outlines (n, 2) of what stands on the floor."""
    return [ring for thing in task.world.values() if thing.kind != "human" for ring in thing.occupied]


def walk_to(task: HumanTask, place: Array, facing: float) -> str:
    """How one walks to a place (2,) and faces so many radians there, as it is typed."""
    return f"`do {_floor(task)} walk to {place[0]:.2f} {place[1]:.2f} facing {np.degrees(facing):.0f}`"


def walk_there(task: HumanTask, name: str) -> str:
    """How one walks to what has a name, as it is typed; else that one does."""
    known = (*task.world.values(), task.object, task.goal_object)
    names = [thing.name for thing in known if thing is not None]
    if name not in names:
        return "walk nearer first"
    return f"`do {_floor(task)} walk to {_short(name, names)}` first"


def _floor(task: HumanTask) -> str:
    """The floor, as one names it."""
    names = [thing.name for thing in (*task.world.values(), task.object) if thing is not None]
    floors = [thing.name for thing in task.world.values() if thing.kind == "floor"]
    return _short(min(floors, key=len), names) if floors else "floor"


def _meant(task: HumanTask) -> WorldObject | None:
    """The thing that the hand goes to: the one named as the goal, else the action's own; None where it is a place."""
    if task.goal_object is not None or task.goal_place is not None:
        return task.goal_object
    return task.object


def _short(name: str, names: list[str]) -> str:
    """The last part of a name where no other ends in it, else all of it."""
    last = name.rpartition("/")[2]
    same = [other for other in names if other == last or other.endswith(f"/{last}")]
    return last if len(set(same)) <= 1 else name
