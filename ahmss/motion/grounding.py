"""Feet that stand: contact by height and speed together, hips that follow from it, legs solved onto the ground.

Beyond 5.3.1 of the thesis, whose lowest part slides and sinks where the next one takes over (see `hips`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.motion.contact import contacts
from ahmss.motion.hips import from_lowest_part

__all__ = ["Grounded", "ground"]


class Grounded(NamedTuple):
    """A motion whose feet stand: rotations (F, 43, 4), root (F, 3) metres, contacts (F, 2) in 0..1."""

    rotations: Array
    root: Array
    contacts: Array


def ground(skeleton: Skeleton, rotations: Array, root: Array | None, rate: float) -> Grounded:
    """The motion with feet that neither slide nor sink, the floor at z = 0.

    Args:
        skeleton: the human's measures.
        rotations: (F, 43, 4) unit quaternions, parent <- child; the hips' against the world.
        root: (F, 3) metres, the hips' way where it is known, or None: it is found from the feet alone.
        rate: frames a second.
    """
    if root is None:
        root, _ = from_lowest_part(skeleton, rotations)
        root[:, 2] -= np.median(root[:, 2]) - skeleton.upright()[1][2]
    return Grounded(rotations, root, contacts(skeleton, rotations, root, rate))
