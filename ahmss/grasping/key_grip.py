"""A grip of thumb and index finger alone, the other fingers closed into the palm, as one takes a key between others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import slerp
from ahmss.grasping.hand import FINGERS, SEGMENTS, Hand
from ahmss.grasping.holding import Holding, opener

__all__ = ["curled"]

CURLED = np.radians([[78.0, 98.0, 58.0], [82.0, 100.0, 60.0], [84.0, 100.0, 60.0]])
"""Bends (3, 3) of the joints of middle, ring and little finger in a loose fist."""


OPENS = 0.45  # of the way that a hand opens which has the room


def curled(hand: Hand, holding: Holding) -> Holding:
    """The same grip with middle, ring and little finger in the palm, which before it closes is open little more."""
    flexion = holding.flexion.copy()
    flexion[1:] = CURLED
    shape = hand.rotations(flexion, holding.thumb)
    wide = slerp(shape, _kept(hand, opener(hand, holding), shape), np.array(OPENS))
    return replace(holding, flexion=flexion, shape=shape, wide=wide)


def _kept(hand: Hand, wide: Array, shape: Array) -> Array:
    """An open hand (14, 4) whose middle, ring and little finger are as in a shape (14, 4)."""
    first = fingers(hand.side)[0]
    links = [INDEX[f"{hand.side}_{finger}_{segment}"] - first for finger in FINGERS[1:] for segment in SEGMENTS]
    made = wide.copy()
    made[links] = shape[links]
    return made
