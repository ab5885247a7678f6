"""How good a grip is: what touches, how squarely the thumb meets the fingers, how deep anything is; the best one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.grasping.closing import THUMB_MOST, THUMB_SLACK, TOUCH, Fingers, Hands, close_fingers, close_thumb
from ahmss.grasping.field import Field
from ahmss.grasping.hand import FINGERS, Hand, Thumb
from ahmss.motion.steps import Steps

__all__ = ["DEEP", "HOLDS", "Cost", "Holding", "Trial", "best", "opener", "widened"]

Cost = Callable[[Array], tuple[Array, NDArray[np.bool_]]]  # of palms (n, 7): what they cost the arm, and which it takes
HOLDS = -0.4  # cosine between the thumb's normal and a finger's, below which what is between them is held
THUMB_EASY = np.radians(108.0)  # of a thumb that is not turned out to its limit
FEW = 3  # hands whose thumbs are tried
WELL = -0.85  # of the same, below which no better one is looked for
OPENED, OPENS_BY, THUMB_OPENS_BY = 0.6, np.radians(4.0), np.radians(22.0)  # of a hand that is about to close
DEEP = 0.002  # metres that skin may be within the shape
_DEPTH, _FINGER, _LINK = 150.0, 0.08, 0.03  # of a metre too deep, a finger that touches, a link that touches
# Of a thumb that lies all over the end of a wall; what of that is none; balls of its end that count, from here on.
_EDGE, _LITTLE, _PAD = 0.5, 0.15, 2
_THUMB_GAP = 40.0  # of a metre between skin and shape, the mean of the thumb's links
_GAP = 60.0  # of a metre between skin and shape, the mean of all links
_FAR_OUT = (np.radians(95.0), 1.5)  # the thumb further out than that: of a radian


@dataclass(frozen=True)
class Holding:
    """A hand that has closed.

    palm: (7,) the palm's frame in the object's. shape: (14, 4) rotations of the fingers, in the order of links;
    flexion: (4, 3) and thumb: the same as angles. touching: which of thumb, index, middle, ring and little finger
    touch. links: how many of the fingers' twelve links do. facing: cosine between the thumb's normal and that of the
    finger most opposite to it: -1 where they press against each other, 1 where one of the two is missing. depth: metres
    by which some skin is within the shape, 0 for none. wide: (14, 4) the fingers as they must be open before; None
    where any way will do. over: how far the thumb lies over the end of the wall that is held, from 0 to 1.
    """

    palm: Array
    shape: Array
    flexion: Array
    thumb: Thumb
    touching: tuple[str, ...]
    links: int
    facing: float
    depth: float
    wide: Array | None = None
    over: float = 0.0

    @property
    def holds(self) -> bool:
        """Whether it would hold the object."""
        return self.facing < HOLDS and self.depth < DEEP

    def well(self, links: int) -> bool:
        """Whether it holds so well, with so many links touching, that no better one need be looked for."""
        eased = self.thumb.out < THUMB_EASY and self.depth < 0.5 * DEEP and self.over < _LITTLE
        return eased and self.facing < WELL and self.links >= links


@dataclass(frozen=True)
class Trial:
    """Hands to be tried, C of them.

    hands: in the object's frame. palms: (C, 7) of them. curls: (K, 3) in which proportions their fingers may curl.
    rises, bends: (C, R) planes that the thumb tries, and how its end is bent meanwhile. cost: (C,) what speaks against
    each. thumb_cost: (C, R) the same of the planes. links: of fingers that are to touch, or others than the first hand
    are tried. axis: (3,) along which the wall is on which the thumb shall lie; None where there is none. opposite: how
    many fingers, from the index finger on, may be those that the thumb presses against.
    """

    hands: Hands
    palms: Array
    curls: Array
    rises: Array
    bends: Array
    cost: Array
    thumb_cost: Array
    links: int
    axis: Array | None = None
    opposite: int = 4

    def first(self) -> Trial:
        """The first hand alone, curled in the first way."""
        return replace(self.chosen(np.arange(1)), curls=self.curls[:1])

    def chosen(self, which: NDArray[np.intp]) -> Trial:
        """Some of the hands."""
        return Trial(
            self.hands.chosen(which), self.palms[which], self.curls, self.rises[which], self.bends[which],
            self.cost[which], self.thumb_cost[which], self.links, self.axis, self.opposite,
        )  # fmt: skip


def best(hand: Hand, field: Field, trial: Trial) -> Steps[Holding]:
    """Close the hands of a trial, the first alone where that will do, and give the best."""
    first = yield from _best(hand, field, trial.first())
    if len(trial.palms) == 1 or first.well(trial.links):
        return first
    yield
    return (yield from _best(hand, field, trial))


def _best(hand: Hand, field: Field, trial: Trial) -> Steps[Holding]:
    """The best by the fingers and the palm, and of a few of these the best with the thumb."""
    fingers = close_fingers(hand, trial.hands, field, trial.curls[0])
    for curl in trial.curls[1:]:
        yield
        fingers = fingers.or_better(close_fingers(hand, trial.hands, field, curl))
    palms = trial.hands.seen(np.broadcast_to(hand.palm, (len(trial.palms), *hand.palm.shape)))
    depth = -np.minimum((field.clearance(palms) - hand.palm_radius).min(axis=1), fingers.gaps.min(axis=(1, 2)))
    touching = fingers.gaps < TOUCH
    score = (
        _DEPTH * np.maximum(depth - 0.5 * DEEP, 0.0)
        - _FINGER * touching.any(axis=2).sum(axis=1)
        - _LINK * touching.sum(axis=(1, 2))
        + _GAP * fingers.loose().mean(axis=1)
        + trial.cost
    )
    if len(score) > 1:
        yield
    few = np.argsort(score)[:FEW]
    few_of = trial.chosen(few)
    of = np.repeat(few, few_of.rises.shape[1])
    rise, bend = few_of.rises.reshape(-1), few_of.bends.reshape(-1)
    thumb, gaps, touches = close_thumb(hand, trial.hands.chosen(of), field, fingers.flexion[of], rise, bend)
    facing = _facing(field, fingers, of, gaps, touches, trial.opposite)
    depth = np.maximum(depth[of], -gaps.min(axis=1))
    over = np.zeros(len(of))
    if trial.axis is not None:
        over = _over_edge(hand, field, trial.hands.chosen(of), thumb, trial.axis)
    total = (
        score[of]
        + facing
        + _DEPTH * np.maximum(depth - 0.5 * DEEP, 0.0)
        + _FAR_OUT[1] * np.maximum(thumb.out - _FAR_OUT[0], 0.0)
        + few_of.thumb_cost.reshape(-1)
        + _EDGE * over
        + _THUMB_GAP * np.clip(gaps, 0.0, 0.03).mean(axis=1)
    )
    i = int(total.argmin())
    c = int(of[i])
    names = ["thumb"] if bool((gaps[i] < TOUCH).any()) else []
    names += [name for name, on in zip(FINGERS, touching[c].any(axis=1), strict=True) if on]
    one = Thumb(thumb.out[i], thumb.rise[i], thumb.bend[i])
    shape = hand.rotations(fingers.flexion[c], one)
    return Holding(
        trial.palms[c], shape, fingers.flexion[c], one, tuple(names), int(touching[c].sum()), float(facing[i]),
        max(float(depth[i]), 0.0), over=float(over[i]),
    )  # fmt: skip


def opener(hand: Hand, holding: Holding) -> Array:
    """The fingers (14, 4) before they close into a grip: further apart, so that what is held comes between them."""
    return widened(hand, holding.flexion, holding.thumb)


def widened(hand: Hand, flexion: Array, thumb: Thumb) -> Array:
    """The same of a hand that is bent so (4, 3) and has its thumb so: as it was before it closed."""
    out = np.minimum(thumb.out + THUMB_OPENS_BY, THUMB_MOST)
    return hand.rotations(OPENED * flexion - OPENS_BY, Thumb(out, thumb.rise, THUMB_SLACK))


def _over_edge(hand: Hand, field: Field, hands: Hands, thumb: Thumb, axis: Array) -> Array:
    """How far (n) thumbs of hands (n) lie over the end of a wall along an axis: there its normal turns to that."""
    middles, radii = hand.thumb_balls(thumb)
    edges = radii[1, _PAD:, None] * axis * np.array([-1.0, 1.0])[:, None, None]  # of its skin
    balls = hands.seen(middles[:, 1, _PAD:])[:, None] + edges
    return np.abs(field.normals(balls) @ axis).max(axis=1).mean(axis=1)


def _facing(
    field: Field, fingers: Fingers, of: NDArray[np.intp], thumb_gaps: Array, thumb_touches: Array, opposite: int
) -> Array:
    """The cosine (n) between each thumb's normal and that of the finger most opposite to it; 1 where there is none."""
    normal = field.normals(fingers.touches[:, :opposite]).reshape(len(fingers.gaps), -1, 3)
    absent = fingers.gaps[:, :opposite].reshape(len(normal), -1) > TOUCH
    against = np.einsum("nkc,nmc->nkm", field.normals(thumb_touches), normal[of])
    against = np.where(absent[of][:, None] | (thumb_gaps > TOUCH)[:, :, None], 1.0, against)
    return against.min(axis=(1, 2))
