"""How deep a hand that holds something would be in what that lies on, or is to lie on: under it there is a desk."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.quaternion import slerp
from ahmss.grasping.hand import Hand
from ahmss.grasping.holding import widened
from ahmss.reaching.handpoints import placed_points
from ahmss.reaching.prism import Prism
from ahmss.skills.around import half_of

__all__ = ["SUNK", "lain_on", "sunk", "sunk_going"]

SUNK = 0.004
"""Metres that the skin of fingers may be in it, as it is told: a table as if it were solid down to the floor."""

_EACH = 3  # balls: every so many along a link, its ends among them
_SKIN = 0.02  # metres: no finger is thicker
_OPEN = np.array([0.0, 0.5, 1.0])  # of how far they are open with the palm there


def sunk(task: HumanTask, side: str, palms: Array, shape: Array, prisms: Sequence[Prism], grip: str | None) -> Array:
    """Metres (n) that the skin of hands is in things at the most, as they hold and as they open there; negative
    outside, -inf where there is none.

    Args:
        side: the hand. palms: (n, 7) in the world. shape: (14, 4) rotations of the fingers as they hold.
        prisms: the things. grip: the site's, that says how far they open there.
    """
    hand = Hand.of(task.human, side)
    wide = widened(hand, hand.flexion(shape), hand.thumb(shape))
    shapes = slerp(shape, wide, (1.0 - half_of(grip)) * _OPEN[:, None])
    middles, radii = (balls[..., ::_EACH, :] if balls.ndim > 2 else balls[:, ::_EACH] for balls in hand.balls(shapes))
    deep = np.full(len(palms), -np.inf)
    for own in middles.reshape(len(shapes), -1, 3):
        points = placed_points(task.human, side, palms, own)
        for one in prisms:
            deep = np.maximum(deep, (radii.ravel() - one.signed(points)).max(axis=-1))
    return deep


def sunk_going(task: HumanTask, side: str, palms: Array, shapes: Array, prisms: Sequence[Prism]) -> float:
    """Metres that the skin of a hand that goes is in things at the most; negative outside, -inf where there is none.

    Args:
        side: the hand. palms: (n, 7) in the world, shapes: (n, 14, 4) of its fingers, on its way. prisms: the things.
    """
    middles, radii = Hand.of(task.human, side).balls(shapes)
    own = middles[..., ::_EACH, :].reshape(len(palms), -1, 3)
    points = np.concatenate(
        [placed_points(task.human, side, palm[None], one) for palm, one in zip(palms, own, strict=True)]
    )
    near = [one for one in prisms if one.meets(points.min(axis=(0, 1)) - _SKIN, points.max(axis=(0, 1)) + _SKIN)]
    return max((float((radii[:, ::_EACH].ravel() - one.signed(points)).max()) for one in near), default=-np.inf)


def lain_on(thing: WorldObject, prisms: Sequence[Prism]) -> list[Prism]:
    """What a thing lies on or beside: prisms but its own, those that it lies in no higher than where it lies in them.

    A telephone is told as high as its hook; its handset lies deeper, and there fingers go around it.
    """
    assert thing.shape is not None
    low = float(thing.frame.apply(thing.shape.vertices)[:, 2].min())
    others = (one for one in prisms if not one.sought)
    return [
        replace(one, high=low) if one.low < low < one.high and one.over(thing.frame.place[None])[0] else one
        for one in others
    ]
