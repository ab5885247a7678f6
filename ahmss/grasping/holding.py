"""How good a grip is: what touches, how squarely the thumb meets the fingers, how deep anything is; the best one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.grasping.closing import TOUCH, Fingers, Hands, Style, close_fingers, close_thumb
from ahmss.grasping.field import Field
from ahmss.grasping.hand import FINGERS, Hand, Thumb

__all__ = ["HOLDS", "Holding", "Trial", "best"]

HOLDS = -0.4  # cosine between the thumb's normal and a finger's, below which what is between them is held
WELL = -0.85  # of the same, below which no better one is looked for
DEEP = 0.002  # metres that skin may be within the shape
_DEPTH, _FINGER, _LINK = 150.0, 0.08, 0.01  # of a metre too deep, a finger that touches, a link that touches


@dataclass(frozen=True)
class Holding:
    """A hand that has closed.

    palm: (7,) the palm's frame in the object's. shape: (14, 4) rotations of the fingers, in the order of links.
    touching: which of thumb, index, middle, ring and little finger touch. facing: cosine between the thumb's normal and
    that of the finger most opposite to it: -1 where they press against each other, 1 where one of the two is missing.
    depth: metres by which some skin is within the shape, 0 for none.
    """

    palm: Array
    shape: Array
    touching: tuple[str, ...]
    facing: float
    depth: float

    @property
    def holds(self) -> bool:
        """Whether it would hold the object."""
        return self.facing < HOLDS and self.depth < DEEP


@dataclass(frozen=True)
class Trial:
    """Hands to be tried, C of them.

    hands: in the object's frame. palms: (C, 7) of them. style: how their fingers curl. rises: (C, R) planes that the
    thumb tries. cost: (C,) what speaks against each. thumb_cost: (C, R) the same of the planes.
    """

    hands: Hands
    palms: Array
    style: Style
    rises: Array
    cost: Array
    thumb_cost: Array

    def first(self) -> Trial:
        """The first hand alone."""
        hands = Hands(self.hands.place[:1], self.hands.turn[:1])
        return Trial(hands, self.palms[:1], self.style, self.rises[:1], self.cost[:1], self.thumb_cost[:1])


def best(hand: Hand, field: Field, trial: Trial) -> Holding:
    """Close the hands of a trial, the first alone where that will do, and give the best."""
    first = _best(hand, field, trial.first())
    if len(trial.palms) == 1 or (first.facing < WELL and len(first.touching) > 4 and first.depth < 0.5 * DEEP):
        return first
    return _best(hand, field, trial)


def _best(hand: Hand, field: Field, trial: Trial) -> Holding:
    fingers = close_fingers(hand, trial.hands, field, trial.style)
    count, planes = trial.rises.shape
    of = np.repeat(np.arange(count), planes)
    thumb, thumb_gaps, thumb_touches = close_thumb(
        hand, trial.hands.chosen(of), field, fingers.flexion[of], trial.rises.reshape(-1)
    )
    palm_gaps = field.clearance(trial.hands.seen(np.broadcast_to(hand.palm, (count, *hand.palm.shape)))).min(axis=1)
    palm_gaps -= hand.palm_radius
    facing = _facing(field, fingers, of, thumb_gaps, thumb_touches)
    depth = -np.minimum.reduce([fingers.gaps.min(axis=(1, 2))[of], palm_gaps[of], thumb_gaps.min(axis=1)])
    touching = fingers.gaps < TOUCH
    score = (
        facing
        + _DEPTH * np.maximum(depth - 0.5 * DEEP, 0.0)
        - _FINGER * touching.any(axis=2).sum(axis=1)[of]
        - _LINK * touching.sum(axis=(1, 2))[of]
        + trial.cost[of]
        + trial.thumb_cost.reshape(-1)
    )
    i = int(score.argmin())
    c = int(of[i])
    names = ["thumb"] if bool((thumb_gaps[i] < TOUCH).any()) else []
    names += [name for name, on in zip(FINGERS, touching[c].any(axis=1), strict=True) if on]
    shape = hand.rotations(fingers.flexion[c], Thumb(thumb.out[i], thumb.rise[i], thumb.bend[i]))
    return Holding(trial.palms[c], shape, tuple(names), float(facing[i]), max(float(depth[i]), 0.0))


def _facing(field: Field, fingers: Fingers, of: NDArray[np.intp], thumb_gaps: Array, thumb_touches: Array) -> Array:
    """The cosine (n) between each thumb's normal and that of the finger most opposite to it; 1 where there is none."""
    normal = field.normals(fingers.touches).reshape(len(fingers.gaps), -1, 3)
    absent = fingers.gaps.reshape(len(normal), -1) > TOUCH
    against = np.einsum("nkc,nmc->nkm", field.normals(thumb_touches), normal[of])
    against = np.where(absent[of][:, None] | (thumb_gaps > TOUCH)[:, :, None], 1.0, against)
    return against.min(axis=(1, 2))
