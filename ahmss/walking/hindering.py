"""Who is waited for on a walk, and what a person is told of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from ahmss.body.array import Array
from ahmss.walking.walkers import Walker

__all__ = ["in_vain", "waits"]

_APART = 0.75  # metres from a goal within which somebody is where one is to stand


def waits(others: Sequence[Walker], place: Array, goal: Array) -> str:
    """What is told at once of who waits at a place (2,) on the way to a goal (2,)."""
    name, there = _hindering(others, place, goal)
    return f"waits for {name}, who is " + (f"where one is to stand ({_spoken(goal)})" if there else "in the way")


def in_vain(others: Sequence[Walker], place: Array, goal: Array) -> str:
    """What is said of who has waited at a place (2,) on the way to a goal (2,) in vain, and what to do."""
    name, there = _hindering(others, place, goal)
    if there:
        return f"{name} stands in the way, where one is to stand ({_spoken(goal)}), and does not go; ask them to move"
    return f"{name} stands in the way and does not go; take another way, or ask them to move"


def _hindering(others: Sequence[Walker], place: Array, goal: Array) -> tuple[str, bool]:
    """Who is waited for: who stands at the goal, else who is nearest to the way; whether they are at the goal."""
    there = [other for other in others if np.linalg.norm(other.place - goal) < _APART]
    line = shapely.LineString(np.stack([place, goal]))
    near = sorted(there or others, key=lambda other: float(line.distance(shapely.Point(other.place))))
    return (near[0].name if near else "") or "somebody", bool(there)


def _spoken(place: Array) -> str:
    return "{:.2f} {:.2f}".format(*place)
