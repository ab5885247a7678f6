"""The pad of a finger: what of its rounded end touches what it pushes, which is not where its bone ends."""

from __future__ import annotations

from ahmss.body.array import Array

__all__ = ["pad"]

_ROUND, _BEHIND = 0.92, 0.85  # of the last link's radius: how round its end is, and how far behind the tip its middle


def pad(tip: Array, along: Array, radius: Array | float, into: Array) -> Array:
    """Where fingertips touch what they push.

    Args:
        tip: (..., 3) where the last links end. along: (..., 3) their directions, units. radius: of these links,
            metres, to be broadcast with these. into: (..., 3) the directions in which they push, units.

    Returns:
        (..., 3) of the rounded ends what is furthest along `into`.
    """
    return tip + radius * (_ROUND * into - _BEHIND * along)
