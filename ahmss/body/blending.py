"""Blending of motions: joint by joint for the rotations (Ichiguchi 2000, 4.11), by increments for the root."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.errors import ShapeError

__all__ = ["blend", "blend_root"]


def blend(rotations: Array, importance: Array, previous: Array) -> Array:
    """Blend poses joint by joint, each motion weighted by its importance (4.11).

    To (4.11) comes what it leaves out: all quaternions are brought to one hemisphere before the sum, and the sum is
    normalised.

    Args:
        rotations: (motions, ..., 43, 4) unit quaternions wxyz, parent <- child.
        importance: (motions, ..., 43), >= 0, unitless; normalised here. All zero: `previous` stays.
        previous: (..., 43, 4) the last output; also chooses the hemisphere.

    Returns:
        (..., 43, 4) unit quaternions on the hemisphere of `previous`.

    Raises:
        ShapeError: the shapes disagree.
    """
    if rotations.shape[1:] != previous.shape or importance.shape != rotations.shape[:-1]:
        raise ShapeError(
            f"blend: rotations {rotations.shape}, importance {importance.shape} and previous {previous.shape} "
            "disagree; they must be (motions, ..., 43, 4), (motions, ..., 43) and (..., 43, 4)"
        )
    # The sign of the dot product chooses the hemisphere; carried by the weight, it costs no pass over the rotations.
    # For one pose vecdot is twice as fast, for a batch einsum is.
    one = previous.ndim == 2
    weight = np.vecdot(rotations, previous) if one else np.einsum("m...c,...c->m...", rotations, previous)
    np.copysign(importance, weight, weight)
    total = np.einsum("m...,m...c->...c", weight, rotations)
    length = np.vecdot(total, total) if one else np.einsum("...c,...c->...", total, total)
    np.sqrt(length, length)
    if length.size and length.min() < _NOBODY:
        nobody = length < _NOBODY
        length[nobody] = 1.0
        total[nobody] = previous[nobody]
    total /= length[..., None]
    return total


_NOBODY = 1e-12  # below this sum of importances nobody cares for the joint


def blend_root(increments: Array, importance: Array, previous: Array) -> Array:
    """Move the root by the mean of the motions' increments, weighted by importance; one owner alone is followed.

    The root is never a mean of places: two motions that stand in different places would drag the body between them.

    Args:
        increments: (motions, ..., 3) what each motion's root moved since its last frame, metres.
        importance: (motions, ...), >= 0. All zero: the root stays.
        previous: (..., 3) the last root, metres.

    Returns:
        (..., 3) the new root, metres.
    """
    if importance.ndim == 1:  # one human, in each frame
        amount = float(importance.sum())
        return previous + (importance @ increments) / amount if amount > _NOBODY else previous.copy()
    total = importance.sum(axis=0)
    share = importance / np.where(total > _NOBODY, total, 1.0)
    return previous + np.einsum("m...,m...c->...c", share, increments)
