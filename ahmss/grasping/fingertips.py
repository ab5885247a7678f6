"""Fingertips brought to places: each finger bent, and spread a little, until its pad is there; the thumb as well.

All in the hand's frame, as in `hand`. A finger has four joints and a place three numbers: the end joint bends in
proportion to the middle one, as its tendon makes it. The pad is where the rounded end of the finger is furthest along
the way that it pushes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.body.fingertip import pad
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import between, conjugate, from_axis_angle, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.grasping.hand import FINGERS, SEGMENTS, Hand

__all__ = ["Fingertips"]

FOLLOWS = 0.6  # of the middle joint's bend, that the end joint has
LEAST, MOST = np.radians([-40.0, 95.0])  # of the knuckle
STRAIGHT, SPARE, MOST_BENT = np.radians([3.0, 20.0, 100.0])  # of the middle joint: at the least, at ease, at the most
SPREAD = np.radians(20.0)  # of the knuckle to either side
THUMB = np.radians([2.0, 75.0])  # of its end joint
ROUNDS = 5  # of finding the finger's direction for its pad
X, Y = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])


@dataclass(frozen=True, eq=False)
class Fingertips:
    """One hand whose fingertips are to be brought somewhere. ease: (2, 4) the thumb's rotations of a hand at ease."""

    hand: Hand
    ease: Array

    @classmethod
    def of(cls, skeleton: Skeleton, side: str) -> Fingertips:
        """The "right" or "left" hand of a human."""
        first = INDEX[f"{side}_thumb_proximal"]
        return cls(Hand.of(skeleton, side), skeleton.relaxed()[0][first : first + 2])

    def pads_bent(self, flexion: Array, into: Array) -> Array:
        """The pads (..., 4, 3) of fingers bent by flexions (..., 4, 3), pushing along (..., 3)."""
        bent, hand = np.cumsum(flexion, axis=-1), self.hand
        along = np.stack([np.cos(bent), hand.towards * np.sin(bent), np.zeros_like(bent)], axis=-1)
        tips = hand.roots + (along * hand.lengths[..., None]).sum(axis=-2)
        return pad(tips, along[..., 2, :], hand.radii[:, 2:], into[..., None, :])

    def finger(self, which: str, place: Array, into: Array) -> Array:
        """Rotations (F, 3, 4) of the links of a finger whose pad is at places (F, 3), pushing along (F, 3).

        What is out of the finger's reach it is bent towards.
        """
        aside, knuckle, middle = self._joints(which, place, into)
        hinge = np.array([0.0, 0.0, self.hand.towards])
        first = multiply(from_axis_angle(Y, aside), from_axis_angle(hinge, knuckle))
        return np.stack([first, from_axis_angle(hinge, middle), from_axis_angle(hinge, FOLLOWS * middle)], axis=1)

    def pad_of(self, which: str, place: Array, into: Array) -> Array:
        """Where the pad of a finger is (F, 3) that is brought to places (F, 3) as by `finger`, but stays a little bent.

        From there it can still move on any way without haste.
        """
        i, hand = FINGERS.index(which), self.hand
        aside, knuckle, middle = self._joints(which, place, into, least=SPARE)
        bent = np.stack([knuckle, knuckle + middle, knuckle + (1.0 + FOLLOWS) * middle], axis=-1)
        along = np.stack([np.cos(bent), hand.towards * np.sin(bent), np.zeros_like(bent)], axis=-1)
        spread = from_axis_angle(Y, aside)
        tip = hand.roots[i] + rotate(spread, (along * hand.lengths[i][:, None]).sum(axis=-2))
        return pad(tip, rotate(spread, along[:, 2]), float(hand.radii[i, 2]), into)

    def _joints(self, which: str, place: Array, into: Array, least: float = STRAIGHT) -> tuple[Array, Array, Array]:
        """A finger's spread, its knuckle's bend and its middle joint's (F,), radians, as `finger` wants them."""
        i, hand = FINGERS.index(which), self.hand
        joint, far = _bends(hand.lengths[i], least)
        along = into
        aside = knuckle = middle = np.zeros(len(place))
        for _ in range(ROUNDS):
            off = place - pad(hand.roots[i], along, float(hand.radii[i, 2]), into)
            aside = np.clip(np.arctan2(-off[:, 2], off[:, 0]), -SPREAD, SPREAD)
            level = np.hypot(off[:, 0], off[:, 2])
            middle = np.interp(-np.hypot(level, off[:, 1]), -far, joint)
            knuckle = np.arctan2(hand.towards * off[:, 1], level) - _slant(hand.lengths[i], middle)
            knuckle = np.clip(knuckle, LEAST, MOST)
            bent = knuckle + (1.0 + FOLLOWS) * middle
            ahead = np.cos(bent)
            along = np.stack([ahead * np.cos(aside), hand.towards * np.sin(bent), -ahead * np.sin(aside)], axis=-1)
        return aside, knuckle, middle

    def thumb(self, place: Array, into: Array) -> Array:
        """Rotations (F, 2, 4) of a thumb whose pad is at places (F, 3), pushing along (F, 3), turned as at ease."""
        hand, (one, two) = self.hand, self.hand.thumb_lengths
        hinge = np.array([0.0, 0.0, hand.towards])
        root, bent = np.repeat(self.ease[:1], len(place), axis=0), np.zeros(len(place))
        along = rotate(root, X)
        for _ in range(2 * ROUNDS):
            off = place - pad(hand.thumb_root, along, float(hand.thumb_radii[1]), into)
            far = np.linalg.norm(off, axis=1)
            cos = np.clip((far**2 - one**2 - two**2) / (2.0 * one * two), -1.0, 1.0)
            bent = np.clip(np.arccos(cos), *THUMB)
            tip = one * X + two * rotate(from_axis_angle(hinge, bent), X)
            eased = rotate(self.ease[0], tip)
            units = [v / np.linalg.norm(v, axis=-1, keepdims=True) for v in (eased, off)]
            root = multiply(between(units[0], units[1]), self.ease[0])
            along = rotate(multiply(root, from_axis_angle(hinge, bent)), X)
        return np.stack([root, from_axis_angle(hinge, bent)], axis=1)

    def thumb_pad(self, place: Array, into: Array) -> Array:
        """Where the thumb's pad is (F, 3) that is brought to places (F, 3) as far as it goes."""
        turned = self.thumb(place, into)
        one, two = self.hand.thumb_lengths
        end = multiply(turned[:, 0], turned[:, 1])
        tip = self.hand.thumb_root + one * rotate(turned[:, 0], X) + two * rotate(end, X)
        return pad(tip, rotate(end, X), float(self.hand.thumb_radii[1]), into)

    def pads(self, rotations: Array, palms: Array, into: Array) -> Array:
        """The pads (F, 5, 3) in the world, thumb first, of fingers (F, 14, 4) on palms (F, 7) that push along (3,)."""
        hand, first = self.hand, fingers(self.hand.side)[0]
        q_world_hand = multiply(palms[:, 3:], conjugate(hand.grip[3:]))
        wrist = palms[:, :3] - rotate(q_world_hand, hand.grip[:3])
        roots = [hand.thumb_root, *hand.roots]
        lengths, radii = [hand.thumb_lengths, *hand.lengths], [hand.thumb_radii, *hand.radii]
        made: list[Array] = []
        for name, root, long, thick in zip(("thumb", *FINGERS), roots, lengths, radii, strict=True):
            place, turned = wrist + rotate(q_world_hand, root), q_world_hand
            for segment, length in zip(SEGMENTS if len(long) == 3 else ("proximal", "distal"), long, strict=True):
                turned = multiply(turned, rotations[:, INDEX[f"{hand.side}_{name}_{segment}"] - first])
                place = place + rotate(turned, length * X)
            made.append(pad(place, rotate(turned, X), float(thick[-1]), into))
        return np.stack(made, axis=1)


def _bends(lengths: Array, least: float) -> tuple[Array, Array]:
    """Bends of a middle joint (n,), and how far the tip is from the knuckle then, falling."""
    joint = np.linspace(least, MOST_BENT, 200)
    return joint, np.hypot(*_planar(lengths, joint))


def _slant(lengths: Array, middle: Array) -> Array:
    """How far below the first link's direction the tip is seen from the knuckle, radians (...)."""
    ahead, down = _planar(lengths, middle)
    return np.arctan2(down, ahead)


def _planar(lengths: Array, middle: Array) -> tuple[Array, Array]:
    """The tip ahead of the knuckle and to the palm (...), the first link straight ahead."""
    end = (1.0 + FOLLOWS) * middle
    ahead = lengths[0] + lengths[1] * np.cos(middle) + lengths[2] * np.cos(end)
    return ahead, lengths[1] * np.sin(middle) + lengths[2] * np.sin(end)
