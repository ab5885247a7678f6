"""The power grip: the palm on the wall, fingers and thumb around it (Napier 1956, "The prehensile movements")."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.quaternion import between, conjugate, from_axis_angle, multiply, rotate, to_matrix
from ahmss.grasping.closing import HOOK, POWER, Hands
from ahmss.grasping.field import Field
from ahmss.grasping.hand import Hand
from ahmss.grasping.holding import Holding, Trial, best

__all__ = ["power"]

# What is tried, the first alone where that will do: metres by which the axis lies before the palm's middle, towards the
# fingers, and metres along the axis.
INTO_FINGERS = np.array([0.01, 0.0, 0.02, 0.005, 0.01, 0.01])
BESIDE = np.array([0.0, 0.0, 0.0, 0.0, -0.022, 0.022])
CURLS = np.stack([POWER, HOOK])
WRAPPED = 9  # links that touch where fingers are well around
# Planes of the thumb, out of the palm to its own side, and the bend of its end.
RISES, BENDS = np.radians([[22.0, 0.0, 40.0, 22.0, 5.0], [8.0, 8.0, 8.0, 45.0, 45.0]])
ALONG = 0.04  # metres along the axis that the palm may be from the site
SLANT = np.radians(15.0)  # by which the hand may lie askew of the axis
BACK, PAST = 0.13, 0.04  # metres before the axis where the palm begins, and behind it where it has missed
ROUNDS = 30  # of coming nearer
CLOSE = 5e-5  # metres between palm and wall that are none
X, Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


def power(hand: Hand, field: Field, grip: Array, site: Array) -> Holding | None:
    """The best power grip about a site's z, the palm coming from where it is.

    Args:
        hand: that grips.
        field: of the object, in whose frame all is.
        grip: (7,) the palm's frame at present.
        site: (7,) on the axis that is gripped about.

    Returns:
        The grip, which may not hold; None where the palm meets nothing on its way to the axis.
    """
    up = rotate(site[3:], Z)
    rotation = _level(grip, site[:3], up)
    inward = rotate(rotation, X)
    on_hand = conjugate(hand.grip[3:])
    q_object_hand = multiply(rotation, on_hand)
    turn = to_matrix(q_object_hand)
    height = float((grip[:3] - site[:3]) @ up)
    to_fingers = turn @ X
    height = np.clip(height + BESIDE, -ALONG, ALONG)[:, None]
    starts = site[:3] + height * up - BACK * inward - INTO_FINGERS[:, None] * (to_fingers - (to_fingers @ up) * up)
    middles = starts[:, None] + (hand.palm - hand.grip[:3]) @ turn.T
    went, met = _until_it_touches(field, middles, inward, hand.palm_radius)
    if not met.any():
        return None
    palms = np.concatenate([starts + went[:, None] * inward, np.tile(rotation, (len(starts), 1))], axis=1)[met]
    hands = Hands(palms[:, :3] - turn @ hand.grip[:3], np.broadcast_to(turn, (len(palms), 3, 3)))
    cost = (2.0 * np.abs(INTO_FINGERS - INTO_FINGERS[0]) + 5.0 * np.abs(BESIDE))[met]
    rises, bends = (np.broadcast_to(row, (len(palms), len(row))) for row in (RISES, BENDS))
    return best(hand, field, Trial(hands, palms, CURLS, rises, bends, cost, 0.15 * np.abs(rises - RISES[0]), WRAPPED))


def _level(grip: Array, axis: Array, up: Array) -> Array:
    """The rotation (4,) of a palm that faces an axis along `up`, as near to the present one as may be."""
    out = rotate(grip[3:], X)
    level = out - (out @ up) * up
    if np.linalg.norm(level) < 0.5:  # it hardly faces the axis: what counts is where it is
        level = axis - grip[:3]
        level = level - (level @ up) * up
    level = level / np.linalg.norm(level)
    rotation = multiply(between(out, level), grip[3:])
    thumb = rotate(rotation, Z)
    side = np.cross(level, up)
    askew = float(np.arctan2(thumb @ side, thumb @ up))  # it may point up or down the axis
    askew -= np.pi * round(askew / np.pi)
    return multiply(from_axis_angle(level, askew - float(np.clip(askew, -SLANT, SLANT))), rotation)


def _until_it_touches(field: Field, middles: Array, inward: Array, radius: float) -> tuple[Array, NDArray[np.bool_]]:
    """How far (C) balls (C, B, 3) go until one of each touches, and which do (C) before they are past."""
    went = np.zeros(len(middles))
    for _ in range(ROUNDS):
        gap = field.clearance(middles + went[:, None, None] * inward).min(axis=1) - radius
        went = went + np.where(went < BACK + PAST, gap, 0.0)
        if (gap < CLOSE).all():
            break
    return went, (went < BACK + PAST) & (went > 0.0)
