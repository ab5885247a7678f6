"""Fingers that go around a bar and come off it: they are about half closed as the palm comes the last of its way to it.

Opened there as wide as they come they would be in what is under it, as a telephone under its handset. Those that pinch
a margin are closed farther, for the desk that is behind their tips.
"""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.motion.easing import minimum_jerk

__all__ = ["half_closed", "half_of"]

_HALF, _PINCHED = 0.4, 0.7  # how far they are closed when the palm is there: about a bar; on a margin
_NEAR = 0.06  # metres of its way in which they begin


def half_of(grip: str | None) -> float:
    """How far, 0 to 1, fingers are closed when the palm is there, of a site with such a grip."""
    return _PINCHED if grip == "precision" else _HALF


def half_closed(off: Array, grip: str | None) -> Array:
    """How far fingers are closed (n), 0 to 1, of a palm that is so many metres (n) before such a site."""
    return half_of(grip) * minimum_jerk(1.0 - np.clip(off / _NEAR, 0.0, 1.0))
