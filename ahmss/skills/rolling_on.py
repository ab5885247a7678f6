"""Thumb and fingers of a hand on a part: closed on it as the hand was set there, and rolling on it where the hand turns
less than the part does.
"""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.quaternion import slerp
from ahmss.grasping.hand import Hand
from ahmss.grasping.holding import Holding
from ahmss.grasping.key_grip import curled
from ahmss.grasping.rolling import rolled
from ahmss.motion.steps import Steps
from ahmss.skills.part_ways import Part, on_part

__all__ = ["held_on", "shapes_on"]

_STOPS = np.linspace(0.0, 1.0, 6)  # shares of the way at which fingers that roll are closed anew
_AT_ONCE = 2  # places between two pauses
_ROLLS = np.radians([2.0, 35.0])  # that the hand is turned about the part, for them to roll; by more it slips


def held_on(task: HumanTask, part: Part, side: str, palm: Array, holding: Holding) -> Holding:
    """The grip closed on the part by a hand that was set before it, its palm (7,), turned about it."""
    return _closed(task, side, part.site.inverse().then(part.palm(palm)), holding)


def shapes_on(task: HumanTask, part: Part, side: str, palm: Array, holding: Holding, way: Array) -> Steps[Array]:
    """The fingers (n, 14, 4) closed on the part when it has gone such shares (n) of its way; it pauses before
    every second place at which they are closed anew.

    Args:
        task: whose hand. part: what it holds. side: of the hand. palm: (7,) before the part, where it is set.
        holding: closed on it where the part sets out. way: shares.
    """
    palms = on_part(part, part.palm(palm).row()[None], _STOPS)[:, 0]
    seen = part.at(_STOPS).inverse().then(Transform.of(palms))
    turned = 2.0 * np.arccos(np.clip(np.abs(seen.rotation @ seen.rotation[0]), 0.0, 1.0))
    if not _ROLLS[0] < turned.max() < _ROLLS[1]:
        return np.broadcast_to(holding.shape, (len(way), *holding.shape.shape))
    shapes = [holding.shape]
    for k, (place, rotation) in enumerate(zip(seen.place[1:], seen.rotation[1:], strict=True)):
        if k % _AT_ONCE == 0:
            yield
        shapes.append(_closed(task, side, Transform(place, rotation), holding).shape)
    stops = np.stack(shapes)
    after = np.clip(np.searchsorted(_STOPS, way), 1, len(_STOPS) - 1)
    done = (way - _STOPS[after - 1]) / (_STOPS[after] - _STOPS[after - 1])
    return slerp(stops[after - 1], stops[after], done[:, None])


def _closed(task: HumanTask, side: str, palm: Transform, holding: Holding) -> Holding:
    """A grip closed anew by a palm that the part's site sees so."""
    thing = task.object
    assert thing is not None
    assert thing.shape is not None
    assert task.site is not None
    at_rest = thing.frame.inverse().then(task.site)  # the shape has the part so
    hand = Hand.of(task.human, side)
    again = rolled(hand, thing.shape.field(at_rest.place), at_rest.then(palm).row(), holding)
    return again if holding.wide is None else curled(hand, again)
