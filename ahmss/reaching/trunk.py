"""What of a body but arms and feet may meet things: points in hips, trunk, head, shoulders and knees, and how thick."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.body.skeleton import Skeleton

__all__ = ["trunk_points"]

_LINKS = ("hips", "spine", "head", "right_upper_arm", "left_upper_arm", "right_lower_leg", "left_lower_leg")
_JOINTS = [INDEX[name] for name in _LINKS]
_HEAD, _ALONG = INDEX["head"], np.array([0.4, 0.7])[:, None]  # of the head's length: face and crown
_THICK = np.array([0.10, 0.10, 0.09, 0.05, 0.05, 0.05, 0.05, 0.09, 0.08])  # metres


def trunk_points(skeleton: Skeleton, rotations: Array, root: Array) -> tuple[Array, Array]:
    """Points (..., 9, 3) of poses (..., 43, 4), (..., 3) in the world, and how thick skin is around them (9,)."""
    places, turned = forward(rotations, root, skeleton.offsets)
    head = places[..., _HEAD, None, :] + rotate(turned[..., _HEAD, None, :], _ALONG * skeleton.tips[_HEAD])
    return np.concatenate([places[..., _JOINTS, :], head], axis=-2), _THICK
