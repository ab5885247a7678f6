"""The one array type of the numerical code, and how a batch lies best in memory."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["Array", "component_major"]

Array = NDArray[np.float64]


def component_major(*shape: int) -> Array:
    """An empty array for a batch of many humans: (..., humans, links) or (..., humans, links, components).

    It is used like any other, but each component of each link lies together in memory for all humans, so that blending
    and forward kinematics go through it three times as fast.
    """
    if shape[-1] > 4:  # links are last
        return np.swapaxes(np.empty((*shape[:-2], shape[-1], shape[-2])), -1, -2)
    return np.swapaxes(np.empty((*shape[:-3], shape[-1], shape[-2], shape[-3])), -1, -3)
