"""Closing the hand around an upright round object, and opening it (Ichiguchi 2000, 5.3.4).

The palm is brought onto the wall from where it is, at its height; the thumb goes to one side, the four fingers to the
other, each link by slerp from its present rotation to the one at which it touches.
"""

from __future__ import annotations

import numpy as np

from ahmss.algorithm import HumanTask, Transform, importance_of, run
from ahmss.body.array import Array
from ahmss.body.links import fingers
from ahmss.body.quaternion import between, multiply, rotate, slerp
from ahmss.body.skeleton import Skeleton
from ahmss.errors import AlgorithmError
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.fingers import Cylinder, closed, opened

TOO_FAR = 0.12  # metres between palm and wall beyond which closing the hand would catch nothing
INTO_FINGERS = 0.01  # metres by which the object lies before the palm's middle, towards the fingers
THERE_BY, OPEN_BY = 0.75, 0.55  # shares of the time: the palm at the wall, the opened fingers clear of it
GAZE = 4


def grasp(task: HumanTask) -> Array:
    """All frames (N, 260): the hand closes, or opens and draws back; the arm follows, the rest is left alone."""
    side = task.hand or "right"
    opening = task.parameter("open", False)
    time = np.arange(1, task.length + 1) / task.length
    grip = task.start.grip(side)
    if opening:
        shape = opened(side, task.start.rotations[fingers(side)][:2])
        end = Transform(grip.apply(np.array([-task.parameter("back", 0.06), 0.0, 0.0])), grip.rotation)
        bent, moved = minimum_jerk(time / OPEN_BY), minimum_jerk((time - 0.25) / 0.75)
    else:
        radius, axis = _object(task)
        end = _on_wall(grip, axis, radius, side)
        shape = closed(task.human, side, _seen_from_hand(task.human, side, end, axis, radius))
        bent, moved = minimum_jerk(time), minimum_jerk(time / THERE_BY)
    return _frames(task, side, (shape, bent), (end, moved))


def _object(task: HumanTask) -> tuple[float, Transform]:
    """The object's radius and its axis: the z of the action's site, or of the object."""
    if task.object is None:
        raise AlgorithmError("grasp needs an object")
    diameter = task.parameter("diameter", 0.0) or float(task.object.properties.get("diameter", 0.0))
    if diameter <= 0.0:
        raise AlgorithmError(f"grasp needs {task.object.name}'s diameter, a property or the parameter `diameter`")
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


def _frames(task: HumanTask, side: str, hand: tuple[Array, Array], palm: tuple[Transform, Array]) -> Array:
    """Poses, importances and targets from the fingers' shape and the palm's end, each with its share of the way."""
    shape, bent = hand
    end, moved = palm
    links = list(fingers(side))
    rotations = np.repeat(task.start.rotations[None], task.length, axis=0)
    rotations[:, links] = slerp(rotations[:, links], shape, bent[:, None])
    targets = np.zeros((task.length, 5, 8))
    row = targets[:, 0 if side == "right" else 1]
    grip = task.start.grip(side)
    row[:, :3] = grip.place + moved[:, None] * (end.place - grip.place)
    row[:, 3:7] = slerp(grip.rotation, end.rotation, moved)
    row[:, 7] = 1.0
    shares = {f"{side}_{part}": 1.0 for part in ("upper_arm", "lower_arm", "hand", "thumb", "index", "middle")}
    importance = importance_of(shares | {f"{side}_ring": 1.0, f"{side}_little": 1.0, "head": 0.05})
    if task.site is not None and not task.parameter("open", False):
        targets[:, GAZE, :3] = task.site.place
        targets[:, GAZE, 7] = 1.0
    root = np.repeat(task.start.root[None], task.length, axis=0)
    return task.block(rotations, root, importance, targets)


if __name__ == "__main__":
    run(grasp)
