"""How a movement spends its time: the minimum-jerk profile of reaching (Flash & Hogan 1985)."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array

__all__ = ["minimum_jerk"]


def minimum_jerk(time: Array) -> Array:
    """The share of the way (...) done at a share of the time (...), from rest to rest.

    10 t^3 - 15 t^4 + 6 t^5: no velocity and no acceleration at both ends, top speed 1.875 times the mean one.
    Times below 0 and above 1 stay at the ends.
    """
    t = np.clip(time, 0.0, 1.0)
    return t * t * t * (10.0 + t * (6.0 * t - 15.0))
