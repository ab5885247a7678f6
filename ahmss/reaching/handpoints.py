"""Points of a hand whose palm is somewhere and whose fingers are somehow: what may touch what is beside."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import IDENTITY, conjugate, multiply, rotate, to_matrix
from ahmss.body.skeleton import Skeleton

__all__ = ["hand_points", "own_points", "placed_points"]

_FINGERS = ("thumb", "index", "middle", "ring", "little")
_SEGMENTS = ("proximal", "intermediate", "distal")


def hand_points(skeleton: Skeleton, side: str, palms: Array, shape: Array, spared: str = "") -> Array:
    """The wrist, each joint, the middle of each link and each tip (n, m, 3) of hands in the world.

    Args:
        skeleton: the human's measures. side: "right" or "left". palms: (n, 7).
        shape: (14, 4) rotations of the fingers. spared: a finger whose tip is left out.
    """
    return placed_points(skeleton, side, palms, own_points(skeleton, side, shape, spared))


def placed_points(skeleton: Skeleton, side: str, palms: Array, own: Array) -> Array:
    """Points (n, m, 3) in the world, (m, 3) from the wrist in a hand's own frame, of hands whose palms are (n, 7)."""
    grip = skeleton.grips[1 if side == "left" else 0]
    rotation = multiply(palms[:, 3:7], conjugate(grip[3:]))
    wrist = palms[:, :3] - rotate(rotation, grip[:3])
    return wrist[:, None] + own @ to_matrix(rotation).swapaxes(-1, -2)


def own_points(skeleton: Skeleton, side: str, shape: Array, spared: str = "") -> Array:
    """The same points (m, 3) from the wrist, in the hand's own frame."""
    first = fingers(side)[0]
    points = [np.zeros(3)]
    for finger in _FINGERS:
        place, turned = np.zeros(3), IDENTITY
        tip = place
        for link in [INDEX[name] for s in _SEGMENTS if (name := f"{side}_{finger}_{s}") in INDEX]:
            place = place + rotate(turned, skeleton.offsets[link])
            turned = multiply(turned, shape[link - first])
            tip = place + rotate(turned, skeleton.tips[link])
            points += [place, 0.5 * (place + tip)]
        if finger != spared:
            points.append(tip)
    return np.array(points)
