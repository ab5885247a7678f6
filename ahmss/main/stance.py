"""How a human stands when it enters the world."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.database.records import HumanModel
from ahmss.motion import clip as clips

__all__ = ["standing"]

_UP = np.array([0.0, 0.0, 1.0])


def standing(model: HumanModel, place: Sequence[float], facing_deg: float) -> tuple[Array, Array]:
    """The pose in which a human begins: its own `stand.npz` where there is one, else upright.

    Args:
        model: of humandb.
        place: x, y on the floor, metres.
        facing_deg: heading, degrees about z, 0 towards +x.

    Returns:
        rotations (43, 4) and root (3,) in the world.
    """
    path = model.directory / "stand.npz"
    if path.is_file():
        clip = clips.load(path)
        rotations, root = clip.rotations[0].copy(), clip.root[0].copy()
    else:
        rotations, root = model.skeleton.upright()
    turn = from_axis_angle(_UP, math.radians(facing_deg))
    rotations[0] = multiply(turn, rotations[0])
    return rotations, rotate(turn, root) + np.array([place[0], place[1], 0.0])
