"""Walking to a place (Ichiguchi 2000, 5.3.2 and appendix A), from the clips that the action names as its motion.

The way round things, the clips, their shrinking and bending are in `ahmss.walking`; here is what of it concerns a task:
where to, what is in the way, and how much the walk cares for each joint.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from ahmss.algorithm import HumanTask, run
from ahmss.body.array import Array
from ahmss.body.links import LINKS
from ahmss.errors import AlgorithmError
from ahmss.motion.planting import feet
from ahmss.walking.goals import REACH, Goal, beside, check_distance, facing_of
from ahmss.walking.journey import Standing, footing, stands_at
from ahmss.walking.library import BODY, Library
from ahmss.walking.trip import Ground, Piece, Trip, Walker

FEET = slice(2, 4)
CARES = {"hips": 1.0, "upper_leg": 1.0, "lower_leg": 1.0, "foot": 1.0, "spine": 0.4, "head": 0.08}
CARES |= {"upper_arm": 0.15, "lower_arm": 0.15, "hand": 0.15}
MISSED = 3  # frames for which who moves may not have been seen
LOWEST = 0.75  # of the upright hips' height: who is lower sits or kneels
UPRIGHT = 0.04  # metres that the hips are from where they are in standing: else one bends or leans


def walk(task: HumanTask) -> Iterator[Array]:
    """The frames of the walk, a step at a time."""
    if task.library is None:
        raise AlgorithmError("walking needs a walk library as the action's motion; make one with `ahmss walk build`")
    if task.start.root[2] < LOWEST * task.human.upright()[1][2]:
        raise AlgorithmError("one must stand to walk; stand up first")
    ground = _ground(task)
    goal = _goal(task, ground)
    check_distance(goal.place, task.start.root[:2])
    if _stands_there(task, task.library, goal):
        task.note("one stands there already, so no step is taken")
        yield _stays(task)
        return
    trip = Trip(
        task.human, task.library, ground, goal.place, goal.facing, task.length, partial(_others, task),
        task.note,
    )  # fmt: skip
    for piece in trip.pieces(task.start.rotations, task.start.root):
        yield _rows(task, piece)


def _ground(task: HumanTask) -> Ground:
    """The footprints of all that stands about."""
    things = [thing for thing in (*task.world.values(), task.object) if thing is not None and thing.kind != "human"]
    shapes = [(ring, thing.name) for thing in things for ring in thing.occupied]
    return Ground([ring for ring, _ in shapes], [name for _, name in shapes])


def _goal(task: HumanTask, ground: Ground) -> Goal:
    """Where to: a place, or where one stands to use an object; or only which way to turn."""
    thing, place, facing = task.goal_object, task.goal_place, task.goal_facing
    root = task.start.root[:2]
    if thing is not None:
        stand = thing.sites.get("stand")
        if stand is not None and not stand.free_axis:
            site = thing.site("stand", task.start.root)
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
    """POSE rows (n, 260) of standing as one does: as many as were asked for, else two."""
    n = task.length or 2
    frames = feet(task.human, task.start.rotations, task.start.root)
    rows = [task.start.rotations[:BODY], task.start.root, frames[:, :3], frames[:, 3:]]
    return _rows(task, Piece(*(np.repeat(row[None], n, axis=0) for row in rows)))


def _others(task: HumanTask) -> Sequence[Walker]:
    """Who else is on the floor now, and how fast they go."""
    found: list[Walker] = []
    for human in task.world.values():
        if human.kind != "human":
            continue
        k, place = float(task.present.k), human.place[:2].copy()
        seen = [*human.seen] if human.seen and human.seen[-1][0] > k - MISSED else []
        track = np.array([*seen, (k, *place)] if not seen or seen[-1][0] < k else seen)
        found.append(Walker.of(track[:, 0] / task.rate, track[:, 1:]))
    return found


def _rows(task: HumanTask, piece: Piece) -> Array:
    """POSE rows (n, 260): the feet as targets, so that they stand whatever the walk is blended with."""
    n = len(piece.root)
    rotations = np.repeat(task.start.rotations[None], n, axis=0)
    rotations[:, : piece.rotations.shape[1]] = piece.rotations
    targets = np.zeros((n, 5, 8))
    targets[:, FEET, :3], targets[:, FEET, 3:7], targets[:, FEET, 7] = piece.ankles, piece.feet, 1.0
    return task.block(rotations, piece.root, np.repeat(IMPORTANCE[None], n, axis=0), targets)


def _importance() -> Array:
    """How much each joint, and the root, matters (44,): legs and pelvis all, arms little, the head less."""
    out = np.zeros(len(LINKS) + 1)
    for i, link in enumerate(LINKS[:15]):
        out[i] = CARES[link.removeprefix("right_").removeprefix("left_")]
    out[-1] = 1.0
    return out


IMPORTANCE = _importance()

if __name__ == "__main__":
    run(walk)
