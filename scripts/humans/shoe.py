"""A right shoe: upper and sole, flat on the floor."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from humans.distance import Field, Loft, cone, half_space, intersect, smooth_max, smooth_min
from humans.figure import Figure

__all__ = ["SOLE_HEIGHT", "shoe"]

SOLE_HEIGHT = 0.022
# Along the foot from the heel (shares of its length): half width, sideways shift to the big toe.
_OUTLINE = ((0.0, 0.5, 0.0), (0.03, 1.9, 0.0), (0.10, 2.9, 0.0), (0.25, 3.3, 0.0), (0.45, 3.45, 0.1), (0.66, 4.5, 0.25),
            (0.80, 4.3, 0.5), (0.92, 3.2, 0.8), (0.98, 1.7, 1.0), (1.0, 0.5, 1.0))  # fmt: skip


def _outline(figure: Figure, grown: float) -> Field:
    """The shoe's print drawn up into a prism."""
    ankle = figure.bind.place("right_foot")
    scale = figure.height / 1.76
    foot = 0.152 * figure.height
    rows = np.array(_OUTLINE)
    along = (rows[:, 0] - 0.24) * foot
    along[0] -= 0.008 + grown
    along[-1] += 0.006 + grown
    half, shift = 0.01 * rows[:, 1] * scale + grown, 0.01 * rows[:, 2] * scale

    def distance(p: Array) -> Array:
        x, y = p[:, 0] - ankle[0], p[:, 1] - ankle[1]
        width = np.interp(x, along, half)
        middle = np.interp(x, along, shift)
        return np.maximum(np.abs(y - middle) - width, np.maximum(along[0] - x, x - along[-1]))

    return distance


def _sole(figure: Figure) -> Field:
    """The sole, a slab on the floor with the heel a little drawn in."""
    slab = intersect(half_space(np.zeros(3), np.array([0.0, 0.0, -1.0])),
                     half_space(np.array([0.0, 0.0, SOLE_HEIGHT]), np.array([0.0, 0.0, 1.0])))  # fmt: skip
    return intersect(_outline(figure, 0.003), slab, 0.004)


def shoe(figure: Figure) -> Field:
    """The upper over the sole, with the ankle's shaft inside the trousers."""
    ankle = figure.bind.place("right_foot")
    scale, foot = figure.height / 1.76, 0.152 * figure.height
    stations = np.array([
        [-0.26 * foot, 0.5, 3.0, 0.0], [-0.22 * foot, 2.4, 7.0, 0.0], [-0.08 * foot, 3.3, 8.4, 0.0],
        [0.10 * foot, 3.6, 8.0, 0.0], [0.25 * foot, 3.8, 6.6, 0.1], [0.42 * foot, 4.4, 5.0, 0.25],
        [0.58 * foot, 4.2, 4.3, 0.5], [0.70 * foot, 3.0, 3.6, 0.8], [0.77 * foot, 1.0, 2.4, 1.0],
    ])  # fmt: skip
    table = np.zeros((len(stations), 5))
    table[:, 0] = stations[:, 0]
    table[:, 1] = 0.01 * stations[:, 1] * scale
    table[:, 2] = 0.01 * stations[:, 2] * scale
    table[:, 3] = 0.03
    upper = Loft(np.array([ankle[0], ankle[1], 0.0]), np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0]), table, 2.3)
    shaft = cone(ankle + np.array([-0.008, 0.0, 0.05]) * scale, ankle + np.array([0.0, 0.0, -0.01]) * scale,
                 0.042 * scale, 0.042 * scale)  # fmt: skip
    floor = half_space(np.array([0.0, 0.0, 0.008]), np.array([0.0, 0.0, -1.0]))
    sole = _sole(figure)

    def distance(p: Array) -> Array:
        return smooth_min(smooth_max(smooth_min(upper(p), shaft(p), 0.03), floor(p), 0.004), sole(p), 0.003)

    return distance
