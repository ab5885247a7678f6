"""One's own head in the way of what a hand has at it, as a telephone's handset is at ear and mouth."""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.reaching.leaning import looking
from ahmss.reaching.performing import Performed

__all__ = ["at_own_head", "head_points", "in_own_head"]

# Millimetres that a head of who is 1.70 m tall reaches to a side, beginning at the forehead, down to the throat, from
# the face to behind the ears; none: there is no head. Measured of both shipped humans, between which it is.
_WIDE = np.array([
    [0, 56, 73, 81, 84, 87, 86, 80, 69],
    [0, 55, 74, 81, 84, 86, 86, 80, 69],
    [0, 50, 69, 81, 81, 86, 81, 75, 61],
    [6, 55, 70, 77, 77, 86, 77, 69, 53],
    [7, 51, 68, 74, 70, 78, 64, 38, 0],
    [0, 45, 58, 59, 57, 52, 43, 13, 0],
    [0, 32, 46, 47, 47, 50, 45, 22, 0],
    [0, 17, 28, 39, 48, 51, 47, 30, 0],
])  # fmt: skip
_UP, _BACK, _STEP = 0.05, -0.025, 0.025  # metres from between the eyes to its first; from each to the next
_ACROSS = np.linspace(-1.0, 1.0, 7)  # of its width
_STATURE = 1.70  # metres
_HEAD, _EVERY = INDEX["head"], 2  # frames
_NEAR = 0.03  # metres from the head: what is nearer is at it
_LEVEL = np.array([1.0, 1.0, 0.0])


def head_points(skeleton: Skeleton) -> Array:
    """Points (n, 3) in and on the lower part of a human's head, from between the eyes: x up, y left, z back; metres."""
    rows, columns = np.nonzero(_WIDE)
    wide = 1e-3 * _WIDE[rows, columns]
    up, back = np.broadcast_arrays(_UP - _STEP * rows, _BACK + _STEP * columns)
    points = [np.stack([up, share * wide, back], axis=-1) for share in _ACROSS]
    return skeleton.stature / _STATURE * np.concatenate(points)


def at_own_head(task: HumanTask) -> bool:
    """Whether what a hand holds is at one's own head, as its turn would be felt; it is taken as the box around it."""
    thing = task.object
    if thing is None or thing.shape is None:
        return False
    places, turned = forward(task.start.rotations, task.start.root, task.human.offsets)
    head = Transform(places[_HEAD], turned[_HEAD])
    seen = thing.frame.inverse().apply(head.apply(task.human.eye + head_points(task.human)))
    low, high = thing.shape.vertices.min(axis=0), thing.shape.vertices.max(axis=0)
    return bool((np.linalg.norm(np.maximum(np.maximum(low - seen, seen - high), 0.0), axis=-1) < _NEAR).any())


def in_own_head(task: HumanTask, side: str, made: Performed) -> tuple[float, Array]:
    """How deep, metres, what a hand carries on its way is in one's own head at the most; 0 where it is never.

    And the level unit vector (3,) from there to the hand: to that side it leaves the head.
    """
    thing = task.object
    if thing is None or thing.shape is None:
        return 0.0, np.zeros(3)
    palms = made.targets[::_EVERY, made.plan.reacher.row, :7]
    in_palm = task.start.grip(side).inverse().then(thing.frame)
    place, turned = palms[:, :3] + rotate(palms[:, 3:], in_palm.place), multiply(palms[:, 3:], in_palm.rotation)
    head = _heads(task.human, made)
    points = head.place[:, None] + rotate(head.rotation[:, None], task.human.eye + head_points(task.human))
    seen = rotate(conjugate(turned)[:, None], points - place[:, None])
    low, high = thing.shape.vertices.min(axis=0), thing.shape.vertices.max(axis=0)
    inside = ((seen > low) & (seen < high)).all(axis=-1)
    if not inside.any():
        return 0.0, np.zeros(3)
    site = thing.sites.get(task.message.site)
    field = thing.shape.field(0.5 * (low + high) if site is None else np.array(site.position))
    depth = np.zeros(inside.shape)
    depth[inside] = -field.clearance(seen[inside])
    frame = int(depth.max(axis=1).argmax())
    away = (palms[frame, :3] - points[frame].mean(axis=0)) * _LEVEL
    return max(float(depth.max()), 0.0), away / max(float(np.linalg.norm(away)), 1e-9)


def _heads(skeleton: Skeleton, made: Performed) -> Transform:
    """The head's frames (n) as they are shown."""
    gaze, root = made.targets[::_EVERY, GAZE], made.root[::_EVERY]
    seen = looking(skeleton, made.rotations[::_EVERY], root, gaze[:, :3], gaze[:, 7])
    places, turned = forward(seen, root, skeleton.offsets)
    return Transform(places[:, _HEAD], turned[:, _HEAD])
