"""Hair: a cap over the skull, cut along the hairline, with locks. Drawn in centimetres like the head."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ahmss.body.array import Array
from humans.distance import Field, cone, ellipsoid, half_space, smooth_max, smooth_min
from humans.figure import Figure
from humans.head import Drawing, skull

__all__ = ["hair", "hair_band"]

Row = tuple[float, float, float, float]


def _lock(*rows: Row) -> Field:
    """A lock of hair through points x, y, z with radii."""
    cones = [cone(np.array(a[:3]), np.array(b[:3]), a[3], b[3]) for a, b in pairwise(rows)]

    def distance(q: Array) -> Array:
        d = cones[0](q)
        for other in cones[1:]:
            d = smooth_min(d, other(q), 0.5)
        return d

    return distance


def _cap(figure: Figure, thick: float) -> Field:
    """The skull grown by the hair, above a hairline from the forehead by the temples to the nape."""
    base = skull(figure)
    v = np.array
    front = half_space(v([2.6, 0.0, -2.0]), v([0.83, 0.0, -0.55]))
    nape = half_space(v([2.6, 0.0, -2.6]), v([0.60, 0.0, -0.80]))
    volume = ellipsoid(v([-2.4, 0.0, 4.0]), v([8.6, 7.9, 6.6]) if figure.female else v([8.6, 7.6, 6.3]))
    ear = ellipsoid(v([-0.2, 8.0, -2.2]), v([2.0, 1.6, 2.9] if figure.female else [2.3, 1.7, 3.3]))

    def distance(q: Array) -> Array:
        d = smooth_min(base(q) - thick, volume(q), 1.5)
        d = smooth_max(smooth_max(d, front(q), 0.5), nape(q), 0.8)
        return smooth_max(d, -ear(np.column_stack([q[:, 0], np.abs(q[:, 1]), q[:, 2]])), 0.6)

    return distance


def _woman() -> Sequence[tuple[Field, float]]:
    """Swept fringe, side locks and a tail."""
    return (
        # fringe from a parting on her left, swept over the forehead
        (_lock((4.6, 2.4, 9.3, 0.9), (8.2, 0.6, 7.2, 1.0), (8.6, -2.6, 4.9, 0.9), (6.9, -5.7, 2.3, 0.35)), 0.35),
        (_lock((4.0, 2.2, 9.5, 0.9), (7.6, -1.4, 7.6, 1.1), (7.4, -4.6, 4.8, 0.9), (5.2, -6.9, 1.2, 0.35)), 0.35),
        (_lock((5.0, 2.6, 9.0, 0.8), (8.7, 1.6, 6.4, 0.9), (9.1, -0.6, 4.5, 0.7), (8.5, -3.2, 3.3, 0.25)), 0.3),
        (_lock((4.4, 2.8, 9.2, 0.9), (7.6, 4.0, 6.8, 0.9), (6.6, 5.9, 3.6, 0.7), (5.0, 6.9, 0.6, 0.3)), 0.35),
        # in front of the ears
        (_lock((3.8, 6.6, 3.6, 0.8), (4.1, 7.2, -0.5, 0.65), (4.3, 6.7, -4.6, 0.5), (5.0, 6.0, -8.0, 0.15)), 0.4),
        (_lock((3.8, -6.6, 3.6, 0.8), (4.1, -7.2, -0.5, 0.65), (4.3, -6.7, -4.6, 0.5), (5.0, -6.0, -8.0, 0.15)), 0.4),
        # tail
        (_lock((-9.6, 0.0, 4.8, 1.3), (-11.2, 0.0, 5.2, 1.1)), 0.8),
        (_lock((-11.2, 0.0, 5.2, 1.2), (-13.4, 0.0, 3.2, 2.1), (-14.0, 0.0, -1.4, 2.2), (-13.2, 0.0, -5.6, 1.6),
               (-12.2, 0.0, -9.0, 0.3)), 0.6),
    )  # fmt: skip


def _man() -> Sequence[tuple[Field, float]]:
    """Short, brushed to one side."""
    rows: list[tuple[Field, float]] = []
    for y, lift in ((4.6, 0.0), (2.9, 0.5), (1.0, 0.8), (-1.0, 0.7), (-3.0, 0.3), (-4.9, -0.4)):
        rows.append((_lock((2.0, y + 1.0, 9.2 + 0.4 * lift, 1.5), (6.2, y + 0.5, 8.4 + lift, 1.4),
                           (8.5 - 0.08 * y * y, y - 0.9, 6.6 + 0.5 * lift, 0.6)), 0.5))  # fmt: skip
    return rows


def hair(figure: Figure) -> Field:
    """The hair in metres."""
    drawing = Drawing.of(figure)
    cap = _cap(figure, 0.7 if figure.female else 0.75)
    locks = _woman() if figure.female else _man()

    def distance(p: Array) -> Array:
        q = (p - drawing.origin) / drawing.scale
        d = cap(q)
        for lock, k in locks:
            d = smooth_min(d, lock(q), k)
        return d * drawing.scale

    return distance


def hair_band(figure: Figure) -> Field:
    """The ring that holds the tail, in metres."""
    drawing = Drawing.of(figure)
    ring = cone(np.array([-10.7, 0.0, 5.2]), np.array([-11.5, 0.0, 5.0]), 1.5, 1.5)
    return lambda p: ring((p - drawing.origin) / drawing.scale) * drawing.scale
