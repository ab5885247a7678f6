"""What is held to be read: where before the eyes it is, and the way there of the hand that holds it."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Generator

import msgspec
import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, from_matrix, multiply
from ahmss.reaching.goal import Goal
from ahmss.reaching.plan import Reaching
from ahmss.reaching.standing import Posture
from ahmss.skills.at_ease import at_ease
from ahmss.skills.meeting import again
from ahmss.skills.out_of_reach import tell_missed
from ahmss.skills.planning import planned
from ahmss.skills.reaching import Looking, performed, prisms_of

__all__ = ["before_eyes", "brought"]

_AHEAD, _UNDER = (0.36, 0.46), (0.26, 0.38)  # metres before and under the eyes where one reads
_FLAT, _ASIDE = (0.0, 0.35), (0.0, 0.08)  # how much flatter than square to the eyes; metres to the hand that holds it
_ROLLED, _SKEW = np.radians([0.0, -18.0, 18.0]), np.radians([0.0, -22.0, 22.0])  # about its way up, in its own plane
_LOOKED, _AT_ONCE = 5, 40  # every so many frames are looked at; of so many between two pauses
_HEAD = INDEX["head"]
_UP, _X = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])

Misses = Callable[[Transform, Posture], float]


def brought(task: HumanTask, side: str, misses: Misses) -> Generator[Array, None, HumanTask]:
    """Frames (n, 260) in which the hand that holds the task's object brings it before the eyes; the task as it then is.

    Args:
        task: of who reads. side: of the hand that holds it.
        misses: metres by which the other hand misses it at a frame, for who is so; 0: it may be there.

    Raises:
        AlgorithmError: the arm can't bring it there.
    """
    thing = task.message.object
    assert task.object is not None
    assert thing is not None
    held = task.start.grip(side).inverse().then(task.object.frame)
    back = held.inverse()
    reaching = Reaching(task.human, task.start.rotations, task.start.root)
    wanted, place = before_eyes(task, reaching, 1.0 if side == "left" else -1.0)
    palms = wanted.then(Transform(np.repeat(back.place[None], len(wanted.place), axis=0), back.rotation)).row()
    gaze, prisms = Looking(task, place), prisms_of(task)
    plan = yield from planned(task, reaching, Goal(place, palms={side: palms}), gaze, prisms, sides=(side,))
    missed: dict[int, float] = {}
    for i in range(0, len(palms), _LOOKED):  # leant so, the other hand comes to some of them
        if i % _AT_ONCE == 0:
            yield gaze.alone()
        missed[i] = misses(Transform(wanted.place[i], wanted.rotation[i]), plan.end)
    least = min(missed.values())
    palms = palms[[i for i, by in missed.items() if by <= least]]
    plan = yield from planned(task, reaching, Goal(place, palms={side: palms}), gaze, prisms, sides=(side,))
    made = yield from performed(task, reaching, plan, gaze, ([], np.zeros((0, 4))))
    tell_missed(task, plan)
    yield at_ease(task, task.block(made.rotations, made.root, made.importance, made.targets))
    now = task.present.grip(side).then(held)  # where its main has it may be told a frame later
    place, rotation = tuple(now.place.tolist()), tuple(now.rotation.tolist())
    return again(task, object=msgspec.structs.replace(thing, place=place, rotation=rotation))


def before_eyes(task: HumanTask, reaching: Reaching, sign: float) -> tuple[Transform, Array]:
    """The frames (n) in which a thing can be read, and the place (3,) that is looked at.

    Args:
        task: who reads. reaching: their posture. sign: 1.0 where the left hand holds it, -1.0 where the right does.
    """
    base, heading = reaching.base, reaching.heading
    ahead, right = np.array([np.cos(heading), np.sin(heading), 0.0]), np.array([np.sin(heading), -np.cos(heading), 0.0])
    places, turned = forward(base.rotations, base.root, task.human.offsets)
    eyes = Transform(places[_HEAD], turned[_HEAD]).apply(task.human.eye)
    made: list[Array] = []
    for on, down, flat, aside, roll, skew in itertools.product(_AHEAD, _UNDER, _FLAT, _ASIDE, _ROLLED, _SKEW):
        place = eyes + on * ahead - down * _UP
        z = (1.0 - flat) * (eyes - place) / np.linalg.norm(eyes - place) + flat * _UP
        z = z / np.linalg.norm(z)
        turn = from_matrix(np.stack([np.cross(right, z), right, z], axis=-1))
        turn = multiply(turn, multiply(from_axis_angle(_UP, skew), from_axis_angle(_X, roll)))
        made.append(np.concatenate([place - sign * aside * right, turn]))
    frames = Transform.of(np.array(made))
    return frames, frames.place[len(made) // 2]
