"""Where the eyes are, and which way they look when they rest."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import rotate

__all__ = ["line_of_sight"]

_BELOW = np.radians(15.0)  # the horizon, of an upright head: the normal line of sight (MIL-STD-1472)
_AT_REST = np.array([-np.sin(_BELOW), 0.0, -np.cos(_BELOW)])  # in the head's frame: x up, -z ahead


def line_of_sight(head: Array, rotation: Array, eye: Array) -> tuple[Array, Array]:
    """The eyes of a human.

    Args:
        head: (3,) the head's joint in the world, metres.
        rotation: (4,) world <- head.
        eye: (3,) the point between the eyes in the head's frame, metres (`Skeleton.eye`).

    Returns:
        The point between the eyes (3,), and the unit vector (3,) in which they look at rest; in the world.
    """
    return head + rotate(rotation, eye), rotate(rotation, _AT_REST)
