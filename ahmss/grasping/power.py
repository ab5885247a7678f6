"""The power grip: the palm on the wall, fingers and thumb around it (Napier 1956, "The prehensile movements")."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import between, conjugate, from_axis_angle, multiply, rotate, to_matrix
from ahmss.grasping.closing import HOOK, POWER, Hands
from ahmss.grasping.field import Field
from ahmss.grasping.hand import Hand
from ahmss.grasping.holding import Cost, Holding, Trial, best
from ahmss.grasping.hook import hook, until_it_touches
from ahmss.motion.steps import Steps

__all__ = ["hooked", "is_thick", "power", "power_at"]

# What is tried, the first alone where that will do: metres by which the axis lies before the palm's middle, towards the
# fingers, and metres along the axis.
INTO_FINGERS = np.array([0.01, 0.0, 0.02, 0.005, 0.01, 0.01])
BESIDE = np.array([0.0, 0.0, 0.0, 0.0, -0.022, 0.022])
CURLS = np.stack([POWER, HOOK])
WRAPPED = 9  # links that touch where fingers are well around
# Planes of the thumb, out of the palm to its own side, and the bend of its end.
RISES, BENDS = np.radians([[22.0, 0.0, 40.0, 22.0, 5.0], [8.0, 8.0, 8.0, 45.0, 45.0]])
THIN, AROUND = 0.016, np.radians(120.0)  # half of what fingers go around, metres, and how far they are bent then
BESIDE_IT = 0.04  # metres from the axis at which a thumb is not on it
ALONG = 0.04  # metres along the axis that the palm may be from the site
SLANTS = np.radians([15.0, 30.0])  # by which the hand may lie askew of the axis; of what is thick where the arm asks
BACK = 0.13  # metres before the axis where the palm begins
X, Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


def power(hand: Hand, field: Field, grip: Array, site: Array, cost: Cost | None = None) -> Steps[Holding | None]:
    """The best power grip about a site's z, the palm coming from where it is; fingers through a loop where it has one.

    Args:
        hand: that grips.
        field: of the object, in whose frame all is.
        grip: (7,) the palm's frame at present.
        site: (7,) on the axis that is gripped about.
        cost: of palms, for an arm that can't turn the hand to each: what has a loop is held from where it can.

    Returns:
        The grip, which may not hold; None where the palm meets nothing on its way to the axis.
    """
    up, thick = rotate(site[3:], Z), is_thick(field, site)
    wrapped = yield from _wrapped(hand, field, grip, site, _level(grip, site[:3], up))
    if wrapped is not None and wrapped.holds:
        brought = cost is None or bool(cost(wrapped.palm[None])[1][0])
        if thick and not brought:
            yield
            other = yield from _wrapped(hand, field, grip, site, _level(grip, site[:3], up, SLANTS[1]))
            return other if other is not None and other.holds else wrapped
        if thick or (brought and _is_around(hand, wrapped, site)):
            return wrapped
    yield
    return (yield from hooked(hand, field, grip, site, cost)) or wrapped


def hooked(hand: Hand, field: Field, grip: Array, site: Array, cost: Cost | None = None) -> Steps[Holding | None]:
    """The best grip of fingers that go around a bar along a site's z, the palm off it; arguments as of `power`."""
    return hook(hand, field, _level(grip, site[:3], rotate(site[3:], Z)), site, cost)


def power_at(hand: Hand, field: Field, palm: Array, site: Array) -> Steps[Holding]:
    """How fingers and thumb close about a site's z (7,) with the palm where it is (7,), which they may not hold."""
    turn = to_matrix(multiply(palm[3:], conjugate(hand.grip[3:])))
    hands = Hands((palm[:3] - turn @ hand.grip[:3])[None], turn[None])
    return (yield from best(hand, field, _trial(hands, palm[None], np.zeros(1), rotate(site[3:], Z))))


def is_thick(field: Field, site: Array) -> bool:
    """Whether what is at a site (7,) is full, or hollow: nothing there that fingers go around."""
    return abs(float(field.alone.clearance(site[:3]))) > THIN


def _is_around(hand: Hand, holding: Holding, site: Array) -> bool:
    """Whether the fingers are bent around what is thin, and the thumb is on it and not on what is beside it."""
    pad = hand.thumb_balls(holding.thumb)[0][1, -2]
    q_object_hand = multiply(holding.palm[3:], conjugate(hand.grip[3:]))
    off = holding.palm[:3] + rotate(q_object_hand, pad - hand.grip[:3]) - site[:3]
    up = rotate(site[3:], Z)
    aside = float(np.linalg.norm(off - (off @ up) * up))
    return aside < BESIDE_IT and float(holding.flexion.sum(axis=1).mean()) > AROUND


def _wrapped(hand: Hand, field: Field, grip: Array, site: Array, rotation: Array) -> Steps[Holding | None]:
    """The palm on the wall, fingers and thumb around it."""
    up = rotate(site[3:], Z)
    inward = rotate(rotation, X)
    on_hand = conjugate(hand.grip[3:])
    q_object_hand = multiply(rotation, on_hand)
    turn = to_matrix(q_object_hand)
    height = float((grip[:3] - site[:3]) @ up)
    to_fingers = turn @ X
    height = np.clip(height + BESIDE, -ALONG, ALONG)[:, None]
    starts = site[:3] + height * up - BACK * inward - INTO_FINGERS[:, None] * (to_fingers - (to_fingers @ up) * up)
    middles = starts[:, None] + (hand.palm - hand.grip[:3]) @ turn.T
    # What else is about is asked of the grip that is found: a palm begins farther back than a hand comes from.
    went, met = until_it_touches(field.alone, middles, np.broadcast_to(inward, (len(middles), 3)), hand.palm_radius)
    if not met.any():
        return None
    palms = np.concatenate([starts + went[:, None] * inward, np.tile(rotation, (len(starts), 1))], axis=1)[met]
    hands = Hands(palms[:, :3] - turn @ hand.grip[:3], np.broadcast_to(turn, (len(palms), 3, 3)))
    cost = (2.0 * np.abs(INTO_FINGERS - INTO_FINGERS[0]) + 5.0 * np.abs(BESIDE))[met]
    return (yield from best(hand, field, _trial(hands, palms, cost, up)))


def _trial(hands: Hands, palms: Array, cost: Array, up: Array) -> Trial:
    rises, bends = (np.broadcast_to(row, (len(palms), len(row))) for row in (RISES, BENDS))
    return Trial(hands, palms, CURLS, rises, bends, cost, 0.15 * np.abs(rises - RISES[0]), WRAPPED, up)


def _level(grip: Array, axis: Array, up: Array, slant: float = SLANTS[0]) -> Array:
    """The rotation (4,) of a palm that faces an axis along `up`, as near to the present one as may be.

    slant: radians by which it may lie askew of the axis.
    """
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
    return multiply(from_axis_angle(level, float(np.clip(askew, -slant, slant)) - askew), rotation)
