"""Slowing a motion down where a joint would turn faster than it should, and only there."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from ahmss.body.array import Array
from ahmss.body.quaternion import align, conjugate, multiply, to_rotation_vector

__all__ = ["slowed"]

_AROUND, _SOFT = 6, 3.0  # frames before and after that are slowed down too; over which that begins and ends


def slowed(rotations: Array, most: float, free: Array | None = None) -> Array:
    """When to show the frames of a motion for no joint to turn by more than so much from one to the next.

    Args:
        rotations: (n, m, 4) of the joints that count. most: radians a frame.
        free: (n) whether a frame may be slowed down; left out: all may.

    Returns:
        The places (k), k >= n, in frames of the motion from 0 to n - 1, which the frames of the slower one show. Where
        nothing is too fast all are whole numbers.
    """
    n = len(rotations)
    turned = multiply(conjugate(rotations[:-1]), align(rotations[1:], rotations[:-1]))
    steps = np.linalg.norm(to_rotation_vector(turned), axis=-1).max(axis=-1, initial=0.0)
    if free is not None:
        steps = np.where(np.logical_and(free[:-1], free[1:]), steps, 0.0)
    if n < 2 or steps.max() <= most:
        return np.arange(float(n))
    needed: Any = np.maximum(steps / most, 1.0)
    # As large as what is needed anywhere near, and softened by no more than that: nowhere less than what is needed.
    long = gaussian_filter1d(maximum_filter1d(needed, 2 * _AROUND + 1), _SOFT, truncate=_AROUND / _SOFT)
    shown_at = np.concatenate([[0.0], np.cumsum(long)])
    last = int(np.ceil(shown_at[-1] - 1e-9))
    return np.interp(np.arange(last + 1.0), shown_at * (last / shown_at[-1]), np.arange(float(n)))
