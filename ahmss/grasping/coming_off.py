"""Fingers that come off what is between them and the thumb: straight past it, the way that the palm is drawn back."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.grasping.hand import Hand, Thumb

__all__ = ["coming_off"]

_THUMB_BEND = np.radians(3.0)  # that the end of a straight thumb keeps


def coming_off(hand: Hand, shape: Array) -> Array:
    """The fingers (14, 4) of a hand that slides off what it has held as fingers (14, 4).

    The knuckles stay and the ends go straight on, out of the palm and no farther in: so they pass between what is held
    and another hand about it, where they would sweep through that if they opened first.
    """
    flexion, thumb = hand.flexion(shape).copy(), hand.thumb(shape)
    flexion[:, 1] = np.clip(0.5 * np.pi - flexion[:, 0], 0.0, np.maximum(flexion[:, 1], 0.0))
    flexion[:, 2] = np.minimum(flexion[:, 2], 0.0)
    return hand.rotations(flexion, Thumb(thumb.out, thumb.rise, np.minimum(thumb.bend, _THUMB_BEND)))
