"""Pointing and calling: the arm straight, the fingertip where the aiming eye sees the target, for a second or so.

Who points at what they see brings the fingertip onto the line from the dominant eye to it (Taylor & McCloskey 1988);
the arm is straight from the shoulder to there. So the finger lies along the arm, not along the line of sight: the two
differ by what is between eye and shoulder. Nothing is touched: what is within the arm's length is pointed at from a
hand before it, the elbow then bent.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator

import numpy as np

from ahmss.algorithm import HumanTask, run
from ahmss.algorithm.haste import hurried
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.errors import AlgorithmError
from ahmss.reaching.goal import Goal
from ahmss.reaching.leaning import looking, stretch_of
from ahmss.reaching.performing import Performed, perform
from ahmss.reaching.plan import Plan, Reaching
from ahmss.reaching.pointing import palms_pointing, pointing
from ahmss.reaching.reacher import Reacher, heading_of, seat
from ahmss.reaching.standing import Posture
from ahmss.skills.box import filled
from ahmss.skills.elbow_room import awaited
from ahmss.skills.facing import faced
from ahmss.skills.reaching import Looking, prisms_of, sides_of

STRAIGHT = 0.995  # of the arm's length
BEFORE = 0.12  # metres that the fingertip stays before what is near
EYE = 0.032  # metres from between the eyes to one of them
TURNS_FROM, TURNS, BEHIND = np.radians([40.0, 45.0, 125.0])  # the trunk turns along from, up to; nobody points back
BRISK = 0.75  # of the time that a reach at ease takes: a sign is made with decision
FIRST = 3  # frames in which the motion is worked out
OVERHEAD = 0.3  # metres level: what is nearer is above or below, and behind nobody
TRIES = 4  # of aim and arm, each of which depends a little on the other


def point(task: HumanTask) -> Iterator[Array]:
    """Frames (n, 260): the eyes go there, the arm comes up, stays, and is taken down the way that it came."""
    if task.carried:
        raise AlgorithmError("one points standing; walk first, then point")
    target = _target(task)
    if float(np.hypot(*(target - task.start.root)[:2])) > OVERHEAD:
        task = yield from faced(task, target, BEHIND, task.object.name if task.object is not None else "it")
    task.arrived()
    gaze = Looking(task, target)
    yield gaze.alone()
    reaching = Reaching(task.human, task.start.rotations, task.start.root)
    side, posture, palms = _aimed(task, reaching, target)
    yield gaze.alone()
    plan = yield from _planned(task, reaching, (side, posture, palms), gaze)
    made = yield from _made(task, reaching, plan, gaze)
    if (yield from awaited(task, made, plan.reacher.side, gaze)) and made.looked < 1.0:
        made = yield from _made(task, reaching, plan, gaze)  # the eyes have gone on
    yield _rows(task, made)
    if call := task.parameter("call", ""):
        task.note(f'calls: "{call}"')
    last = _rows(task, made)[-1:]
    yield np.repeat(last, round(task.parameter("hold", 1.2) * task.rate), axis=0)
    yield _rows(task, made)[::-1]


def _target(task: HumanTask) -> Array:
    """The place (3,) that is pointed at: the goal, the action's site, or the middle of the object.

    Raises:
        AlgorithmError: there is none of these.
    """
    if task.goal_place is not None:
        return task.goal_place
    if task.site is not None:
        return task.site.place
    if task.object is None:
        raise AlgorithmError("point at what? add `to X Y Z`, or `to` and an object")
    if blocks := filled(task.object):
        rings = np.concatenate([block.ring for block in blocks])
        middle = 0.5 * (rings.min(axis=0) + rings.max(axis=0))
        return np.append(middle, 0.5 * (min(block.low for block in blocks) + max(block.high for block in blocks)))
    size = task.object.properties.get("size")
    high = float(size[2]) if isinstance(size, (list, tuple)) and len(size) == 3 else 0.0
    return task.object.frame.apply(np.array([0.0, 0.0, 0.5 * high]))


def _aimed(task: HumanTask, reaching: Reaching, target: Array) -> tuple[str, Posture, Array]:
    """The hand, the posture that the trunk turns to, and palms (n, 7) whose fingertip is on the line of sight."""
    skeleton, base = task.human, reaching.base
    off = target - base.root
    aside = (np.arctan2(off[1], off[0]) - heading_of(base.rotations, base.root) + np.pi) % (2.0 * np.pi) - np.pi
    sides = sides_of(task)
    side = sides[0] if len(sides) == 1 or aside < np.radians(25.0) else "left"
    turn = np.sign(aside) * np.clip(abs(aside) - TURNS_FROM, 0.0, TURNS)
    rotations = base.rotations.copy()
    rotations[INDEX["spine"]] = multiply(rotations[INDEX["spine"]], from_axis_angle(np.array([1.0, 0.0, 0.0]), turn))
    posture = Posture(rotations, base.root)
    reacher = Reacher.of(skeleton, side)
    seen = looking(skeleton, rotations, base.root, target)
    eye = _eye(skeleton, seen, base.root, task.parameter("eye", "right"))
    shoulder = reacher.shoulder(seat(skeleton, seen, base.root))
    return side, posture, _palms(skeleton, reacher, (eye, shoulder), target)


def _eye(skeleton: Skeleton, rotations: Array, root: Array, which: str) -> Array:
    """Where an eye is (3,), in the world: a head has x up, y to the left."""
    places, turned = forward(rotations, root, skeleton.offsets)
    aside = np.array([0.0, EYE if which == "left" else -EYE, 0.0])
    head = INDEX["head"]
    return places[head] + rotate(turned[head], skeleton.eye + aside)


def _palms(skeleton: Skeleton, reacher: Reacher, begins: tuple[Array, Array], target: Array) -> Array:
    """Palms (n, 7): the fingertip on the line from the eye, as far out as the straight arm, or before what is near."""
    eye, shoulder = begins
    sight = target - eye
    distance = float(np.linalg.norm(sight))
    sight = sight / max(distance, 1e-9)
    furthest, away = max(distance - BEFORE, 0.15), 0.6
    palms = np.zeros((0, 7))
    for _ in range(TRIES):
        tip = eye + away * sight
        into = (tip - shoulder) / np.linalg.norm(tip - shoulder)
        palms = palms_pointing(skeleton, reacher.side, tip, into, exactly=True)
        wrist = reacher.hand(palms[len(palms) // 2])[0]
        short = STRAIGHT * reacher.length - float(np.linalg.norm(wrist - shoulder))
        away = min(away + short / max(float(into @ sight), 0.3), furthest)
    return palms


def _planned(
    task: HumanTask, reaching: Reaching, aimed: tuple[str, Posture, Array], gaze: Looking
) -> Generator[Array, None, Plan]:
    """The plan: the palm that the arm takes most easily, and the way there."""
    side, posture, palms = aimed
    reacher, prisms = Reacher.of(task.human, side), prisms_of(task)
    goal = Goal(gaze.place, palms={side: palms})
    best, arm = yield from gaze.during(stretch_of(reacher, palms, posture, reaching.present(reacher), prisms))
    looked = float(gaze.turned(np.array([gaze.frames + 1]))[0])
    return (yield from gaze.during(reaching.way(reacher, (posture, palms[best], arm), goal.place, prisms, looked)))


def _made(task: HumanTask, reaching: Reaching, plan: Plan, gaze: Looking) -> Generator[Array, None, Performed]:
    """The frames in which the arm comes up, worked out in a few more of the gaze."""
    first, side = gaze.frames + gaze.left(FIRST), plan.reacher.side
    plan = reaching.set_out(plan, gaze.place, float(gaze.turned(np.array([first]))[0]))
    held = round(task.parameter("hold", 1.2) * task.rate)
    at_ease = round(BRISK * plan.seconds * task.rate)
    length = hurried(task, 2 * at_ease, first + held) // 2 if task.length else at_ease
    looked = gaze.turned(first + np.arange(1.0, length + 1.0))
    shape = list(fingers(side)), pointing(side)
    return (yield from gaze.until(first, perform(plan, np.arange(1, length + 1) / length, gaze.place, looked, shape)))


def _rows(task: HumanTask, made: Performed) -> Array:
    return task.block(made.rotations, made.root, made.importance, made.targets)


if __name__ == "__main__":
    run(point)
