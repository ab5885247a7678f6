"""Standing motions put under a human: poses of a clip moved so that their feet come where the human's feet stand.

A clip made on one body serves others: the rotations are shared, and the legs, not the clip, say how high the hips are.
"""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.body.skeleton import Skeleton

__all__ = ["feet", "plant", "stance"]

# Both legs, link by link from the hip: only these are walked down, not the whole body.
_LEGS = [[INDEX[f"{side}_{link}"] for side in ("right", "left")] for link in ("upper_leg", "lower_leg", "foot")]
_UP = np.array([0.0, 0.0, 1.0])
_FORWARD = np.array([1.0, 0.0, 0.0])


def feet(skeleton: Skeleton, rotations: Array, root: Array) -> Array:
    """The foot links' frames (..., 2, 7), right and left, in the world: place of the ankle, rotation wxyz."""
    world, places = rotations[..., :1, :], root[..., None, :]
    for links in _LEGS:
        places = places + rotate(world, skeleton.offsets[links])
        world = multiply(world, rotations[..., links, :])
    return np.concatenate([places, world], axis=-1)


def stance(foot_frames: Array) -> tuple[Array, Array]:
    """Where feet (..., 2, 7) stand: the middle of the ankles (..., 3) and the feet's mean heading (...), radians."""
    ahead = rotate(foot_frames[..., 3:7], _FORWARD).sum(axis=-2)
    return foot_frames[..., :3].mean(axis=-2), np.arctan2(ahead[..., 1], ahead[..., 0])


def plant(skeleton: Skeleton, rotations: Array, foot_frames: Array) -> tuple[Array, Array]:
    """Poses turned and moved as wholes, so that each stands as the given feet do.

    Args:
        skeleton: the human's measures.
        rotations: (..., 43, 4) unit quaternions; the hips' in any heading.
        foot_frames: (2, 7) the human's feet in the world.

    Returns:
        rotations (..., 43, 4) with the hips turned, and root (..., 3) in metres.
    """
    middle, heading = stance(foot_frames)
    own_middle, own_heading = stance(feet(skeleton, rotations, np.zeros((*rotations.shape[:-2], 3))))
    turn = from_axis_angle(_UP, heading - own_heading)
    planted = rotations.copy()
    planted[..., 0, :] = multiply(turn, rotations[..., 0, :])
    return planted, middle - rotate(turn, own_middle)
