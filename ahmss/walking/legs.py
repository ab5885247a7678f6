"""Legs solved onto their feet: bones keep their lengths, knees bend forwards (Ichiguchi 2000, A.3.2, the legs)."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, cross, from_axis_angle, from_matrix, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.easing import minimum_jerk

__all__ = ["foot_frames", "hip_joints", "reach", "solve_legs"]

_UPPER = [INDEX["right_upper_leg"], INDEX["left_upper_leg"]]
_LOWER = [INDEX["right_lower_leg"], INDEX["left_lower_leg"]]
_FOOT = [INDEX["right_foot"], INDEX["left_foot"]]
# Ahead and down the leg, upright: in the hips' frame and in a foot's.
_HIPS_AHEAD, _HIPS_DOWN = np.array([0.0, 0.0, -1.0]), np.array([-1.0, 0.0, 0.0])
_FOOT_AHEAD, _FOOT_DOWN = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, -1.0])
_ALONG = np.array([1.0, 0.0, 0.0])  # a link's bone
_BY_HIP = 0.615  # of a foot's turn against the pelvis: the hip's share, the ankle's is the rest, as their limits are
_RAISED = 0.9  # how much more it is, times the square of its pitch's sine: a foot on its toes has no turn to spare
_HIP_MOST = np.radians(57.0)  # what a hip turns for that, its limit and a little: beyond, both share again
_BY_KNEE = np.radians(9.8)  # the most that the shank turns in the knee, where a foot is turned by much
_MUCH = np.radians(25.0), np.radians(75.0)  # from where on, and where the shank is turned as far as it turns


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

    A foot turned against the pelvis about the line from hip joint to ankle is turned partly in the hip, with which the
    knee goes, partly in the ankle, and where that is much a little in the knee: none is beyond its limits for another.

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
    unturned = _carried(rotate(q_hips, _HIPS_AHEAD), rotate(q_hips, _HIPS_DOWN), down)
    wanted = _carried(rotate(feet, _FOOT_AHEAD), rotate(feet, _FOOT_DOWN), down)
    aside = cross(unturned, down)  # to the left
    turn = np.arctan2((aside * wanted).sum(axis=-1), (unturned * wanted).sum(axis=-1))
    by_knee = np.sign(turn) * _BY_KNEE * minimum_jerk((np.abs(turn) - _MUCH[0]) / (_MUCH[1] - _MUCH[0]))
    pitch = np.minimum(rotate(feet, _FOOT_AHEAD)[..., 2], 0.0)
    rest = np.abs(turn - by_knee)
    left_over = np.maximum(_HIP_MOST - _BY_HIP * rest, 0.0)
    more = _RAISED * pitch**2 * rest
    more *= left_over / np.maximum((left_over**2 + more**2) ** 0.5, 1e-9)
    by_hip = (np.sign(turn) * (_BY_HIP * rest + more))[..., None]
    forward = np.cos(by_hip) * unturned + np.sin(by_hip) * aside
    left = cross(forward, down)
    cosine = np.clip((thigh**2 + length**2 - shank**2) / (2.0 * thigh * length), -1.0, 1.0)
    sine = np.sqrt(1.0 - cosine**2)
    knee = thigh * (cosine * down + sine * forward)
    upper = knee / thigh
    lower = (length * down - knee) / shank
    q_upper = _frame(upper, left)
    q_lower = multiply(_frame(lower, left), from_axis_angle(_ALONG, -by_knee))
    rotations[:, _UPPER] = multiply(conjugate(q_hips), q_upper)
    rotations[:, _LOWER] = multiply(conjugate(q_upper), q_lower)
    rotations[:, _FOOT] = multiply(conjugate(q_lower), feet)


def _carried(v: Array, since: Array, to: Array) -> Array:
    """Directions v (..., 3) across `since`, turned by the smallest turn from there to `to`; all of length 1."""
    share = (v * to).sum(axis=-1, keepdims=True) / (1.0 + (since * to).sum(axis=-1, keepdims=True))
    return v - share * (since + to)


def _frame(along: Array, left: Array) -> Array:
    """Rotations of links whose x lies along the bone and y to the left."""
    return from_matrix(np.stack([along, left, cross(along, left)], axis=-1))
