"""Coming to stand before another human, and going on from there as from the beginning of a motion."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from functools import partial

import msgspec
import numpy as np
import shapely
from numpy.typing import NDArray

from ahmss.algorithm.messages import ObjectRecord, PoseRecord
from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.pose import HumanPose
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE, LEFT_FOOT, RIGHT_FOOT
from ahmss.body.links import INDEX, LINKS
from ahmss.body.quaternion import align, rotate, slerp
from ahmss.errors import AlgorithmError
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.edit import floor_frame
from ahmss.motion.planting import feet
from ahmss.skills.at_ease import at_ease
from ahmss.skills.company import Watching, aside_of, settled
from ahmss.skills.keeping import kept_clear
from ahmss.skills.reaching import HEAD
from ahmss.skills.sitting import seat_of, seat_under
from ahmss.skills.stepping import ground_of, in_time, rows_of, walk_library, walkers
from ahmss.skills.tucking import Tucking
from ahmss.skills.who_sits import OUT_OF_REACH, until_they_come, views
from ahmss.walking.obstacles import Obstacles
from ahmss.walking.trip import Trip

__all__ = ["FACING", "HANDING", "again", "come_to", "go_to"]

HANDING = (0.85, 1.05, 1.2)
"""Metres between two who hand something over: the least that will do, what is aimed at, the most that will do."""

FACING = np.radians(25.0)
"""How far aside somebody may be whom one still faces."""

_STANDS = (40, 0.03)  # frames, metres: who has moved no more than that stands
_LOOKS, _WAITS = 3.3, 12.0  # seconds that one looks whether they come, who look a while as well; until they stand
_GLANCE = 10  # frames in which one sees whether they walk
_BESIDE = np.radians([40.0, 125.0])  # to the side, of who stands beside one
_AT_SIDE = np.radians([90.0, 75.0, 105.0, 60.0])  # from where they face, to their side
_HALF_TURNED = np.radians(25.0)  # to each other, of two who stand side by side
_AT, _ALMOST = 0.1, 0.1  # metres: who is so near a place is there; that who comes to who sits may stop farther off
_TRIES = 3  # who comes to somebody who walks meanwhile comes after them
_ROOM = 0.26  # metres from things on the floor to the middle of who stands before somebody
_ABOUT = np.radians([0.0, *(side * aside for aside in range(10, 181, 10) for side in (1.0, -1.0))])
_ARM = ("upper_arm", "lower_arm", "hand")


def come_to(
    task: HumanTask,
    whom: WorldObject,
    apart: tuple[float, float, float],
    *,
    beside: bool = False,
    courteous: bool = True,
) -> Iterator[Array | HumanPose]:
    """The frames in which one comes to stand before somebody and faces them; none where one does already.

    Who sits is come to from before them, and comes to nobody: they wait for the other. Who walks is waited for until
    they stand. Of two who would come to each other at once one looks first whether the
    other sets out, as where they stand decides, which both see. A hand that holds something stays as it is against the
    trunk.

    Args:
        task: with a walk library as the action's motion.
        whom: to whom.
        apart: metres between the two: the least that will do, what is aimed at, the most that will do.
        beside: side by side with them instead, looking the same way.
        courteous: look first whether they come.

    Raises:
        AlgorithmError: there is no way, or one who sits waits in vain; says who is to do what. Rested: one was to come
            to rest.
    """
    if seat_of(task) is not None:
        yield from until_they_come(task, whom, apart[2] + _ALMOST, beside=beside, handing=apart == HANDING)
        return
    for _ in range(_TRIES):
        if _is_there(task, whom, apart, beside=beside):
            return
        if not apart[0] <= _distance(task, whom) <= apart[2]:
            yield from _look_first(task, whom, apart, beside=beside, courteous=courteous)
            if _is_there(task, whom, apart, beside=beside):
                return
        place, facing = _goal(task, whom, apart, beside=beside)
        if _stands_at(task, place) and abs(aside_of(task, whom.place)) <= FACING and not beside:
            return  # there is no better place before who sits
        yield from _gone(task, place, facing)
        task.refuse_rest()


def _gone(task: HumanTask, place: Array, facing: float) -> Iterator[Array]:
    """The frames of a walk to a place (2,), hands and what they hold kept out of things by the way."""
    begun = again(task)
    begun.present = task.present  # which goes on
    return kept_clear(begun, _walked(task, Tucking(begun, others=partial(walkers, task)), place, facing))


def _walked(task: HumanTask, tucking: Tucking, place: Array, facing: float) -> Iterator[Array]:
    """The frames of the walk, arms whose hands hold something as they were."""
    held = [i for i, link in enumerate(LINKS) if link.startswith(tuple(task.busy or "-")) and link.endswith(_ARM)]
    trip = Trip(
        task.human, walk_library(task), ground_of(task), place, facing, others=partial(walkers, task),
        note=task.note, rests=lambda: task.rests,
    )  # fmt: skip
    for piece in trip.pieces(task.present.rotations.copy(), task.present.root.copy()):
        rows = rows_of(task, piece)
        rows[:, [176 + i for i in held]] = 0.0  # POSE: k, root, 43 rotations, then the importances
        shown = yield from in_time(piece, tucking.over(rows))
        tucking.keep(shown)


def _distance(task: HumanTask, whom: WorldObject) -> float:
    here, _ = floor_frame(task.present.rotations, task.present.root)
    return float(np.hypot(*(whom.place - here)[:2]))


def _stands_at(task: HumanTask, place: Array) -> bool:
    here, _ = floor_frame(task.present.rotations, task.present.root)
    return float(np.hypot(*(place - here[:2]))) < _AT


def _in_view(task: HumanTask, whom: WorldObject) -> bool:
    """Whether they stand, or have one before them as they sit."""
    here, _ = floor_frame(task.present.rotations, task.present.root)
    return seat_under(task, whom) is None or int(views(whom, here[None, :2])[0]) == 0


def _is_there(task: HumanTask, whom: WorldObject, apart: tuple[float, float, float], *, beside: bool) -> bool:
    """Whether one stands as one should to them."""
    aside = abs(aside_of(task, whom.place))
    faces = _BESIDE[0] <= aside <= _BESIDE[1] if beside else aside <= FACING and _in_view(task, whom)
    return faces and apart[0] <= _distance(task, whom) <= apart[2]


def _goal(
    task: HumanTask, whom: WorldObject, apart: tuple[float, float, float], *, beside: bool
) -> tuple[Array, float]:
    """Where to stand (2,), and which way to face."""
    here, _ = floor_frame(task.present.rotations, task.present.root)
    way = (whom.place - here)[:2]
    if beside:
        return _at_side(task, whom, way, apart)
    near = apart[0] <= float(np.hypot(*way)) <= apart[2] and _in_view(task, whom)
    place = here[:2] if near else _before(task, whom, way, apart)
    return place, float(np.arctan2(*(whom.place[:2] - place)[::-1]))


def _at_side(task: HumanTask, whom: WorldObject, way: Array, apart: tuple[float, float, float]) -> tuple[Array, float]:
    """The place (2,) beside somebody, at their nearer side where that is free, and which way one faces.

    Raises:
        AlgorithmError: there is no room at either side; says what stands there.
    """
    heading = 2.0 * float(np.arctan2(whom.rotation[3], whom.rotation[0]))
    left = rotate(whom.rotation, np.array([0.0, 1.0, 0.0]))[:2]
    nearer = -1.0 if float(left @ way) > 0.0 else 1.0
    sides, aways, asides = (
        grid.ravel() for grid in np.meshgrid([nearer, -nearer], _aimed_first(apart), _AT_SIDE, indexing="ij")
    )
    places = _about(whom.place[:2], aways, heading + sides * asides)
    hinders, names = _hinder(task, whom.place[:2], places)
    free = np.asarray(~hinders.any(axis=0))
    if not free.any():
        there = " and ".join(dict.fromkeys(names[i] for i in np.flatnonzero(hinders.any(axis=1)).tolist()))
        raise AlgorithmError(
            f"there is room at neither side of {whom.name}, {there} being there; talk face to face, or move that"
        )
    chosen = int(np.argmax(free))
    return places[chosen], heading - float(sides[chosen]) * _HALF_TURNED


def _before(task: HumanTask, whom: WorldObject, way: Array, apart: tuple[float, float, float]) -> Array:
    """The place (2,) from which one faces somebody, on the way (2,) to them, or about them where that is taken.

    To who sits it is before them, or aside where nothing before them is free. Where no place is free about who stands,
    that on the way: who goes there says what is in it.

    Raises:
        AlgorithmError: there is room nowhere before who sits; says what stands there.
    """
    first, sits = float(np.arctan2(-way[1], -way[0])), seat_under(task, whom)
    aways, asides = (grid.ravel() for grid in np.meshgrid(_aimed_first(apart), first + _ABOUT, indexing="ij"))
    places = _about(whom.place[:2], aways, asides)
    if sits is not None:
        seen = views(whom, places)
        places = places[np.argsort(seen, kind="stable")][: int((seen < OUT_OF_REACH).sum())]
    hinders, names = _hinder(task, whom.place[:2], places)
    free = ~hinders.any(axis=0)
    if free.any():
        return places[np.argmax(free)]
    if sits is not None:
        there = ", ".join(dict.fromkeys(names[i] for i in np.flatnonzero(hinders.any(axis=1)).tolist()))
        raise AlgorithmError(
            f"there is room nowhere before {whom.name}, who sits on {sits.name}, {there} being there; "
            f"ask {whom.name} to stand up, by `do {sits.name} stand_up`, or move that"
        )
    return whom.place[:2] - apart[1] * way / max(float(np.hypot(*way)), 1e-6)


def _aimed_first(apart: tuple[float, float, float]) -> list[float]:
    return [apart[1], apart[0], apart[2]]


def _about(whom: Array, aways: Array, angles: Array) -> Array:
    """Places (n, 2) so many metres (n) from somebody (2,), in these directions (n), radians."""
    return whom + aways[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=-1)


def _hinder(task: HumanTask, whom: Array, places: Array) -> tuple[NDArray[np.bool_], Sequence[str]]:
    """Which things (m) take the room of places (n, 2), or are between these and somebody (2,), (m, n); their names."""
    ground = ground_of(task)
    around = Obstacles.of(ground.outlines, 0.0, names=ground.names)
    shapes = around.shapes[:, None]
    apart = shapely.distance(shapes[:, 0], shapely.Point(whom)) > 0.0  # who sits is within a chair
    lines = shapely.linestrings(np.stack([np.broadcast_to(whom, places.shape), places], axis=1))
    between = shapely.intersects(shapes, lines) & apart[:, None]
    return np.asarray((shapely.distance(shapes, shapely.points(places)) < _ROOM) | between), around.names


def _look_first(
    task: HumanTask, whom: WorldObject, apart: tuple[float, float, float], *, beside: bool, courteous: bool
) -> Iterator[HumanPose]:
    """Frames in which one stands and looks at them, until they stand, or have come."""
    here, _ = floor_frame(task.present.rotations, task.present.root)
    second = courteous and seat_under(task, whom) is None and (here[0], here[1]) > (whom.place[0], whom.place[1])
    watching, track = Watching(task, whom), deque[Array](maxlen=_STANDS[0])
    importance = np.zeros(44)
    importance[INDEX["head"]] = 1.0
    for k in range(1, round(_WAITS * task.rate)):
        task.refuse_rest()
        if _is_there(task, whom, apart, beside=beside):
            return
        still = settled(track, _STANDS[0] if second else _GLANCE, _STANDS[1])
        if still and (not second or k > _LOOKS * task.rate):
            return
        if k == _GLANCE + 1:
            task.note(f"waits for {whom.name}, who may come" if second else f"waits for {whom.name}, who walks")
        targets = np.zeros((5, 8))
        targets[GAZE] = watching.gaze(0.0, 0.0, k)
        yield task.pose({}, None, importance, targets)
        track.append(np.concatenate([whom.place, whom.rotation]))  # who sets out may turn first


def go_to(task: HumanTask, rotations: Array, root: Array, seconds: float) -> Iterator[Array]:
    """The frames (n, 260) from the present pose to another one, (43, 4) and (3,), on the feet as they stand."""
    n = max(round(seconds * task.rate), 1)
    done = minimum_jerk(np.arange(1, n + 1) / n)[:, None]
    targets = np.zeros((n, 5, 8))
    targets[:, RIGHT_FOOT : LEFT_FOOT + 1, :7] = feet(task.human, task.present.rotations, task.present.root)
    targets[:, RIGHT_FOOT : LEFT_FOOT + 1, 7] = 1.0
    importance = np.ones(44)
    importance[INDEX["head"]] = HEAD
    way = slerp(task.present.rotations, align(rotations, task.present.rotations), done)
    yield at_ease(task, task.block(way, task.present.root + done * (root - task.present.root), importance, targets))


def again(task: HumanTask, **fields: object) -> HumanTask:
    """The same task as if it began now: the human and all that is known of are where they are at present.

    fields: what START shall say otherwise.
    """
    start = task.message
    pose = PoseRecord.of(task.present.rotations, task.present.root)
    goal = start.goal
    if goal.object is not None and task.goal_object is not None:
        goal = msgspec.structs.replace(goal, object=_now(goal.object, task.goal_object))
    thing = start.object
    if thing is not None and task.object is not None:
        thing = _now(thing, task.object)
    world = [_now(record, task.world[record.id]) for record in start.world if record.id in task.world]
    now = {"pose": pose, "object": thing, "goal": goal, "world": world}
    made = HumanTask(msgspec.structs.replace(start, **(now | fields)))
    made.notes, made.progress = task.notes, task.progress
    return made


def _now(record: ObjectRecord, thing: WorldObject) -> ObjectRecord:
    x, y, z = thing.place.tolist()
    w, i, j, k = thing.rotation.tolist()
    return msgspec.structs.replace(record, place=(x, y, z), rotation=(w, i, j, k))
