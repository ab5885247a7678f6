"""A grip of thumb and index finger alone, the other fingers closed into the palm, as one takes a key between others.

They are a loose fist, and a closer one where they would be in what is held.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import conjugate, multiply, rotate, slerp
from ahmss.grasping.field import Solid
from ahmss.grasping.hand import FINGERS, SEGMENTS, Hand
from ahmss.grasping.holding import Holding, opener

__all__ = ["curled"]

CURLED = np.radians([[78.0, 98.0, 58.0], [82.0, 100.0, 60.0], [84.0, 100.0, 60.0]])
"""Bends (3, 3) of the joints of middle, ring and little finger in a loose fist."""


CLOSER = np.radians([[0, 0, 0], [0, 6, 0], [0, 12, 0], [8, 12, 0], [-10, 12, 0], [-18, 12, 0]])
"""By how much joints bend more (6, 3) than in it, where fingers would be in what is held."""

TOUCHES = 3e-4
"""Metres that balls of fingers may be in it."""

OPENS = 0.45  # of the way that a hand opens which has the room


def curled(hand: Hand, holding: Holding, solid: Solid | None = None, palms: Array | None = None) -> Holding:
    """The same grip with middle, ring and little finger in the palm, which before it closes is open little more.

    solid, palms: what is held and the palms (n, 7) in its frame that hold it: the fist keeps out of it, where it can.
    """
    flexion = holding.flexion.copy()
    flexion[1:] = CURLED if solid is None or palms is None else _out_of(hand, solid, palms)
    shape = hand.rotations(flexion, holding.thumb)
    wide = slerp(shape, _kept(hand, opener(hand, holding), shape), np.array(OPENS))
    return replace(holding, flexion=flexion, shape=shape, wide=wide)


def _out_of(hand: Hand, solid: Solid, palms: Array) -> Array:
    """The bends (3, 3) of the loosest fist whose fingers are out of a solid, each by itself, or least in it."""
    bends = CURLED + CLOSER[:, None]
    middles, radii = hand.finger_balls(np.concatenate([bends[:, :1], bends], axis=1))
    turned = multiply(palms[:, 3:], conjugate(hand.grip[3:]))[:, None, None, None, None]
    wrist = palms[:, :3] - rotate(turned[:, 0, 0, 0, 0], hand.grip[:3])
    seen = wrist[:, None, None, None, None] + rotate(turned, middles[:, 1:])
    gaps = (solid.clearance(seen) - radii[1:]).min(axis=(0, 3, 4))
    first = np.minimum(gaps, -TOUCHES).argmax(axis=0)  # of those that are out of it the loosest
    return bends[first, np.arange(3)]


def _kept(hand: Hand, wide: Array, shape: Array) -> Array:
    """An open hand (14, 4) whose middle, ring and little finger are as in a shape (14, 4)."""
    first = fingers(hand.side)[0]
    links = [INDEX[f"{hand.side}_{finger}_{segment}"] - first for finger in FINGERS[1:] for segment in SEGMENTS]
    made = wide.copy()
    made[links] = shape[links]
    return made
