"""Where the hips are, from which part of which foot stands (Ichiguchi 2000, 5.3.1, steps 1 to 5)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.motion.contact import foot_points

__all__ = ["from_lowest_part"]


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
