"""Walking to a place (Ichiguchi 2000, 5.3.2 and appendix A), from the clips that the action names as its motion.

The way round things, the clips, their shrinking and bending are in `ahmss.walking`; here is what of it concerns a task:
where to, what is in the way, and how much the walk cares for each joint.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from ahmss.algorithm import HumanTask, run
from ahmss.algorithm.place import WorldObject
from ahmss.body.array import Array
from ahmss.errors import AlgorithmError
from ahmss.motion.planting import feet
from ahmss.motion.way import staying
from ahmss.skills.keeping import kept_clear
from ahmss.skills.letting_down import let_down, let_down_free
from ahmss.skills.load import with_load
from ahmss.skills.rising import risen
from ahmss.skills.stepping import IMPORTANCE, ground_of, in_hands, in_the_way, in_time, rows_of, walk_library
from ahmss.skills.tucking import Tucking
from ahmss.walking.goals import REACH, Goal, beside, check_distance, check_floor, facing_of
from ahmss.walking.journey import Standing, footing, stands_at
from ahmss.walking.library import BODY, Library
from ahmss.walking.standing_room import Room, with_room
from ahmss.walking.trip import Ground, Piece, Trip

TOLD = 0.006  # metres that a place is moved: less is not told, nor done
UPRIGHT = 0.04  # metres that the hips are from where they are in standing: else one bends or leans


def walk(task: HumanTask) -> Iterator[Array]:
    """The frames of the walk, a step at a time, what hands hold kept out of things beside it."""
    return let_down_free(task, kept_clear(task, let_down(task, _walk(task))))


def _walk(task: HumanTask) -> Iterator[Array]:
    """The frames, a step at a time; who crouches stands up first."""
    library = walk_library(task)
    ground = ground_of(task)
    goal = _goal(task, ground)
    check_distance(goal.place, task.start.root[:2])
    if task.goal_place is not None and task.object is not None:
        check_floor(goal.place, _floors(task, task.object), task.object.name)
    goal = _with_room(task, goal, ground)
    task = yield from risen(task, IMPORTANCE)
    if _stands_there(task, library, goal):
        task.note("one stands there already, so no step is taken")
        yield _stays(task)
        return
    trip = Trip(
        task.human, library, ground, goal.place, goal.facing, task.length, partial(in_the_way, task),
        task.note, task.busy, lambda: task.rests, in_hands(task),
    )  # fmt: skip
    tucking = Tucking(task, others=partial(in_the_way, task))
    for piece in trip.pieces(task.start.rotations, task.start.root):
        shown = yield from in_time(piece, tucking.over(rows_of(task, piece)))
        tucking.keep(shown)


def _with_room(task: HumanTask, goal: Goal, ground: Ground) -> Goal:
    """The goal, or where beside it no part of the body is in a thing, or of what is carried; else as it is."""
    room = with_room(task.human, goal, ground) if task.goal_object is None else None
    room = with_load(task, room or Room(goal.place), goal.facing, ground)
    off = float(np.linalg.norm(room.place - goal.place))
    if off < TOLD:
        return goal
    x, y = room.place.tolist()
    task.note(f"stands at {x:.2f} {y:.2f}, {100.0 * off:.0f} cm from there, not to be in {room.beside}")
    return Goal(room.place, goal.facing)


def _floors(task: HumanTask, thing: WorldObject) -> list[Array]:
    """The outlines (4, 2) of what is walked on, and of all of its kind: none where it is no floor, but has a height."""
    found: list[Array] = []
    for floor in {other.id: other for other in (thing, *task.world.values()) if other.kind == thing.kind}.values():
        size = floor.properties.get("size")
        if isinstance(size, (list, tuple)) and len(size) == 3 and float(size[2]) == 0.0:
            corners = 0.5 * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * np.array(size, float)
            found.append(floor.frame.apply(corners)[:, :2])
    return found


def _goal(task: HumanTask, ground: Ground) -> Goal:
    """Where to: a place, or where one stands to use an object; or only which way to turn."""
    thing, place, facing = task.goal_object, task.goal_place, task.goal_facing
    root = task.start.root[:2]
    if thing is not None:
        stand = thing.sites.get("stand")
        if stand is not None and not stand.free_axis:
            both = [thing.site(name, task.start.root) for name in ("stand", "stand_back") if name in thing.sites]
            site = min(both, key=lambda site: float(np.linalg.norm(site.place[:2] - root)))
            own = facing_of(site.rotation)
            return Goal(site.place[:2], own if facing is None else facing)
        reach = REACH if stand is None else float(np.hypot(*stand.position[:2]))  # at any side
        goal = beside(thing.place[:2], root, ground.outlines, reach)
        return goal if facing is None else Goal(goal.place, facing)
    if place is not None:
        return Goal(place[:2], facing)
    if facing is None:
        raise AlgorithmError("where to? add `to X Y`, `to` and an object, or `facing` and degrees to turn on the spot")
    return Goal(root, facing)


def _stands_there(task: HumanTask, library: Library, goal: Goal) -> bool:
    """Whether the human stands upright where it shall, its feet too."""
    standing = Standing.of(task.human, library)
    root = task.start.root
    now = footing(task.human, task.start.rotations, root, standing)
    over = np.linalg.norm(root - [*now.place, standing.height])
    return bool(over < UPRIGHT) and stands_at(standing, now, goal.place, goal.facing)


def _stays(task: HumanTask) -> Array:
    """POSE rows (n, 272) of standing as one does: as many as were asked for, else two."""
    n = task.length or 2
    frames = feet(task.human, task.start.rotations, task.start.root)
    rows = [task.start.rotations[:BODY], task.start.root, frames[:, :3], frames[:, 3:], staying(task.start.root[:2])]
    return rows_of(task, Piece(*(np.repeat(row[None], n, axis=0) for row in rows)))


if __name__ == "__main__":
    run(walk)
