"""The leans among which a posture is sought: numbers for the trunk's turn, its lean, the hips' drop, the lean's veer.

Leans are radians, drops metres. A lean goes towards the place, but for its veer, radians to the left.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array

__all__ = ["Leans", "past", "towards"]

_LEANS, _DROPS = np.radians([0.0, 14.0, 32.0, 55.0, 80.0, 105.0]), (0.0, 0.12, 0.3, 0.5)
_SHARES, _SHARE = np.array([0.0, 0.5, 1.0]), 0.25
_TURNS, _VEERS = np.radians([-60.0, -30.0, 0.0, 30.0, 60.0]), np.radians([-70.0, -35.0, 0.0, 35.0, 70.0])
_STEP = np.radians(15.0), np.radians(9.0), 0.09, np.radians(18.0)
_MOST_LEAN, _MOST_DROP = np.radians(115.0), 0.6
_BENT = 2  # of the leans, from which on one comes to what is low


@dataclass(frozen=True, eq=False)
class Leans:
    """some: of each of the four, those looked at first. steps (4,): how far from the best of them others are.

    shares: whether turns are shares of what it takes to turn to the place, rather than radians.
    """

    some: Sequence[Array]
    steps: Array
    shares: bool

    def grid(self) -> Array:
        """The numbers (n, 4) looked at first."""
        return _all(self.some)

    def around(self, chosen: Array, share: float) -> Array:
        """Those (n, 4) a share of a step from the chosen (4,), no farther turned or veering than the first."""
        off = _all([np.array([-1.0, 0.0, 1.0]) if step else np.zeros(1) for step in self.steps])
        turns, _, _, veers = self.some
        low, high = (turns.min(), 0.0, 0.0, veers.min()), (turns.max(), _MOST_LEAN, _MOST_DROP, veers.max())
        return np.clip(chosen + share * off * self.steps, low, high)

    def turned(self, chosen: Array, turn: float) -> Array:
        """Numbers (n, 4) with turns in radians, of who turns to the place by so many."""
        return chosen * (turn, 1.0, 1.0, 1.0) if self.shares else chosen


def towards(low: bool) -> Leans:
    """Of who turns and leans to a place; low: whether one bends the knees for it altogether."""
    steps = np.array([_SHARE, *_STEP[1:3], 0.0])
    return Leans((_SHARES, _LEANS, _drops(low), np.zeros(1)), steps, True)


def past(low: bool) -> Leans:
    """Of who turns either way, and leans past it."""
    return Leans((_TURNS, _LEANS[_BENT:], _drops(low), _VEERS), np.array(_STEP), False)


def _drops(low: bool) -> Array:
    """Nobody sits down for what is high."""
    return np.array(_DROPS if low else _DROPS[:2])


def _all(some: Sequence[Array]) -> Array:
    """All combinations (n, k) of k numbers."""
    return np.stack([a.ravel() for a in np.meshgrid(*some, indexing="ij")], axis=-1)
