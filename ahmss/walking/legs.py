"""Legs solved onto their feet: bones keep their lengths, knees bend forwards (Ichiguchi 2000, A.3.2, the legs)."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, from_matrix, multiply, rotate
from ahmss.body.skeleton import Skeleton

__all__ = ["foot_frames", "hip_joints", "reach", "solve_legs"]

_UPPER = [INDEX["right_upper_leg"], INDEX["left_upper_leg"]]
_LOWER = [INDEX["right_lower_leg"], INDEX["left_lower_leg"]]
_FOOT = [INDEX["right_foot"], INDEX["left_foot"]]
_AHEAD = np.array([0.0, 0.0, -1.0])  # of the hips' frame
_WITH_FOOT = 1.6  # how much more the knee goes with the foot than with the pelvis: ankles turn less than hips do
_FORWARD = np.array([1.0, 0.0, 0.0])  # of a foot's


def reach(skeleton: Skeleton) -> float:
    """Thigh and shank, metres."""
    return float(np.linalg.norm(skeleton.offsets[_LOWER[0]]) + np.linalg.norm(skeleton.offsets[_FOOT[0]]))


def hip_joints(skeleton: Skeleton, hips: Array, root: Array) -> Array:
    """The hip joints (F, 2, 3), right and left, of pelvises turned by `hips` (F, 4) from heading 0 upright."""
    across = skeleton.offsets[_UPPER, 1]
    return root[:, None] + rotate(hips[:, None], across[:, None] * np.array([0.0, 1.0, 0.0]))


def foot_frames(skeleton: Skeleton, rotations: Array, root: Array) -> tuple[Array, Array]:
    """Ankles (F, 2, 3) and the feet's rotations (F, 2, 4) in the world of poses (F, >= 15, 4)."""
    world, place = rotations[:, :1], root[:, None]
    for links in (_UPPER, _LOWER, _FOOT):
        place = place + rotate(world, skeleton.offsets[links])
        world = multiply(world, rotations[:, links])
    return place, world


def solve_legs(skeleton: Skeleton, rotations: Array, root: Array, ankles: Array, feet: Array) -> None:
    """Set both legs of poses so that the feet are where they shall be; a leg too short points at its foot.

    The knee lies in the plane through hip joint, ankle and a direction between those of the pelvis and the foot.

    Args:
        skeleton: the human's measures.
        rotations: (F, n >= 15, 4), changed in place; the hips' count.
        root: (F, 3) metres.
        ankles: (F, 2, 3) right and left, world. feet: (F, 2, 4) their rotations, world <- foot.
    """
    q_hips = rotations[:, :1]
    joints = root[:, None] + rotate(q_hips, skeleton.offsets[_UPPER])
    thigh = float(np.linalg.norm(skeleton.offsets[_LOWER[0]]))
    shank = float(np.linalg.norm(skeleton.offsets[_FOOT[0]]))
    line = ankles - joints
    length = np.linalg.norm(line, axis=-1, keepdims=True)
    down = line / length
    length = np.clip(length, abs(thigh - shank) + 1e-6, thigh + shank)
    facing = _level(rotate(q_hips, _AHEAD)) + _WITH_FOOT * _level(rotate(feet, _FORWARD))
    left = np.cross(-down, facing)
    left /= np.linalg.norm(left, axis=-1, keepdims=True)
    forward = np.cross(left, -down)
    cosine = np.clip((thigh**2 + length**2 - shank**2) / (2.0 * thigh * length), -1.0, 1.0)
    sine = np.sqrt(1.0 - cosine**2)
    knee = thigh * (cosine * down + sine * forward)
    upper = knee / thigh
    lower = (length * down - knee) / shank
    q_upper, q_lower = _frame(upper, left), _frame(lower, left)
    rotations[:, _UPPER] = multiply(conjugate(q_hips), q_upper)
    rotations[:, _LOWER] = multiply(conjugate(q_upper), q_lower)
    rotations[:, _FOOT] = multiply(conjugate(q_lower), feet)


def _level(v: Array) -> Array:
    """Directions (..., 3) laid level, of length 1."""
    flat = v * np.array([1.0, 1.0, 0.0])
    return flat / np.maximum(np.linalg.norm(flat, axis=-1, keepdims=True), 1e-9)


def _frame(along: Array, left: Array) -> Array:
    """Rotations of links whose x lies along the bone and y to the left."""
    return from_matrix(np.stack([along, left, np.cross(along, left)], axis=-1))
