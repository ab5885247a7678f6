"""Pads that roll on what they hold: fingers closed anew by a hand that is turned about what is between them."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import replace

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, rotate, to_matrix
from ahmss.grasping.closing import PRECISION, THUMB_SLACK, Hands, close_fingers, close_thumb, tightened
from ahmss.grasping.field import Field
from ahmss.grasping.hand import Hand, Thumb
from ahmss.grasping.holding import Holding

__all__ = ["amiss", "rolled", "wrapped_at"]

RISES = np.radians([22.0, 8.0, 0.0, 40.0, 55.0])  # planes of a thumb that wraps, out of the palm to its own side
_THUMB, _INDEX, _OTHERS = slice(0, 2), slice(2, 5), slice(2, None)  # of the links of a hand's fingers
MOST = 0.45  # radians that a joint goes on from how it took hold


def rolled(hand: Hand, field: Field, palms: Array, holding: Holding) -> list[Holding]:
    """A precision grip closed anew, once for each other place (n, 7) of the palm in the object's frame.

    Args:
        hand: that holds.
        field: of the object, in whose frame all is.
        palms: its palm's frames.
        holding: how it took hold, from which no joint goes far.
    """
    hands, n = _hands(hand, palms), len(palms)
    flexion = close_fingers(hand, hands, field, PRECISION).flexion
    flexion = np.clip(flexion, holding.flexion - MOST, holding.flexion + MOST)
    rise, bend = np.full(n, float(holding.thumb.rise)), np.full(n, THUMB_SLACK)
    thumb, _, _ = close_thumb(hand, hands, field, flexion, rise, bend)
    out = np.clip(thumb.out, holding.thumb.out - MOST, holding.thumb.out + MOST)
    made: list[Holding] = []
    for palm, bent, *own in zip(palms, flexion, out, thumb.rise, thumb.bend, strict=True):
        one = Thumb(*own)
        made.append(replace(holding, palm=palm, shape=hand.rotations(bent, one), flexion=bent, thumb=one))
    return made


def amiss(hand: Hand, field: Field, palms: Array, shapes: Array, *, alone: bool = False) -> float:
    """Metres by which fingers (n, 14, 4) are in what they pinch at the most, or the thumb or all others are off it.

    alone: thumb and index finger hold it, and the others, in the palm, hold nothing where they touch it.
    """
    gaps = hand.gaps(field, palms, shapes)
    thumb, others = gaps[:, _THUMB].min(axis=1), gaps[:, _INDEX if alone else _OTHERS].min(axis=1)
    off, deep = np.maximum(thumb, others), -gaps.min(axis=1)
    return float(np.maximum(off, deep).max())


def wrapped_at(hand: Hand, field: Field, palms: Array, nearly: Array) -> Generator[None, None, Array]:
    """The fingers (n, 14, 4) about a bar that turns in the hand, the palm at places (n, 7) in the object's frame.

    It pauses before each place of the thumb that is tried, and after the last.

    Args:
        hand: that holds.
        field: of the object, in whose frame all is.
        palms: its palm's frames.
        nearly: (n, 14, 4) the fingers nearly closed: from a little more open than so they close until they touch.
    """
    hands = _hands(hand, palms)
    flexion = tightened(hand, hands, field, hand.flexion(nearly))
    n, tried = len(palms), list[tuple[Thumb, Array, Array]]()
    for rise in RISES:
        yield
        tried.append(close_thumb(hand, hands, field, flexion, np.full(n, rise), np.full(n, THUMB_SLACK)))
    yield
    thumb, _, _ = min(tried, key=lambda one: float(np.abs(one[1].min(axis=1)).max()))
    shapes = [hand.rotations(flexion[i], Thumb(thumb.out[i], thumb.rise[i], thumb.bend[i])) for i in range(n)]
    return np.stack(shapes)


def _hands(hand: Hand, palms: Array) -> Hands:
    """The hands of palms (n, 7)."""
    q_object_hand = multiply(palms[:, 3:], np.broadcast_to(conjugate(hand.grip[3:]), palms[:, 3:].shape))
    on_hand = np.broadcast_to(hand.grip[:3], palms[:, :3].shape)
    return Hands(palms[:, :3] - rotate(q_object_hand, on_hand), to_matrix(q_object_hand))
