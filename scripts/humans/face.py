"""Eyes, brows and mouth: the eyeballs behind their openings, the rest as stencils on the skin."""

from __future__ import annotations

import numpy as np
from manifold3d import Manifold
from scipy.interpolate import PchipInterpolator

from ahmss.body.array import Array
from humans.body import Stencil, prism
from humans.figure import Figure
from humans.head import EYE_BALL, Drawing

__all__ = ["eye_openings", "eyeballs", "stencils"]

_MIDDLE = 3.15  # of the opening, centimetres from the nose's plane


def _arc(points: list[tuple[float, float]], count: int = 9) -> Array:
    """A smooth curve through a few drawn points (n, 2)."""
    table = np.array(points)
    t = np.linspace(0.0, 1.0, len(table))
    s = np.linspace(0.0, 1.0, count)
    return np.column_stack([PchipInterpolator(t, table[:, 0])(s), PchipInterpolator(t, table[:, 1])(s)])


def _lids(figure: Figure) -> tuple[Array, Array]:
    """Upper and lower edge of the left eye's opening from the inner to the outer corner."""
    if figure.female:
        upper = [(1.55, -0.36), (2.05, 0.42), (3.05, 0.86), (4.05, 0.68), (4.78, 0.10)]
        lower = [(1.55, -0.36), (2.25, -0.74), (3.15, -0.90), (4.1, -0.62), (4.78, 0.10)]
    else:
        upper = [(1.65, -0.30), (2.15, 0.30), (3.05, 0.60), (3.95, 0.46), (4.66, -0.02)]
        lower = [(1.65, -0.30), (2.3, -0.60), (3.15, -0.74), (4.0, -0.56), (4.66, -0.02)]
    return _arc(upper), _arc(lower)


def _both(figure: Figure, outline: Array, near: float, far: float) -> Manifold:
    """A drawn outline on the left and its mirror, as prisms through the face."""
    drawing = Drawing.of(figure)
    shape = drawing.origin[1:] + drawing.scale * outline
    x = drawing.origin[0] + drawing.scale * np.array([near, far])
    left = prism(shape if _area(shape) > 0.0 else shape[::-1], float(x[0]), float(x[1]))
    return left + left.mirror((0.0, 1.0, 0.0))


def _one(figure: Figure, outline: Array, near: float, far: float) -> Manifold:
    """A drawn outline across the middle."""
    drawing = Drawing.of(figure)
    shape = drawing.origin[1:] + drawing.scale * outline
    x = drawing.origin[0] + drawing.scale * np.array([near, far])
    return prism(shape if _area(shape) > 0.0 else shape[::-1], float(x[0]), float(x[1]))


def _area(outline: Array) -> float:
    y, z = outline.T
    return float(0.5 * np.sum(y * np.roll(z, -1) - z * np.roll(y, -1)))


def eye_openings(figure: Figure) -> tuple[Manifold, Manifold]:
    """What is cut out of the head in front of the eyeballs: the upper and the lower half of the openings."""
    upper, lower = _lids(figure)
    top = np.concatenate([upper, [[4.0, -0.12], [2.4, -0.2]]])
    bottom = np.concatenate([lower, [[4.0, -0.10], [2.4, -0.18]]])
    return _both(figure, top, 5.9, 12.0), _both(figure, bottom, 5.9, 12.0)


def eyeballs(figure: Figure) -> Manifold:
    """Both eyeballs."""
    drawing = Drawing.of(figure)
    x, y, z, r = EYE_BALL
    ball = Manifold.sphere(r * drawing.scale, 32).translate(tuple(drawing.place(x, y, z)))
    return ball + ball.mirror((0.0, 1.0, 0.0))


def _disc(figure: Figure, y: float, z: float, radius: float, count: int = 14) -> Manifold:
    angle = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    return _both(figure, np.column_stack([y + radius * np.cos(angle), z + radius * np.sin(angle)]), 6.5, 12.0)


def _mirrored_glints(figure: Figure) -> Manifold:
    """Both eyes' reflections lie on the same side."""
    angle = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
    ring = np.column_stack([np.cos(angle), np.sin(angle)]) * 0.15
    return (_one(figure, ring + np.array([_MIDDLE + 0.24, 0.36]), 6.5, 12.0)
            + _one(figure, ring + np.array([-_MIDDLE + 0.24, 0.36]), 6.5, 12.0))  # fmt: skip


def stencils(figure: Figure) -> list[Stencil]:
    """Iris, pupil, reflection, lashes, brows and lips, in the order of painting."""
    upper, _ = _lids(figure)
    woman = figure.female
    iris = 0.98 if woman else 0.76
    thick = np.interp(np.linspace(0, 1, len(upper)), [0, 0.4, 1.0], [0.06, 0.22, 0.30] if woman else [0.05, 0.13, 0.13])
    outer = upper + np.array([0.0, 1.0]) * thick[:, None]
    if woman:
        outer[-1] += (0.30, 0.10)
    lash = np.concatenate([upper, outer[::-1]])
    lift = 0.0 if woman else -0.40
    brow_low = _arc([(1.45, 1.95 + lift), (2.6, 2.28 + lift), (4.0, 2.38 + lift), (5.3, 1.80 + lift)], 8)
    brow_high = _arc([(1.50, 2.30 + lift), (2.6, 2.62 + lift), (4.1, 2.64 + lift), (5.35, 1.86 + lift)], 8)
    if not woman:
        brow_high[:-1, 1] += 0.18
    brow = np.concatenate([brow_low, brow_high[::-1]])
    wide = 1.85 if woman else 2.2
    full = 0.9 if woman else 0.55
    seam = _arc([(-wide, -6.34), (-1.0, -6.60), (0.0, -6.64), (1.0, -6.60), (wide, -6.34)], 13)
    top = _arc([(-wide, -6.31), (-0.62, -5.98 + 0.35 * (1 - full)), (0.0, -6.12 + 0.25 * (1 - full)),
                (0.62, -5.98 + 0.35 * (1 - full)), (wide, -6.31)], 13)  # fmt: skip
    low = _arc([(-wide, -6.37), (-1.0, -7.32 + 0.3 * (1 - full)), (0.0, -7.46 + 0.3 * (1 - full)),
                (1.0, -7.32 + 0.3 * (1 - full)), (wide, -6.37)], 13)  # fmt: skip
    line = np.concatenate([seam + np.array([0.0, 0.06]), (seam - np.array([0.0, 0.06]))[::-1]])
    skin = {"skin": "lips"}
    return [
        Stencil(_disc(figure, _MIDDLE, 0.0, iris), {"white": "iris"}),
        Stencil(_disc(figure, _MIDDLE, 0.0, 0.46 * iris), {"iris": "pupil"}),
        Stencil(_mirrored_glints(figure), {"iris": "glint", "pupil": "glint"}),
        Stencil(_both(figure, lash, 5.0, 12.0), {"skin": "lash"}),
        Stencil(_both(figure, brow, 5.0, 12.0), {"skin": "brow"}),
        Stencil(_one(figure, np.concatenate([top, low[::-1]]), 5.0, 12.0), skin),
        Stencil(_one(figure, line, 5.0, 12.0), {"lips": "mouth", "skin": "mouth"}),
    ]
