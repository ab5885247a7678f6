"""Closing the hand around an object, and opening it (Ichiguchi 2000, 5.3.4).

Where the object's shape is known, the hand closes onto it as the site's `grip` says, each finger until it touches. Else
it closes about a cylinder, as in the thesis: the palm is brought onto the wall from where it is, at its height; the
thumb goes to one side, the four fingers to the other, each link by slerp to the rotation at which it touches.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import HumanPose, HumanTask, Transform, importance_of, run
from ahmss.body.array import Array
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import between, multiply, rotate, slerp
from ahmss.body.skeleton import Skeleton
from ahmss.errors import AlgorithmError
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.fingers import Cylinder, closed, opened
from ahmss.motion.steps import Steps
from ahmss.skills.at_ease import resampled, times_at_ease
from ahmss.skills.closing_carried import closing_carried
from ahmss.skills.closing_way import fingers_at, moved_at, palms_at
from ahmss.skills.free_arm import free_arm_kept_out
from ahmss.skills.grasping import Closing, closing, read_shape
from ahmss.skills.meanwhile import waited
from ahmss.skills.word import closed_at_last

TOO_FAR = 0.12  # metres between palm and wall beyond which closing the hand would catch nothing
INTO_FINGERS = 0.01  # metres by which the object lies before the palm's middle, towards the fingers
PLANNED, AT_ONCE = 0.07, 8  # share of the frames asked for that a plan may take, and parts of it made in each
OPEN_BY = 0.55  # share of the time: the opened fingers clear of the wall
GAZE = 4
SPINE = 400.0  # its importance, a thousand times a walk's: what is left to that is given back when it ends, at once


def grasp(task: HumanTask) -> Iterator[Array | HumanPose]:
    """Frames (n, 260): the hand closes, or opens and draws back; the arm follows, the rest is left alone.

    The first, in which nothing moves yet, is given as soon as the shape is read; the hand is planned after it.
    """
    side = task.hand or "right"
    time = np.arange(1, task.length + 1) / task.length
    present = task.start.rotations[list(fingers(side))]
    grip = task.start.grip(side)
    if task.parameter("open", False):
        end = Transform(grip.place + task.parameter("back", 0.06) * _back(task, grip), grip.rotation)
        shapes = slerp(present, opened(side, present[:2]), minimum_jerk(time / OPEN_BY)[:, None])
        moved = minimum_jerk((time - 0.25) / 0.75)
        places = grip.place + moved[:, None] * (end.place - grip.place)
        turned = np.repeat(grip.rotation[None], len(time), axis=0)
        yield _frames(task, side, shapes, (np.concatenate([places, turned], axis=-1), moved))
        return
    read_shape(task)
    still = _frames(task, side, present[None], (grip.row()[None], np.zeros(1)))
    if task.length > 1:
        yield still
    rows = _closes(task, side, grip, still)
    yield from closing_carried(task, side, rows) if task.carried else rows


def _closes(task: HumanTask, side: str, grip: Transform, still: Array) -> Iterator[Array | HumanPose]:
    """Frames (n, 260) of a hand that closes: those in which it is planned, still as the one (1, 260) before, and then.

    The frames of a plan are taken of those that were asked for, or come on top where their number is but a wish.
    """
    wish, before = bool(task.message.wish), len(still) if task.length > 1 else 0
    few = (None, 1) if wish else (int(PLANNED * task.length), AT_ONCE)
    end, given = yield from waited(_closing(task, side, grip), still, *few)
    length = task.length - before - (0 if wish else given)
    time = np.linspace(before / task.length, 1.0, length + 1)[1:]
    shapes = fingers_at(time, task.start.rotations[list(fingers(side))], end.shape, end.wide, end.by)
    palms = palms_at(time, grip.row(), end.palm.row(), end.out, end.by)
    rows = _frames(task, side, shapes, (palms, moved_at(time, end.by)), end.spine)
    if task.carried:
        yield from closed_at_last(rows)
        return
    if end.spine is not None:
        rows, _ = yield from waited(free_arm_kept_out(task, side, rows), still, None if wish else 0)
    yield from closed_at_last(resampled(rows, times_at_ease(task, rows, fingers(side), wish=wish)))


def _back(task: HumanTask, grip: Transform) -> Array:
    """The direction (3,) in which the opened hand is drawn back: out of a pinch, or off the wall under the palm."""
    if task.object is not None and task.site is not None and task.object.sites[task.message.site].grip == "precision":
        return rotate(task.site.rotation, np.array([-1.0, 0.0, 0.0]))
    return rotate(grip.rotation, np.array([-1.0, 0.0, 0.0]))


def _closing(task: HumanTask, side: str, grip: Transform) -> Steps[Closing]:
    """Where the palm goes and what the fingers do.

    Raises:
        AlgorithmError: the object is out of the hand's reach, or too wide for it.
    """
    if task.object is None:
        raise AlgorithmError("grasp needs an object")
    if task.object.shape is not None and task.parameter("diameter", 0.0) <= 0.0:
        return (yield from closing(task, side, TOO_FAR))
    radius, axis = _cylinder(task)
    end = _on_wall(grip, axis, radius, side)
    return Closing(end, closed(task.human, side, _seen_from_hand(task.human, side, end, axis, radius)), None)


def _cylinder(task: HumanTask) -> tuple[float, Transform]:
    """The object's radius and its axis: the z of the action's site, or of the object."""
    assert task.object is not None
    diameter = task.parameter("diameter", 0.0) or float(task.object.properties.get("diameter", 0.0))
    if diameter <= 0.0:
        raise AlgorithmError(
            f"grasp needs {task.object.name}'s shape or its diameter, a property or the parameter `diameter`"
        )
    return 0.5 * diameter, task.site or task.object.frame


def _on_wall(grip: Transform, axis: Transform, radius: float, side: str) -> Transform:
    """The palm's frame on the wall, as near to the present one as may be, the object a little towards the fingers.

    Raises:
        AlgorithmError: the object is out of the hand's reach.
    """
    up = rotate(axis.rotation, np.array([0.0, 0.0, 1.0]))
    out = rotate(grip.rotation, np.array([1.0, 0.0, 0.0]))
    level = out - (out @ up) * up
    rotation = multiply(between(out, level), grip.rotation)
    level = level / np.linalg.norm(level)
    to_fingers = np.cross(level, up) if side == "right" else np.cross(up, level)
    turn = np.arcsin(min(INTO_FINGERS / radius, 0.8))
    radial = np.cos(turn) * level + np.sin(turn) * to_fingers
    at_height = axis.place + ((grip.place - axis.place) @ up) * up
    place = at_height - radius * radial
    gap = float(np.linalg.norm(place - grip.place))
    if gap > TOO_FAR:
        raise AlgorithmError(f"the palm is {gap:.2f} m from the object's wall; reach for it first")
    return Transform(place, rotation)


def _seen_from_hand(skeleton: Skeleton, side: str, grip: Transform, axis: Transform, radius: float) -> Cylinder:
    """The object in the frame of the hand whose grip is where it shall be."""
    on_hand = Transform.of(skeleton.grips[0 if side == "right" else 1])
    hand = grip.then(on_hand.inverse()).inverse()
    seen = hand.then(axis)
    return Cylinder(seen.place, rotate(seen.rotation, np.array([0.0, 0.0, 1.0])), radius)


def _frames(task: HumanTask, side: str, shapes: Array, palm: tuple[Array, Array], spine: Array | None = None) -> Array:
    """Poses, importances and targets from the fingers' rotations (n, 14, 4), the palms (n, 7) and how far they are on
    their way (n), and the spine (4,) at the end where the waist bends.
    """
    palms, moved = palm
    length = len(shapes)
    rotations = np.repeat(task.start.rotations[None], length, axis=0)
    rotations[:, list(fingers(side))] = shapes
    if spine is not None:
        rotations[:, INDEX["spine"]] = slerp(rotations[:, INDEX["spine"]], spine, moved)
    targets = np.zeros((length, 5, 8))
    row = targets[:, 0 if side == "right" else 1]
    row[:, :7], row[:, 7] = palms, 1.0
    shares = {f"{side}_{part}": 1.0 for part in ("upper_arm", "lower_arm", "hand", "thumb", "index", "middle")}
    if spine is not None or task.carried:  # bent for the hand, or as the reach has left it, while the hand goes
        shares["spine"] = SPINE
    importance = importance_of(shares | {f"{side}_ring": 1.0, f"{side}_little": 1.0, "head": 0.05})
    if task.site is not None and not task.parameter("open", False):
        targets[:, GAZE, :3] = task.site.place
        targets[:, GAZE, 7] = 1.0
    root = np.repeat(task.start.root[None], length, axis=0)
    return task.block(rotations, root, importance, targets)


if __name__ == "__main__":
    run(grasp)
