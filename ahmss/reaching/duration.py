"""How long a reach takes: Fitts's law at ease, and no faster than hand and trunk move (Fitts 1954)."""

from __future__ import annotations

import numpy as np

__all__ = ["reach_time"]

_START, _PER_BIT = 0.35, 0.12  # seconds: relaxed reaches of 30 to 40 cm come to 0.7 to 1.0 s
_WIDTH = 0.04  # metres: how exactly a hand is to arrive where nobody says
_PEAK = 1.875  # of a minimum-jerk speed to its mean
_HAND, _TURN, _TRUNK = 0.95, 4.5, 1.3  # fastest: palm m/s, palm rad/s, trunk rad/s


def reach_time(distance: float, turn: float, lean: float, width: float = _WIDTH) -> float:
    """Seconds for a palm that goes so far, metres, and turns so far, while the trunk leans so far, radians.

    The first term is a + b log2(2 D / W); the others bound the peak speeds of the minimum-jerk profile.
    """
    by_fitts = _START + _PER_BIT * np.log2(max(2.0 * distance / width, 1.0))
    return float(max(by_fitts, _PEAK * distance / _HAND, _PEAK * turn / _TURN, _PEAK * lean / _TRUNK))
