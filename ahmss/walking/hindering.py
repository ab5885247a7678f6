"""Who is waited for on a walk, and what a person is told of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from ahmss.body.array import Array
from ahmss.walking.obstacles import Obstacles
from ahmss.walking.walkers import Walker

__all__ = ["TAKEN", "in_vain", "waits"]

TAKEN = 0.53
"""Metres from a goal within which somebody stands where one is to stand."""

_OFF, _CLEAR = 1.0, 0.3  # metres from a way and from others, and from things, of who has moved
_AWAY = np.arange(0.4, 2.5, 0.2)  # metres that they go
_AROUND = np.stack([[np.cos(a), np.sin(a)] for a in np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)])
_CLOSE = 0.8  # metres from it within which they are too near for one to stand there


def waits(others: Sequence[Walker], way: Array, goal: Array) -> str:
    """What is told at once of who waits on a way (n, 2) round things to a goal (2,)."""
    other, there = _hindering(others, way, goal)
    return f"waits for {_name(other)}, who is {there or 'in the way'}"


def in_vain(others: Sequence[Walker], way: Array, goal: Array, outlines: Sequence[Array] = ()) -> str:
    """What is said of who has waited on a way (n, 2) round things to a goal (2,) in vain, and what to do.

    outlines: rings (k, 2) of what stands on the floor: who hinders is to go where there is room.
    """
    other, there = _hindering(others, way, goal)
    move = "ask them to move"
    if other is not None and other.name and (room := _room_for(other, others, way, outlines)) is not None:
        move += f", as by `{other.name}: do floor walk to {_spoken(room)}`"
    if there:
        return f"{_name(other)} stands in the way, {there}, and does not go; {move}"
    return f"{_name(other)} stands in the way and does not go; take another way, or {move}"


def _room_for(other: Walker, others: Sequence[Walker], way: Array, outlines: Sequence[Array]) -> Array | None:
    """The place (2,) nearest to somebody, straight there, that is off a way (n, 2) to its end, things and others."""
    line = shapely.LineString(way if len(way) > 1 else np.repeat(way, 2, axis=0))
    things = Obstacles.of(outlines, _CLEAR)
    for away in _AWAY:
        for place in other.place + away * _AROUND:
            room = min((float(np.linalg.norm(one.place - place)) for one in others if one is not other), default=np.inf)
            if line.distance(shapely.Point(place)) < _OFF or room < _OFF:
                continue
            goes = shapely.LineString([other.place, place])
            if not shapely.intersects(things.shapes, goes).any() and (things.clearance(place) >= _CLEAR).all():
                return place
    return None


def _hindering(others: Sequence[Walker], way: Array, goal: Array) -> tuple[Walker | None, str]:
    """Who is waited for: who is at the goal, else who is, or comes, nearest to the way; how they are at the goal."""
    line = shapely.LineString(way if len(way) > 1 else np.repeat(way, 2, axis=0))
    if not others:
        return None, ""
    off = [float(np.linalg.norm(other.place - goal)) for other in others]
    nearest = int(np.argmin(off))
    if off[nearest] < _CLOSE:
        beside = "" if off[nearest] < TAKEN else "too near to "
        return others[nearest], f"{beside}where one is to stand ({_spoken(goal)})"
    return min(others, key=lambda other: float(line.distance(_goes(other)))), ""


def _goes(other: Walker) -> shapely.Geometry:
    """Where somebody is, and where they tell that they go."""
    return shapely.Point(other.place) if other.way is None else shapely.LineString(np.vstack([other.place, other.way]))


def _name(other: Walker | None) -> str:
    return (other.name if other is not None else "") or "somebody"


def _spoken(place: Array) -> str:
    return "{:.2f} {:.2f}".format(*place)
