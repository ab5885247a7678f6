"""Sitting down on a seat, and standing up from it.

The feet stay. The trunk leans before the knees bend far, the hips go back and down with the weight over the feet until
the seat bears them, and the trunk comes up; standing up is the same in reverse order, a little quicker. Who stands
elsewhere goes to the object's site `stand` first. Who is to stand up from castors, and has no room, rolls back first.
Where something stands close before the seat one leans less, the hips
going back sooner; where that does not help it is refused.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator

import numpy as np
from lowering import BORNE, Move, lowered

from ahmss.algorithm import HumanPose, HumanTask, Transform, run
from ahmss.algorithm.haste import hurried
from ahmss.body.array import Array
from ahmss.body.inverse import LEFT_FOOT, RIGHT_FOOT
from ahmss.body.links import INDEX, LINKS
from ahmss.body.quaternion import align, from_axis_angle, multiply, rotate
from ahmss.errors import AlgorithmError
from ahmss.motion.planting import feet
from ahmss.skills.begun import begun_at
from ahmss.skills.castors import rolled_to
from ahmss.skills.meanwhile import waited
from ahmss.skills.near_shapes import Faces
from ahmss.skills.rising import at_ease_at, at_ease_on, drawn_in, risen
from ahmss.skills.seat_room import in_its_room
from ahmss.skills.seat_ways import AT_EASE, REACH, Manner, lacking, roomiest
from ahmss.skills.sitting import Seated, heading_of, must_stand, seat_of
from ahmss.skills.stepping import IMPORTANCE, Stance, ground_of, stepped, until_free, walk_library
from ahmss.skills.word import closed_at_last
from ahmss.walking.goals import Goal, facing_of
from ahmss.walking.library import BODY
from ahmss.walking.obstacles import Obstacles

DOWN, UP = 2.1, 1.8  # seconds: sitting down takes 10 to 20 % longer than standing up
# The hips' height over what bears them, of the hip joints' distance from the middle: who is wide there is thick there.
OVER_SEAT = 1.415
NEAR, MOST, ASIDE = (0.06, np.radians(6.0)), 12.0, 0.15  # metres and radians: who stands so is not moved; metres walked
BACK, ROOM = (0.0, *np.arange(0.1, 1.0, 0.1).tolist()), 0.32  # metres rolled back to stand up; that are free then
TAKEN = 0.35  # metres from the seat's middle: who is so near is on it
RECLINES = np.radians(4.0)  # of the trunk on the seat
FORWARD, UPWARD, LEFTWARD = np.eye(3)[0], np.eye(3)[2], np.eye(3)[1]
TURNS = 12  # frames to a standstill of who sits down, before they rise again


def sit(task: HumanTask) -> Iterator[Array | HumanPose]:
    """Frames (n, 260): down onto the seat, or up from it."""
    if task.site is None or task.object is None:
        raise AlgorithmError("sit needs a site: the seat, its x where a sitter looks")
    if task.parameter("up", False):
        yield from _up(task)
        return
    task = yield from risen(task, IMPORTANCE, task.busy)
    assert task.site is not None
    assert task.object is not None
    if task.start.root[2] < task.site.place[2] + 2.0 * _thick(task):
        raise AlgorithmError(must_stand(task, "sit down"))
    walk_library(task)
    stand = task.object.site("stand", task.start.root)
    if taken := in_its_room(task, task.object):
        told = f"{_name(task)} is drawn up to {taken}, there is no room to sit down on it; {_make_room(task)}"
        raise AlgorithmError(told)
    yield from _manner(task, _at_ease(task, stand))
    goal = Goal(stand.place[:2], facing_of(stand.rotation))
    yield from _free(task, Stance(task.start.rotations, task.start.root))
    stance = yield from stepped(task, goal, ground_of(task), near=NEAR, most=MOST, to=task.object.name)
    yield from _free(task, stance)
    task = yield from drawn_in(begun_at(task, stance.rotations, stance.root), IMPORTANCE, task.busy)
    stance = Stance(task.start.rotations, task.start.root)
    manner = yield from _manner(task, stance)
    yield from _down(task, stance, manner)


def _manner(task: HumanTask, stance: Stance) -> Generator[Array, None, Manner]:
    """How one comes down from a stance, after frames (1, 260) of thinking where something stands close.

    Raises:
        AlgorithmError: however one does, there is no room; says before what, and how much is lacking.
    """
    assert task.object is not None
    faces = Faces.about(task, stance.root[:2], REACH, but=task.object)
    if not len(faces.triangles):
        return AT_EASE
    still = _still(task)
    found, _ = yield from waited(roomiest(task.human, lambda manner: _on(task, stance, manner), faces), still)
    if not found.fits:
        ahead = rotate(from_axis_angle(UPWARD, _seat(task)[0]), FORWARD)
        lacks, _ = yield from waited(lacking(found, faces, ahead), still)
        raise AlgorithmError(
            f"{_name(task)} stands too close to {found.thing}, sitting down on it takes {100.0 * lacks:.0f} cm more; "
            f"{_make_room(task)}"
        )
    return found.manner


def _at_ease(task: HumanTask, stand: Transform) -> Stance:
    """How one will have come to stand before the seat."""
    ease = at_ease_at(task, stand)
    held = [i for i, link in enumerate(LINKS) if link.startswith(tuple(task.busy)) and link.endswith(("arm", "hand"))]
    ease.rotations[held] = task.start.rotations[held]
    return Stance(ease.rotations, ease.root)


def _on(task: HumanTask, stance: Stance, manner: Manner) -> tuple[Array, Array]:
    """Poses (n, 43, 4), (n, 3) of who goes down from a stance."""
    frames = round(DOWN * task.rate)
    move = Move(stance, _seated(task, stance), *_seat(task), manner)
    return _poses(lowered(task, move, stance, np.arange(frames + 1) / frames))


def _poses(rows: Array) -> tuple[Array, Array]:
    """The rotations (n, 43, 4) and roots (n, 3) of POSE rows."""
    return rows[:, 4:176].reshape(-1, 43, 4), rows[:, 1:4]


def _still(task: HumanTask) -> Array:
    """A frame (1, 260) in which one stays as one is."""
    rotations, root = task.start.rotations, task.start.root
    targets = np.zeros((1, 5, 8))
    targets[0, RIGHT_FOOT : LEFT_FOOT + 1, :7], targets[0, RIGHT_FOOT : LEFT_FOOT + 1, 7] = (
        feet(task.human, rotations, root),
        1.0,
    )
    return task.block(rotations[None], root[None], IMPORTANCE[None], targets)


def _make_room(task: HumanTask) -> str:
    """What to do where there is no room before the seat."""
    assert task.object is not None
    return f"`do {_name(task)} draw_out` first" if Seated(task.object).castors else "move one of them first"


def _free(task: HumanTask, stance: Stance) -> Iterator[Array]:
    """Frames of standing while somebody else is on the seat."""
    seat = _seat(task)[1].place[:2]
    told = f"is where one sits on {_name(task)}; take another seat, or ask them to move"
    return until_free(task, stance, lambda place: float(np.linalg.norm(place - seat)) < TAKEN, told)


def _down(task: HumanTask, stance: Stance, manner: Manner) -> Iterator[Array | HumanPose]:
    """Down onto the seat; who is to come to rest before it bears them rises again."""
    frames = hurried(task, round(DOWN * task.rate))
    move = Move(stance, _seated(task, stance), *_seat(task), manner)
    time = np.arange(1, frames + 1) / frames
    rows, borne = lowered(task, move, stance, time), int(np.searchsorted(time, BORNE)) + 1
    for k in range(borne - 1):
        if task.rests:
            yield lowered(task, move, stance, _back(k / frames, 1.0 / frames))
        task.refuse_rest()
        yield rows[k : k + 1]
    yield from closed_at_last(rows[borne - 1 : borne])
    yield rows[borne:]


def _back(time: float, pace: float) -> Array:
    """Shares of the time (n) from one at which one goes on at a pace a frame, to where one turns round, and to 0."""
    turns = np.arange(TURNS, -TURNS, -1) / TURNS  # of the pace, from onward to back
    shares = time + pace * np.cumsum(turns)
    left = int(np.ceil(max(float(shares[-1]), 0.0) / pace))
    shares = np.concatenate([shares, shares[-1] - pace * np.arange(1, left + 1)])
    return np.append(shares[shares > 0.0], 0.0)


def _up(task: HumanTask) -> Iterator[Array]:
    """Raises: AlgorithmError: nobody sits there, or there is no room to stand."""
    off = task.start.root - _over(task, _seat(task)[1])
    if np.linalg.norm(off) > ASIDE:
        raise AlgorithmError(f"one must sit on {_name(task)} to stand up from it; the hips are elsewhere")
    task = yield from _rolled_back(task)
    heading, seat = _seat(task)
    frames = hurried(task, round(UP * task.rate))
    time = 1.0 - np.arange(1, frames + 1) / frames
    sits = Stance(task.start.rotations.copy(), task.start.root.copy())
    stands = at_ease_on(task, sits.rotations, sits.root)

    def rows(manner: Manner) -> Array:
        return lowered(task, Move(stands, sits, heading, seat, manner), sits, time)

    assert task.object is not None
    faces, manner = Faces.about(task, stands.root[:2], REACH, but=task.object), AT_EASE
    if len(faces.triangles):
        found, _ = yield from waited(roomiest(task.human, lambda one: _poses(rows(one)), faces), _still(task))
        manner = found.manner
    yield rows(manner)


def _rolled_back(task: HumanTask) -> Generator[Array, None, HumanTask]:
    """The task from where there is room to stand; as it is, or, of who sits on castors, after rolling back (n, 260)."""
    seat = seat_of(task)
    if seat is None or not seat.castors or task.site is None:
        return task
    start, heading = task.start, heading_of(task.start.rotations)
    ground, ahead = ground_of(task), np.array([np.cos(heading), np.sin(heading)])
    about = [ring for ring, name in zip(ground.outlines, ground.names, strict=True) if name != seat.thing.name]
    stands = at_ease_on(task, start.rotations, start.root).root[:2]
    room = [
        far for far in BACK if float(Obstacles.of(about, 0.0).clearance(stands - far * ahead).min(initial=1.0)) > ROOM
    ]
    if not about or not room or room[0] == 0.0:
        return task
    rotations, root = start.rotations, start.root
    for rows in rolled_to(task, seat, [(start.root[:2] - far * ahead, heading) for far in room]):
        rotations, root = rows[-1, 4:176].reshape(43, 4), rows[-1, 1:4]
        yield rows
    moved = begun_at(task, rotations, root)
    moved.site = Transform(task.site.place + root - start.root, task.site.rotation)
    return moved


def _seat(task: HumanTask) -> tuple[float, Transform]:
    """Which way a sitter looks, radians, and the seat in the world."""
    assert task.site is not None
    return facing_of(task.site.rotation), task.site


def _thick(task: HumanTask) -> float:
    """How high the hips are over what bears them, metres."""
    return OVER_SEAT * abs(float(task.human.offsets[INDEX["right_upper_leg"], 1]))


def _over(task: HumanTask, seat: Transform) -> Array:
    """Where the hips are (3,) of who sits."""
    return seat.place + _thick(task) * UPWARD


def _seated(task: HumanTask, stance: Stance) -> Stance:
    """The trunk upright over the seat, the head as it is, the arms hanging as they hang."""
    heading, seat = _seat(task)
    rotations, _ = task.human.upright()
    rotations = rotations.copy()
    turn = from_axis_angle(UPWARD, heading)
    rotations[0] = multiply(turn, rotations[0])
    reclined = from_axis_angle(rotate(turn, LEFTWARD), -RECLINES)
    rotations[0] = align(multiply(reclined, rotations[0]), stance.rotations[0])
    kept = [i for i, link in enumerate(LINKS) if i >= BODY or link.endswith(("arm", "hand"))]
    rotations[kept] = stance.rotations[kept]
    return Stance(align(rotations, stance.rotations), _over(task, seat))


def _name(task: HumanTask) -> str:
    return "it" if task.object is None else task.object.name


if __name__ == "__main__":
    run(sit)
