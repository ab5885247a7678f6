"""Where the hips are when only rotations are known: from what stands (Ichiguchi 2000, 5.3.1), and beyond it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.motion.contact import foot_points

__all__ = ["from_lowest_part", "from_standing_parts"]

_ROUNDS = 5  # the hips' speed tells what stands, what stands tells the speed: they agree after a few
_LOW = 0.02  # metres over the lowest part at which a part counts little
_SLOW = 0.3  # metres a second, the same for its speed over the ground
_PASSING = 0.04  # seconds over which the weight passes from one part to the next
_NOBODY = 1e-4  # a weight of all parts together below which the hips go on as they went


def from_lowest_part(
    skeleton: Skeleton, rotations: Array, start: Array | None = None
) -> tuple[Array, NDArray[np.intp]]:
    """The hips' places of a motion of which only the rotations are known, to the letter of the thesis.

    In every frame the lowest part of the feet stands. While it is the same part, it stays where it is; when another
    one is lowest, that one stands from now on where it just came to be.

    Args:
        skeleton: the human's measures.
        rotations: (frames, 43, 4) unit quaternions, parent <- child; the hips' against the world.
        start: (3,) where the first part stands, metres; the world's origin if left out.

    Returns:
        root (frames, 3), metres, and the part that stands (frames,): 0 to 2 heel, ball and toe tip of the right foot,
        3 to 5 of the left.
    """
    parts = foot_points(skeleton, rotations, np.zeros((len(rotations), 3))).reshape(len(rotations), 6, 3)
    lowest = parts[..., 2].argmin(axis=-1)  # step 1: seen from the hips
    b = np.zeros(3) if start is None else np.asarray(start, float)
    root = np.empty((len(rotations), 3))
    for k, part in enumerate(lowest):
        if k and part != lowest[k - 1]:  # step 4
            c = parts[k, part] - parts[k, lowest[k - 1]]
            b = b + c  # step 5
        a = -parts[k, part]  # step 2
        root[k] = a + b  # step 3
    return root, lowest


def from_standing_parts(skeleton: Skeleton, rotations: Array, rate: float) -> Array:
    """The hips' places from all parts of both feet that are low and slow, the floor at z = 0, without jerks.

    The lowest part alone makes the hips start and stop at every change, sink a little each time (the new part is the
    lower one), and follow a toe that swings through low. Here heels and balls weigh by how low and how slow they are,
    and their weight passes on gradually; toe tips don't count, for toes bend and a rigid foot's would sink.

    Args:
        skeleton: the human's measures.
        rotations: (frames, 43, 4) unit quaternions, parent <- child; the hips' against the world.
        rate: frames a second.

    Returns:
        root (frames, 3), metres; it starts over the origin.
    """
    parts = foot_points(skeleton, rotations, np.zeros((len(rotations), 3)))[:, :, :2].reshape(-1, 4, 3)
    if len(parts) < 2:
        return np.array([[0.0, 0.0, -parts[0, :, 2].min()]])
    velocity: Array = np.asarray(np.gradient(parts, 1.0 / rate, axis=0))[..., :2]
    height = parts[..., 2] - parts[..., 2].min(axis=1, keepdims=True)
    low = np.exp(-((height / _LOW) ** 2))
    hips = -np.take_along_axis(velocity, height.argmin(axis=1)[:, None, None], axis=1)[:, 0]
    weight = low
    for _ in range(_ROUNDS):
        hips = gaussian_filter1d(hips, _PASSING * rate, axis=0, mode="nearest")
        slip = np.linalg.norm(velocity + hips[:, None], axis=-1)
        weight = gaussian_filter1d(low * np.exp(-((slip / _SLOW) ** 2)), _PASSING * rate, axis=0, mode="nearest")
        standing = (weight[..., None] * -velocity).sum(axis=1) + _NOBODY * hips
        hips = standing / (weight.sum(axis=1, keepdims=True) + _NOBODY)
    root = np.zeros((len(parts), 3))
    root[1:, :2] = np.cumsum(0.5 * (hips[1:] + hips[:-1]), axis=0) / rate
    bearing = (weight * low) ** 2 + _NOBODY * (height == 0.0)
    below = (bearing * parts[..., 2]).sum(axis=1) / bearing.sum(axis=1)
    root[:, 2] = -gaussian_filter1d(below, 0.5 * _PASSING * rate, mode="nearest")
    return root
