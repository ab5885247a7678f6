"""What of a body but arms and feet may meet things: points in hips, trunk, head, shoulders and knees, and how thick."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.body.skeleton import Skeleton

__all__ = ["trunk_points"]

# Link, share of its length from its joint, metres backward (the head's z), metres of skin around.
_BALLS = (
    ("hips", 0.0, 0.0, 0.10),
    ("spine", 0.0, 0.0, 0.10),
    ("spine", 0.4, 0.0, 0.125),
    ("spine", 0.75, 0.0, 0.115),
    ("right_upper_arm", 0.0, 0.0, 0.06),
    ("left_upper_arm", 0.0, 0.0, 0.06),
    ("right_lower_leg", 0.0, 0.0, 0.05),
    ("left_lower_leg", 0.0, 0.0, 0.05),
    ("head", 0.0, 0.0, 0.09),
    ("head", 0.52, -0.02, 0.10),  # the face
    ("head", 0.52, 0.07, 0.10),  # the hair behind
    ("head", 0.70, -0.03, 0.10),  # the crown
    ("head", 0.70, 0.04, 0.095),
)
_JOINTS = [INDEX[link] for link, *_ in _BALLS]
_SHARES, _BACK = (
    np.array([[share] for _, share, *_ in _BALLS]),
    np.array([[0.0, 0.0, back] for _, _, back, _ in _BALLS]),
)
_UPPER_ARM = (0.22, 0.055)  # share of an upper arm, metres of skin around: where a shoulder ends
_THICK = np.array([thick for *_, thick in _BALLS])


def trunk_points(skeleton: Skeleton, rotations: Array, root: Array, arm: str = "") -> tuple[Array, Array]:
    """Points (..., n, 3) of poses (..., 43, 4), (..., 3) in the world, and how thick skin is around them (n,).

    arm: the side whose upper arm goes along with the shoulder, by which that is deeper; left out: of neither.
    """
    places, turned = forward(rotations, root, skeleton.offsets)
    off = _SHARES * skeleton.tips[_JOINTS] + _BACK
    points = places[..., _JOINTS, :] + rotate(turned[..., _JOINTS, :], off)
    if not arm:
        return points, _THICK
    shoulder, elbow = places[..., INDEX[f"{arm}_upper_arm"], :], places[..., INDEX[f"{arm}_lower_arm"], :]
    share, thick = _UPPER_ARM
    under = shoulder + share * (elbow - shoulder)
    return np.concatenate([points, under[..., None, :]], axis=-2), np.append(_THICK, thick)
