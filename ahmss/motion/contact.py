"""Contact with the ground: a foot point that is low and slow together.

Height alone fails on real walking, where the swinging toe passes low at over 3 m/s.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.body.skeleton import Skeleton

__all__ = ["LOW", "POINTS", "SHORTEST", "SLOW", "bearing", "contacts", "foot_points", "runs", "speeds"]

POINTS = ("heel", "ball", "toe")

LOW = 0.05  # metres above the floor
SLOW = 0.5  # metres a second
SHORTEST = 0.1  # seconds
_FEET = [INDEX["right_foot"], INDEX["left_foot"]]
_MIRROR = np.array([1.0, -1.0, 1.0])


def foot_points(skeleton: Skeleton, rotations: Array, root: Array) -> Array:
    """Heel, ball and toe tip of right and left foot (..., 2, 3, 3) in the world, metres."""
    places, world = forward(rotations, root, skeleton.offsets)
    soles = np.stack([skeleton.soles, skeleton.soles * _MIRROR])
    return places[..., _FEET, None, :] + rotate(world[..., _FEET, None, :], soles)


def speeds(points: Array, rate: float) -> Array:
    """Speeds (frames, ...) in metres a second of points (frames, ..., 3), by central differences."""
    if len(points) < 2:
        return np.zeros(points.shape[:-1])
    return np.linalg.norm(np.gradient(points, 1.0 / rate, axis=0), axis=-1)


def bearing(points: Array, rate: float, floor: float = 0.0) -> NDArray[np.bool_]:
    """Which points (frames, n, 3) bear: lower than 5 cm over the floor and slower than 0.5 m/s for 0.1 s or longer."""
    low_and_slow = (points[..., 2] < floor + LOW) & (speeds(points, rate) < SLOW)
    shortest = max(round(SHORTEST * rate), 1)
    out = np.zeros_like(low_and_slow)
    for point in range(points.shape[1]):
        for first, last in runs(low_and_slow[:, point]):
            out[first:last, point] = last - first >= shortest
    return out


def runs(flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """The stretches of true in flags (frames,), each as first frame and the one after the last."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return [(int(first), int(last)) for first, last in zip(edges[::2], edges[1::2], strict=True)]


def contacts(skeleton: Skeleton, rotations: Array, root: Array, rate: float) -> Array:
    """A clip's contacts (frames, 2), 0 or 1: whether any point of the right and the left foot bears.

    Args:
        skeleton: the human's measures.
        rotations: (frames, 43, 4) unit quaternions.
        root: (frames, 3) metres, the floor at z = 0.
        rate: frames a second.
    """
    points = foot_points(skeleton, rotations, root)
    feet = bearing(points.reshape(len(points), 6, 3), rate).reshape(len(points), 2, 3)
    return feet.any(axis=-1).astype(float)
