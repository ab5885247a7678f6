"""Where a human stands and faces: the frame on the floor under the hips."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array

__all__ = ["floor_frame"]

_LEVEL = np.array([1.0, 1.0, 0.0])


def floor_frame(rotations: Array, root: Array) -> tuple[Array, Array]:
    """A human's floor frame: under the hips, x where they face.

    Args:
        rotations: (..., 43, 4) unit quaternions; only the hips' count.
        root: (..., 3) metres.

    Returns:
        place (..., 3) on the floor and rotation (..., 4), world <- frame.
    """
    hips = rotations[..., 0, :]
    w, x, y, z = hips.tolist() if hips.ndim == 1 else np.moveaxis(hips, -1, 0)
    half = 0.5 * np.arctan2(w * x - y * z, -(x * z + w * y))  # of -z, by (4.8): the hips' z points back
    turned = np.zeros(hips.shape)
    turned[..., 0], turned[..., 3] = np.cos(half), np.sin(half)
    return root * _LEVEL, turned
