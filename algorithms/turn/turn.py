"""Turning a lever: thumb and fingers take it, go with it about the object's axis, and let it go.

The reach is that of `reach`, the grip that of `grasp` at a site with a precision grip: the hand comes along its x,
thumb and fingers close along its z. The palm turns half as far as the lever, which turns between the pads.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from ahmss.algorithm import HumanTask, Transform, run
from ahmss.algorithm.reaching import Looking, performed, planned, prisms_of, sides_of
from ahmss.body.array import Array
from ahmss.body.links import fingers
from ahmss.body.quaternion import from_axis_angle, multiply, rotate, slerp
from ahmss.errors import AlgorithmError
from ahmss.grasping.hand import Hand
from ahmss.grasping.holding import Holding, opener
from ahmss.grasping.precision import precision
from ahmss.motion.easing import minimum_jerk
from ahmss.reaching.goal import Goal
from ahmss.reaching.performing import Performed
from ahmss.reaching.plan import Reaching
from ahmss.reaching.pointing import palms_pointing

BEFORE = 0.07  # metres before the lever at which the open hand is set, and to which it goes back
COMES, CLOSES, TURNS, OPENS, LEAVES, RETURNS = 0.3, 0.25, 0.75, 0.2, 0.35, 0.4  # seconds
GOES_OVER = 30  # frames in which the elbow comes back to where it was at the lever
TURNS_ALONG = 0.5  # of the lever's turn that the hand makes
TILTS, ROLLS = np.radians([0.0, -20.0, 20.0, -40.0, 40.0]), np.radians([0.0, -20.0, 20.0])


@dataclass(frozen=True)
class Lever:
    """A lever in the world: pivot and axis (3,), the site where it is taken now, and the angle that it is to turn."""

    pivot: Array
    axis: Array
    site: Transform
    angle: float


def turn(task: HumanTask) -> Iterator[Array]:
    """Frames (n, 260): the hand comes, closes, turns, opens, and goes back."""
    lever, grips = _lever(task), {}
    gaze = Looking(task, lever.site.place)
    yield gaze.alone()
    for side in sides_of(task):
        grips |= _grip(task, side, lever)
        yield gaze.alone()
    if not grips:
        raise AlgorithmError(f"thumb and fingers can't close on {_name(task)} there; give the site another rotation")
    palms = {side: _tilted(lever, grip) for side, (grip, _) in grips.items()}
    reaching = Reaching(task.human, task.start.rotations, task.start.root)
    into = rotate(lever.site.rotation, np.array([1.0, 0.0, 0.0]))
    goal = Goal(lever.site.place, palms=palms)
    plan = yield from planned(task, reaching, goal, gaze, prisms_of(task), -BEFORE * into)
    side = plan.reacher.side
    palm = Transform(plan.palm[:3] + BEFORE * into, plan.palm[3:])
    _, holding = grips[side]
    then, closed = _turned(task, lever, palm, into)
    wide = opener(Hand.of(task.human, side), holding)
    links = list(fingers(side))
    made = yield from performed(task, reaching, plan, gaze, (links, wide), then)
    length = len(made.root) - len(then)
    made.rotations[length:, links] = slerp(wide, holding.shape, closed[:, None])
    yield _rows(task, made)
    yield _back(task, made, length, plan.reacher.links)


def _lever(task: HumanTask) -> Lever:
    """The lever where it stands now.

    Raises:
        AlgorithmError: the action names no site, the object has no shape, or the human is carried.
    """
    thing = task.object
    if task.site is None or thing is None or thing.shape is None:
        raise AlgorithmError("turn needs an object that has a shape, and a site where its lever is taken")
    if task.carried:
        raise AlgorithmError("a lever is turned standing; walk there first, then turn it")
    axis = np.array(thing.properties.get("axis", (0.0, 0.0, 1.0)), float)
    pivot = thing.frame.apply(np.array(thing.properties.get("pivot", (0.0, 0.0, 0.0)), float))
    axis = rotate(thing.rotation, axis / np.linalg.norm(axis))
    largest = float(thing.properties.get("largest", np.pi / 2))
    now = float(thing.states.get(task.parameter("state", "turn"), 0.0))
    to = task.parameter("to", -1.0)
    if to < 0.0:
        to = largest if now < 0.5 * largest else 0.0
    return Lever(pivot, axis, _about(pivot, axis, now, task.site), min(to, largest) - now)


def _about(pivot: Array, axis: Array, angle: float, frame: Transform) -> Transform:
    """A frame turned about an axis through a pivot."""
    turned = from_axis_angle(axis, angle)
    return Transform(pivot + rotate(turned, frame.place - pivot), multiply(turned, frame.rotation))


def _grip(task: HumanTask, side: str, lever: Lever) -> Mapping[str, tuple[Transform, Holding]]:
    """The palm and the fingers that take the lever, by side; empty where this hand can't."""
    thing = task.object
    assert thing is not None
    assert thing.shape is not None
    assert task.site is not None
    site = thing.frame.inverse().then(task.site)  # the shape has the lever where it is shut
    into = rotate(task.site.rotation, np.array([1.0, 0.0, 0.0]))
    level = palms_pointing(task.human, side, task.site.place, into)
    present = thing.frame.inverse().then(Transform.of(level[len(level) // 2]))
    holding = precision(Hand.of(task.human, side), thing.shape.field(site.place), present.row(), site.row())
    if holding is None or not holding.holds:
        return {}
    palm = task.site.inverse().then(thing.frame.then(Transform.of(holding.palm)))
    return {side: (lever.site.then(palm), holding)}


def _tilted(lever: Lever, palm: Transform) -> Array:
    """Palms (n, 7) that hold the lever between the same pads, the hand turned about it: which is easiest is chosen."""
    across = rotate(lever.site.rotation, np.array([0.0, 0.0, 1.0]))
    into = rotate(lever.site.rotation, np.array([1.0, 0.0, 0.0]))
    tilt, roll = (a.ravel() for a in np.meshgrid(TILTS, ROLLS, indexing="ij"))
    turned = multiply(from_axis_angle(across, tilt), from_axis_angle(into, roll))
    places = lever.site.place + rotate(turned, palm.place - lever.site.place)
    return np.concatenate([places, multiply(turned, palm.rotation)], axis=-1)


def _turned(task: HumanTask, lever: Lever, palm: Transform, into: Array) -> tuple[Array, Array]:
    """Palms (n, 7) from before the lever to it, with it, off it, and back to where they came from; and how far the
    fingers are closed (n), 0 to 1.
    """
    counts = [round(seconds * task.rate) for seconds in (COMES, CLOSES, TURNS, OPENS, LEAVES, RETURNS)]
    share = [minimum_jerk(np.arange(1, count + 1) / count) for count in counts]
    zero = [np.zeros(count) for count in counts]
    back = np.concatenate([1.0 - share[0], zero[1], zero[2], zero[3], share[4], zero[5] + 1.0])
    angle = lever.angle * np.concatenate([zero[0], zero[1], share[2], zero[3] + 1.0, zero[4] + 1.0, 1.0 - share[5]])
    closed = np.concatenate([zero[0], share[1], zero[2] + 1.0, 1.0 - share[3], zero[4], zero[5]])
    on_lever = palm.place - lever.site.place
    around, along = from_axis_angle(lever.axis, angle), from_axis_angle(lever.axis, TURNS_ALONG * angle)
    held = lever.pivot + rotate(around, lever.site.place - lever.pivot)
    places = held + rotate(along, on_lever) - BEFORE * back[:, None] * rotate(along, into)
    return np.concatenate([places, multiply(along, palm.rotation)], axis=-1), closed


def _back(task: HumanTask, made: Performed, length: int, arm: slice) -> Array:
    """Frames (n, 260) in which all goes back the way that it came, which is clear of things.

    The elbow may have come to another place meanwhile: the arm goes over from there.
    """
    rows = _rows(task, made)[:length][::-1]
    rotations = made.rotations[:length][::-1].copy()
    share = minimum_jerk(np.arange(1, length + 1) / GOES_OVER)[:, None]
    rotations[:, arm] = slerp(
        np.broadcast_to(made.rotations[-1, arm], rotations[:, arm].shape), rotations[:, arm], share
    )
    rows[:, 4:176] = rotations.reshape(length, 172)
    return rows


def _rows(task: HumanTask, made: Performed) -> Array:
    return task.block(made.rotations, made.root, made.importance, made.targets)


def _name(task: HumanTask) -> str:
    return "it" if task.object is None else task.object.name


if __name__ == "__main__":
    run(turn)
