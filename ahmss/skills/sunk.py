"""How deep a hand that holds something would be in what that lies on, or is to lie on: under it there is a desk."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.reaching.handpoints import own_points, placed_points
from ahmss.reaching.prism import Prism

__all__ = ["SUNK", "sunk"]

SUNK = 0.004
"""Metres that the bones of fingers may be in it."""


def sunk(task: HumanTask, side: str, palms: Array, shape: Array, prisms: Sequence[Prism]) -> Array:
    """Metres (n) that the bones of hands are in things at the most, negative outside; -inf where there is none.

    Args:
        side: the hand. palms: (n, 7) in the world. shape: (14, 4) rotations of the fingers. prisms: the things.
    """
    points = placed_points(task.human, side, palms, own_points(task.human, side, shape))
    return np.max([np.full(len(points), -np.inf), *(-one.signed(points).min(axis=-1) for one in prisms)], axis=0)
