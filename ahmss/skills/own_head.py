"""One's own head in the way of what a hand has at it, as a telephone's handset is at ear and mouth."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ahmss.algorithm.place import Transform, WorldObject
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE, grips
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.reaching.leaning import looking
from ahmss.reaching.performing import Performed
from ahmss.reaching.reacher import SIDES

__all__ = ["at_own_head", "head_of", "head_points", "in_head", "in_own_head"]

# Millimetres that a head of who is 1.70 m tall reaches to a side, beginning at the forehead, down to the throat, from
# the face to behind the ears; none: there is no head. Measured of both shipped humans, of each place the wider.
_WIDE = np.array([
    [0, 60, 71, 80, 86, 89, 88, 82, 70],
    [0, 50, 75, 82, 85, 88, 87, 82, 70],
    [0, 45, 63, 85, 82, 86, 81, 76, 62],
    [3, 50, 69, 81, 77, 86, 77, 69, 49],
    [7, 48, 67, 77, 68, 71, 64, 41, 0],
    [0, 41, 60, 62, 59, 54, 46, 17, 0],
    [0, 33, 49, 51, 50, 54, 49, 25, 0],
    [0, 21, 29, 39, 51, 55, 51, 32, 0],
])  # fmt: skip
_UP, _BACK, _STEP = 0.05, -0.025, 0.025  # metres from between the eyes to its first; from each to the next
_ACROSS = np.array([-1.0, -0.8, -0.4, 0.0, 0.4, 0.8, 1.0])  # of its width
_STATURE = 1.70  # metres
_HEAD, _EVERY = INDEX["head"], 2  # frames
_SKIN = 0.004  # metres by which skin is elsewhere than it was measured, as a neck bends
_NEAR = 0.03  # metres from the head: what is nearer is at it
_LEVEL = np.array([1.0, 1.0, 0.0])


@lru_cache(maxsize=16)
def head_points(skeleton: Skeleton) -> Array:
    """Points (n, 3) in and on the lower part of a human's head, from between the eyes: x up, y left, z back; metres."""
    wide = _halved(_halved(_WIDE.astype(float)).T).T
    rows, columns = np.nonzero(wide)
    up, back = _UP - 0.5 * _STEP * rows, _BACK + 0.5 * _STEP * columns
    points = [np.stack([up, share * 1e-3 * wide[rows, columns], back], axis=-1) for share in _ACROSS]
    scale = skeleton.stature / _STATURE
    return np.asarray(scale * np.concatenate(points), np.float64)


def head_of(skeleton: Skeleton, rotations: Array, root: Array) -> Transform:
    """The head's frames (...) in poses (..., 43, 4), (..., 3)."""
    places, turned = forward(rotations, root, skeleton.offsets)
    return Transform(places[..., _HEAD, :], turned[..., _HEAD, :])


def at_own_head(task: HumanTask, side: str, held: Transform) -> bool:
    """Whether what a hand holds is at one's own head, as its turn would be felt; it is taken as the box around it.

    Args:
        task: who. side: of the hand. held: the thing, the task's object, in the palm's frame.
    """
    thing, start = task.object, task.start
    if thing is None or thing.shape is None:
        return False
    palm = Transform.of(grips(task.human, start.rotations, start.root)[SIDES.index(side)])
    head = head_of(task.human, start.rotations, start.root)
    seen = palm.then(held).inverse().apply(head.apply(task.human.eye + head_points(task.human)))
    low, high = thing.shape.vertices.min(axis=0), thing.shape.vertices.max(axis=0)
    return bool((np.linalg.norm(np.maximum(np.maximum(low - seen, seen - high), 0.0), axis=-1) < _NEAR).any())


def in_head(skeleton: Skeleton, thing: WorldObject, site: str, heads: Transform, frames: Transform) -> Array:
    """How deep (n), metres, a thing would be in heads, skin and all; 0 where it is in none.

    Args:
        skeleton: whose heads. thing: with its shape. site: of it, about which its shape is looked at.
        heads: their frames, one or n. frames: the thing's (n).
    """
    assert thing.shape is not None
    points = np.atleast_2d(heads.place)[:, None] + rotate(
        np.atleast_2d(heads.rotation)[:, None], skeleton.eye + head_points(skeleton)
    )
    seen = rotate(conjugate(frames.rotation)[:, None], points - frames.place[:, None])
    low, high = thing.shape.vertices.min(axis=0), thing.shape.vertices.max(axis=0)
    inside = ((seen > low - _SKIN) & (seen < high + _SKIN)).all(axis=-1)
    depth = np.zeros(inside.shape)
    if inside.any():
        named = thing.sites.get(site)
        field = thing.shape.field(0.5 * (low + high) if named is None else np.array(named.position))
        depth[inside] = _SKIN - field.clearance(seen[inside])
    return np.maximum(depth.max(axis=-1), 0.0)


def in_own_head(task: HumanTask, made: Performed, held: Transform) -> tuple[float, Array]:
    """How deep, metres, what a hand carries on its way is in one's own head at the most, deeper than where the way
    begins or ends; 0 where it is never.

    And the level unit vector (3,) from there to the hand: to that side it leaves the head. held: the thing, the
    task's object, in the palm's frame.
    """
    thing = task.object
    if thing is None or thing.shape is None:
        return 0.0, np.zeros(3)
    palms = Transform.of(made.targets[::_EVERY, made.plan.reacher.row, :7])
    frames = Transform(palms.place + rotate(palms.rotation, held.place), multiply(palms.rotation, held.rotation))
    heads = _heads(task.human, made)
    depth = in_head(task.human, thing, task.message.site, heads, frames)
    deeper = depth - max(float(depth[0]), float(depth[-1]))
    frame = int(deeper.argmax())
    if deeper[frame] <= 0.0:
        return 0.0, np.zeros(3)
    middle = heads.place[frame] + rotate(heads.rotation[frame], task.human.eye + head_points(task.human).mean(axis=0))
    away = (palms.place[frame] - middle) * _LEVEL
    return float(deeper[frame]), away / max(float(np.linalg.norm(away)), 1e-9)


def _heads(skeleton: Skeleton, made: Performed) -> Transform:
    """The head's frames (n) as they are shown."""
    gaze, root = made.targets[::_EVERY, GAZE], made.root[::_EVERY]
    return head_of(skeleton, looking(skeleton, made.rotations[::_EVERY], root, gaze[:, :3], gaze[:, 7]), root)


def _halved(wide: Array) -> Array:
    """Widths (n, m) with those half-way between its rows (2 n - 1, m); none next to where there is no head."""
    made = np.empty((2 * len(wide) - 1, wide.shape[1]))
    made[::2] = wide
    made[1::2] = np.where((wide[1:] > 0.0) & (wide[:-1] > 0.0), 0.5 * (wide[1:] + wide[:-1]), 0.0)
    return made
