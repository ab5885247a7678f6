"""A subject for the simulated tracker, and what its sensors should say: computed here by other means."""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.spatial.transform import Rotation

from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_rotation_vector, multiply
from ahmss.body.skeleton import Skeleton
from ahmss.capture.performance import Performance

RATE = 60.0


@cache
def subject(frames: int = 90, *, moving: bool = True) -> Performance:
    """Stands still for half a second, then turns all over and walks off sideways."""
    skeleton = Skeleton.of(1.7, "female")
    pose, place = skeleton.upright()
    share = np.clip(np.arange(frames) - 30, 0, None) / RATE * moving
    rotations = np.repeat(pose[None], frames, axis=0)
    turn = share[:, None] * np.array([0.9, -0.7, 0.5])
    for name in ("hips", "head", "right_upper_arm", "left_lower_leg"):
        rotations[:, INDEX[name]] = multiply(rotations[:, INDEX[name]], from_rotation_vector(turn))
    root = place + share[:, None] * np.array([0.2, 0.3, 0.05])
    return Performance(rotations, root, RATE, skeleton, "turns", (0, 30))


def as_rotation(quaternions) -> Rotation:
    """Of (..., 4) wxyz, for scipy."""
    return Rotation.from_quat(np.roll(np.asarray(quaternions).reshape(-1, 4), -1, axis=-1))


def angles_between(one, other) -> np.ndarray:
    """Degrees between rows of quaternions wxyz."""
    return np.degrees((as_rotation(one).inv() * as_rotation(other)).magnitude())
