"""A hand that comes to a round thing which somebody else holds: how clear it is of theirs when it has closed there."""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.body.array import Array
from ahmss.body.quaternion import rotate
from ahmss.body.skeleton import Skeleton
from ahmss.grasping.hand import Hand
from ahmss.motion.fingers import Cylinder, closed
from ahmss.motion.steps import Steps
from ahmss.reaching.handpoints import placed_points

__all__ = ["clear_of_hand"]

_EACH = 3  # balls: every so many along a link, its ends among them
_UP = np.array([0.0, 0.0, 1.0])


def clear_of_hand(
    skeleton: Skeleton, side: str, palms: Array, theirs: Transform, their_side: str, axis: Transform, radius: float
) -> Steps[Array]:
    """Metres (n) between the skin of hands that are closed around a thing, and of another's hand; negative in that.

    Args:
        skeleton: whose hands; the other's is taken to be as large. side: the hand. palms: (n, 7) at the thing, about
            its axis. theirs, their_side: the other's palm in the world.
        axis: of the thing, its z, in the world. radius: of the thing, metres.
    """
    there, thick = _skin(skeleton, their_side, theirs, axis, radius)
    yield
    own, own_thick = _skin(skeleton, side, Transform.of(palms[0]), axis, radius)
    yield
    there = placed_points(skeleton, their_side, theirs.row()[None], there)[0] - axis.place
    points = placed_points(skeleton, side, palms, own) - axis.place
    squared = (points**2).sum(axis=-1)[..., None] + (there**2).sum(axis=-1) - 2.0 * points @ there.T
    return (np.sqrt(np.maximum(squared, 0.0)) - own_thick[:, None] - thick).min(axis=(1, 2))


def _skin(skeleton: Skeleton, side: str, palm: Transform, axis: Transform, radius: float) -> tuple[Array, Array]:
    """Points (m, 3) of a hand closed around a thing, from the wrist in its own frame, and how thick it is there (m)."""
    hand = Hand.of(skeleton, side)
    seen = palm.then(Transform.of(hand.grip).inverse()).inverse().then(axis)
    middles, radii = hand.balls(closed(skeleton, side, Cylinder(seen.place, rotate(seen.rotation, _UP), radius)))
    points = np.concatenate([middles[:, ::_EACH].reshape(-1, 3), hand.palm])
    return points, np.concatenate([radii[:, ::_EACH].ravel(), np.full(len(hand.palm), hand.palm_radius)])
