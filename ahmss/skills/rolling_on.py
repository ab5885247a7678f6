"""Thumb and fingers of a hand on a part: closed on it as the hand was set there, and kept so if they go well with it.

Else they are closed anew along its way: where the hand turns less than the part does they roll on it, and where the arm
does not bring it just where it should they are on it all the same. So far apart that the part would be lost they do not
come for that.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.quaternion import slerp
from ahmss.grasping.field import Field
from ahmss.grasping.hand import Hand
from ahmss.grasping.holding import Holding
from ahmss.grasping.key_grip import curled
from ahmss.grasping.rolling import amiss, rolled
from ahmss.skills.leading import stays_held
from ahmss.skills.part_ways import Part

__all__ = ["brought", "held_on", "shapes_on"]

_STOPS = np.linspace(0.0, 1.0, 6)  # shares of the way at which fingers are looked at, and closed anew
_WELL = 0.001  # metres that skin may be in the part or off it for them to stay as they took hold
_GAINS = 3e-4  # metres that closing them anew must gain
_SLIPS = np.cos(np.radians(17.5))  # of half of what the hand turns about the part: by more it slips in the fingers
_ALONG = np.linspace(0.0, 1.0, 101)  # shares of the way at which it is looked where the part is that a palm has
_ASIDE = 1e-4  # metres that being elsewhere on the way counts as: where it stays in place all of these are alike


def held_on(task: HumanTask, part: Part, side: str, palm: Array, holding: Holding) -> Holding:
    """The grip closed on the part by a hand that was set before it, its palm (7,), turned about it."""
    hand, field, at_rest = _shape(task, side)
    seen = at_rest.then(part.site.inverse().then(part.palm(palm))).row()
    again = rolled(hand, field, seen[None], holding)[0]
    return again if holding.wide is None else curled(hand, again, field, seen[None])


def shapes_on(
    task: HumanTask, part: Part, side: str, palms: Array, way: Array, held: NDArray[np.bool_], holding: Holding
) -> Array:
    """The fingers (n, 14, 4) of a hand that comes to the part, goes with it and leaves it.

    Args:
        task: whose hand. part: what it holds. side: of the hand.
        palms: (n, 7) as the arm really brings them. way: (n,) shares of the part's way that they bring it.
        held: (n,) in which frames the fingers are closed on it.
        holding: closed on it where the part sets out.
    """
    on = np.flatnonzero(held)
    return _between(_at_stops(task, part, side, palms[on], way[on], holding), way)


def brought(part: Part, palms: Array, way: Array) -> Transform:
    """The part's site (n) where palms (n, 7) bring it that hold it, the first where it is now.

    way: (n,) shares of its way to which they should: they do not come just there.
    """
    own = Transform.of(palms[0]).inverse().apply(part.way(way[:1])[0][0])
    off = np.linalg.norm(part.way(_ALONG)[0] - Transform.of(palms).apply(own)[:, None], axis=-1)
    return part.at(_ALONG[(off + _ASIDE * np.abs(_ALONG - way[:, None])).argmin(axis=1)])


def _at_stops(task: HumanTask, part: Part, side: str, palms: Array, way: Array, holding: Holding) -> Array:
    """The fingers (stops, 14, 4) closed on the part, brought by palms (m, 7) along all of its way (m,)."""
    hand, field, at_rest = _shape(task, side)
    stops = np.minimum(np.searchsorted(way, _STOPS), len(way) - 1)
    seen = at_rest.then(brought(part, palms[stops], way[stops]).inverse().then(Transform.of(palms[stops]))).row()
    kept = np.broadcast_to(holding.shape, (len(stops), *holding.shape.shape))
    alone = holding.wide is not None
    flaw, turned = amiss(hand, field, seen, kept, alone=alone), np.abs(seen[:, 3:] @ seen[0, 3:]).min()
    if flaw < _WELL or turned < _SLIPS:
        return kept
    again = rolled(hand, field, seen, holding)
    again = [curled(hand, one, field, seen) for one in again] if alone else again
    shapes = np.stack([one.shape for one in again])
    better = amiss(hand, field, seen, shapes, alone=alone) < flaw - _GAINS
    return shapes if better and stays_held(hand.openings(shapes), stops) else kept


def _between(shapes: Array, way: Array) -> Array:
    """Fingers (n, 14, 4) when the part has gone such shares (n) of its way, of those (m, 14, 4) at the stops."""
    after = np.clip(np.searchsorted(_STOPS, way), 1, len(_STOPS) - 1)
    done = (way - _STOPS[after - 1]) / (_STOPS[after] - _STOPS[after - 1])
    return slerp(shapes[after - 1], shapes[after], done[:, None])


def _shape(task: HumanTask, side: str) -> tuple[Hand, Field, Transform]:
    """The hand, the distances from the thing that has the part, and the part's site as the shape has it."""
    thing = task.object
    assert thing is not None
    assert thing.shape is not None
    assert task.site is not None
    at_rest = thing.frame.inverse().then(task.site)
    return Hand.of(task.human, side), thing.shape.field(at_rest.place), at_rest
