"""Fingers that go around a bar and come off it: they are about half closed as the palm comes the last of its way to it.

Opened there as wide as they come they would be in what is under it, as a telephone under its handset.
"""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.motion.easing import minimum_jerk

__all__ = ["HALF", "half_closed"]

HALF = 0.4
"""How far they are closed when the palm is there."""

_NEAR = 0.06  # metres of its way in which they begin


def half_closed(off: Array) -> Array:
    """How far fingers are closed (n), 0 to 1, of a palm that is so many metres (n) before the bar."""
    return HALF * minimum_jerk(1.0 - np.clip(off / _NEAR, 0.0, 1.0))
