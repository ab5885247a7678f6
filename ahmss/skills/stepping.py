"""Steps on the floor as frames of a task: what walking is made of, and a step or two for who stands a little elsewhere.

What the shipped algorithms that take the body somewhere share, and an author may use.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import shapely

from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import LEFT_FOOT, RIGHT_FOOT
from ahmss.body.links import LINKS
from ahmss.errors import AlgorithmError
from ahmss.motion.planting import feet
from ahmss.motion.way import staying
from ahmss.skills.giving_way import points_of
from ahmss.skills.load import with_load
from ahmss.skills.out_of_reach import walk_there
from ahmss.skills.rising import crouches, risen
from ahmss.skills.sitting import must_stand, stands
from ahmss.skills.tucking import Tucking
from ahmss.walking.goals import Goal
from ahmss.walking.journey import Standing, footing
from ahmss.walking.library import Library
from ahmss.walking.pieces import LOOKS
from ahmss.walking.standing_room import Room
from ahmss.walking.trip import Ground, Piece, Trip, Walker

__all__ = [
    "IMPORTANCE", "Stance", "end_of", "ground_of", "in_hands", "in_the_way", "in_time", "rows_of", "stepped",
    "until_free", "walk_library", "walkers",
]  # fmt: skip

_FEET = slice(2, 4)
_CARES = {
    "hips": 1.0, "upper_leg": 1.0, "lower_leg": 1.0, "foot": 1.0, "spine": 0.4, "head": 0.08, "upper_arm": 0.15,
    "lower_arm": 0.15, "hand": 0.15,
}  # fmt: skip
_MISSED = 3  # frames for which who moves may not have been seen
_HUNG = 0.1  # seconds for which nothing is heard of who goes: they hang
_OUT = np.array([[1.0, 1.0, 1.0], [1.0, 1.0, -1.0], [1.0, -1.0, 1.0], [1.0, -1.0, -1.0]])  # ways to its corners
_OUT_FROM, _LESS = 0.45, 0.35  # metres from a body to fingers that are held out; by which one keeps nearer to them
_PATIENCE = 15.0  # seconds that one stands and waits for others to go


@dataclass(frozen=True, eq=False)
class Stance:
    """Where a body has come to: rotations (43, 4), root (3,)."""

    rotations: Array
    root: Array


def walk_library(task: HumanTask) -> Library:
    """The action's walk library.

    Raises:
        AlgorithmError: it names none; or the human neither stands nor crouches.
    """
    if task.library is None:
        raise AlgorithmError("walking needs a walk library as the action's motion; make one with `ahmss walk build`")
    if not stands(task) and not crouches(task):
        raise AlgorithmError(must_stand(task, "walk"))
    return task.library


def ground_of(task: HumanTask) -> Ground:
    """The footprints of all that stands about; without the parts of what stands where the human does: out of that one
    goes, whatever is on it.
    """
    things = [thing for thing in (*task.world.values(), task.object) if thing is not None and thing.kind != "human"]
    shapes = [(ring, thing.name, _top(thing)) for thing in things for ring in thing.occupied]
    left = tuple(f"{name}/" for ring, name, _ in shapes if _contains(ring, task.start.root[:2]))
    shapes = [shape for shape in shapes if not shape[1].startswith(left)] if left else shapes
    return Ground([ring for ring, _, _ in shapes], [name for _, name, _ in shapes], [top for _, _, top in shapes])


def in_hands(task: HumanTask) -> dict[str, Array]:
    """The outermost points (n, 3) of what each hand holds, in the hand's frame."""
    found: dict[str, Array] = {}
    for side in task.busy:
        points, _ = points_of(task, side, task.in_hand(side))
        if len(points):
            ends = np.concatenate([(points @ _OUT.T).argmax(axis=0), (points @ _OUT.T).argmin(axis=0)])
            found[side] = points[np.unique(ends)]
    return found


def in_the_way(task: HumanTask) -> list[Walker]:
    """Who else is on the floor now, and the arms that those who stand hold out, where algorithm.toml asks for `arms`.

    Of an arm one keeps less far than of a body: it is told as if somebody stood so far nearer to whose it is.
    """
    there = walkers(task)
    arms = [_held_out(human, walker) for human, walker in zip(_others(task), there, strict=True)]
    return [*there, *itertools.chain(*arms)]


def _held_out(human: WorldObject, walker: Walker) -> Iterator[Walker]:
    """What the arms of who stands take up of the floor beside them."""
    if not walker.stays or "right_fingers" not in human.sites:
        return
    for side in ("right", "left"):
        off = human.site(f"{side}_fingers", human.place).place[:2] - walker.place
        out = float(np.linalg.norm(off))
        if out > _OUT_FROM:
            place = walker.place + (1.0 - _LESS / out) * off
            yield Walker(place, np.zeros(2), name=walker.name, way=staying(place))


def _others(task: HumanTask) -> list[WorldObject]:
    return [human for human in task.world.values() if human.kind == "human"]


def walkers(task: HumanTask) -> Sequence[Walker]:
    """Who else is on the floor now, and where they go; nobody where algorithm.toml does not ask for `humans`.

    What they tell of where they will be comes only where it asks for `ways`, and is believed as long as they go: who
    tells that they move, and is heard of no more, has lost its main or waits for it, and stands.
    """
    found: list[Walker] = []
    for human in _others(task):
        k, faces = float(task.present.k), 2.0 * np.arctan2(human.rotation[3], human.rotation[0])
        seen = [*human.seen] if human.seen and human.seen[-1][0] > k - _MISSED else []
        track = np.array([*seen, (k, *human.place[:2], faces)] if not seen or seen[-1][0] < k else seen)
        walker = partial(Walker.of, track[:, 0] / task.rate, track[:, 1:3], human.name, track[:, 3])
        told = walker(human.way)
        found.append(told if told.stays or k - human.heard <= _HUNG * task.rate else walker())
    return found


def _contains(ring: Array, place: Array) -> bool:
    """Whether a place (2,) is within a ring (k, 2)."""
    if len(ring) < 3 or (place < ring.min(axis=0)).any() or (place > ring.max(axis=0)).any():
        return False
    return bool(shapely.contains_xy(shapely.Polygon(ring), *place))


def _top(thing: WorldObject) -> float:
    """How high a thing reaches, metres; infinite where it does not say its size."""
    size = thing.properties.get("size")
    if isinstance(size, (list, tuple)) and len(size) == 3:
        return float(thing.place[2]) + float(size[2])
    return np.inf


def rows_of(task: HumanTask, piece: Piece) -> Array:
    """POSE rows (n, 272): the feet as targets, so that they stand whatever the walk is blended with; with the ways.

    Arms between whose hands something is held stay as they are against the trunk.
    """
    n = len(piece.root)
    rotations = np.repeat(task.start.rotations[None], n, axis=0)
    rotations[:, : piece.rotations.shape[1]] = piece.rotations
    targets = np.zeros((n, 5, 8))
    targets[:, _FEET, :3], targets[:, _FEET, 3:7], targets[:, _FEET, 7] = piece.ankles, piece.feet, 1.0
    importance = IMPORTANCE.copy()
    if task.between:
        importance[_held(task)] = 0.0
    return task.block(rotations, piece.root, np.repeat(importance[None], n, axis=0), targets, piece.ways)


def in_time(piece: Piece, rows: Array) -> Generator[Array, None, int]:
    """The rows (n, 272) of a piece, singly as long as there is something to be thought of meanwhile: no frame waits.

    Where the piece wants to look, a few at a time; returns how many were given until it was over.
    """
    k = 0
    while piece.meanwhile is not None and k < len(rows) - 1:
        yield rows[k : k + 1]
        k += 1
        if not piece.meanwhile.part():
            break
    for seen in LOOKS if piece.look is not None else ():
        if seen >= len(rows):
            break
        yield rows[k:seen]
        k = seen
        if piece.look is not None and piece.look(k):
            return k
    yield rows[k:]
    return len(rows)


def stepped(
    task: HumanTask, goal: Goal, ground: Ground, *, near: tuple[float, float], most: float, to: str
) -> Generator[Array, None, Stance]:
    """Frames of the steps to a place that is near, none where one stands there; then how one stands.

    A hand that holds something stays as it is against the trunk, others are drawn in beside things. Who crouches stands
    up first. Who else is there is gone round, or waited for.

    Args:
        task: whose human stands.
        goal: where, and which way to face.
        ground: what stands on the floor.
        near: metres and radians that one may stand beside it. most: metres that are stepped.
        to: what one steps to, for the sentence that refuses.

    Raises:
        AlgorithmError: it is too far, or somebody stands in the way; says what to do.
        Rested: one was to come to rest, and stands.
    """
    library = walk_library(task)
    task = yield from risen(task, IMPORTANCE, task.busy)
    start = task.start
    goal = Goal(with_load(task, Room(goal.place), goal.facing, ground).place, goal.facing)
    standing = Standing.of(task.human, library)
    now = footing(task.human, start.rotations, start.root, standing)
    away = float(np.linalg.norm(goal.place - now.place))
    turn = 0.0 if goal.facing is None else abs((goal.facing - now.heading + np.pi) % (2.0 * np.pi) - np.pi)
    if away <= near[0] and turn <= near[1]:
        return Stance(start.rotations.copy(), start.root.copy())
    if away > most:
        raise AlgorithmError(f"{to} is {away:.1f} m from here; {walk_there(task, to)}")
    stance, held = Stance(start.rotations.copy(), start.root.copy()), _held(task)
    tucking = Tucking(task, others=partial(in_the_way, task))
    trip = Trip(
        task.human, library, ground, goal.place, goal.facing, others=partial(in_the_way, task), note=task.note,
        held=task.busy, rests=lambda: task.rests, things=in_hands(task),
    )  # fmt: skip
    task.refuse_rest()
    for piece in trip.pieces(start.rotations, start.root):
        rows = rows_of(task, piece)
        rows[:, [176 + i for i in held]] = 0.0  # POSE: k, root, 43 rotations, then the importances
        rows = tucking.over(rows)
        shown = yield from in_time(piece, rows)
        tucking.keep(shown)
        stance = end_of(task, rows[:shown])
    task.refuse_rest()
    return stance


def end_of(task: HumanTask, rows: Array) -> Stance:
    """How one stands at the end of steps (n, 260): arms whose hands hold something as they were."""
    rotations, held = rows[-1, 4:176].reshape(43, 4).copy(), _held(task)
    rotations[held] = task.start.rotations[held]
    return Stance(rotations, rows[-1, 1:4].copy())


def until_free(task: HumanTask, stance: Stance, hinders: Callable[[Array], bool], told: str) -> Iterator[Array]:
    """Frames (1, 272) of standing for as long as somebody else is in the way.

    Args:
        task: whose algorithm.toml asks for `humans`. stance: how one stands.
        hinders: whether who is at a place (2,) is in the way.
        told: what is said of who stays there, after their name; says what to do.

    Raises:
        AlgorithmError: they stay, or the motion has a number of frames, in which nobody can wait for them.
        Rested: one was to come to rest, and stands.
    """
    targets = np.zeros((1, 5, 8))
    targets[0, RIGHT_FOOT : LEFT_FOOT + 1, :7] = feet(task.human, stance.rotations, stance.root)
    targets[0, RIGHT_FOOT : LEFT_FOOT + 1, 7] = 1.0
    importance = IMPORTANCE.copy()
    importance[_held(task)] = 0.0
    waited = 0
    while there := [other for other in walkers(task) if hinders(other.place)]:
        task.refuse_rest()
        if task.length or waited >= _PATIENCE * task.rate:
            raise AlgorithmError(f"{there[0].name or 'somebody'} {told}")
        if not waited:
            task.note(f"waits for {there[0].name or 'somebody'}, who {told.partition(';')[0]}")
        yield task.block(stance.rotations[None], stance.root[None], importance[None], targets, staying(stance.root[:2]))
        waited += 1


def _held(task: HumanTask) -> list[int]:
    """The links of arms whose hands hold something."""
    return [i for i, link in enumerate(LINKS) if link.startswith(tuple(task.busy)) and link.endswith(_ARM)]


def _importance() -> Array:
    """How much each joint, and the root, matters (44,): legs and pelvis all, arms little, the head less."""
    out = np.zeros(len(LINKS) + 1)
    for i, link in enumerate(LINKS[:15]):
        out[i] = _CARES[link.removeprefix("right_").removeprefix("left_")]
    out[-1] = 1.0
    return out


IMPORTANCE = _importance()
_ARM = ("upper_arm", "lower_arm", "hand")
