"""Where the hips go over the feet: the linear inverted pendulum, solved for a plan that is known ahead.

A body whose weight is over c while it pushes at p on the floor moves by c'' = w^2 (c - p). The one motion that stays
bounded before and after is p smoothed by (w / 2) exp(-w |t|): so the weight goes over the foot that will bear before
the other is lifted, sways with the steps, and is caught at the end, whatever the steps are (Kajita et al. 2001).
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_banded

from ahmss.body.array import Array

__all__ = ["pendulum"]

_PADDING = 4.0  # seconds at rest before and after


def pendulum(push: Array, stiffness: float, rate: float) -> Array:
    """The weight's places (F, 2) for the places pushed at (F, 2), metres, at rest over both ends long before and after.

    Args:
        push: at even times.
        stiffness: w, 1/s.
        rate: times a second.
    """
    extra = round(_PADDING * rate)
    padded = np.concatenate([np.repeat(push[:1], extra, 0), push, np.repeat(push[-1:], extra, 0)])
    n, k = len(padded), (rate / stiffness) ** 2
    bands = np.empty((3, n))
    bands[0], bands[2] = -k, -k
    bands[1] = 1.0 + 2.0 * k
    bands[1, [0, -1]] = 1.0 + k
    return solve_banded((1, 1), bands, padded)[extra:-extra]
