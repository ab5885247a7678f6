"""Skin of head and neck. Drawn in centimetres of a head of usual size: x forward, y left, z up, eyes at z = 0."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from humans.distance import Field, Loft, cone, ellipsoid, smooth_max, smooth_min
from humans.figure import Figure
from humans.trunk import neck_axis

__all__ = ["Drawing", "head", "skull"]

EYE_FORWARD = 8.1  # the cornea's x in the drawing


@dataclass(frozen=True)
class Drawing:
    """Where the drawing of the head lies in the bind pose: metres a centimetre drawn, and its origin (3,)."""

    scale: float
    origin: Array

    @classmethod
    def of(cls, figure: Figure) -> Drawing:
        """The drawing put on the figure's eyes."""
        eye = figure.bind.at("head", figure.skeleton.eye)
        scale = 0.01 * (1.03 if figure.female else 1.10)
        return cls(scale, eye - np.array([EYE_FORWARD * scale, 0.0, 0.0]))

    def place(self, x: float, y: float, z: float) -> Array:
        """A drawn point in metres."""
        return self.origin + self.scale * np.array([x, y, z])

    def drawn(self, p: Array) -> Array:
        """Points in metres as drawn, folded onto the left half."""
        q = (p - self.origin) / self.scale
        q[:, 1] = np.abs(q[:, 1])
        return q


# Height, half width, front, back (x), for a woman and a man.
_SKULL = {
    "female": (
        (-11.2, 0.6, 7.2, 5.6), (-10.8, 1.6, 8.0, 3.8), (-10.0, 2.6, 8.3, 1.4), (-8.7, 3.4, 8.4, -0.4),
        (-7.0, 4.75, 8.4, -2.0), (-5.0, 5.75, 8.4, -4.6), (-3.0, 6.6, 8.4, -7.6), (-1.0, 6.85, 8.5, -9.2),
        (1.0, 7.0, 8.75, -9.9), (3.0, 7.15, 8.95, -10.1), (5.0, 7.0, 8.7, -9.6), (7.0, 6.1, 7.5, -8.2),
        (8.3, 4.5, 5.4, -6.0), (9.0, 2.8, 3.2, -3.8), (9.4, 0.6, 0.2, -1.0),
    ),
    "male": (
        (-11.9, 0.8, 7.0, 5.6), (-11.5, 2.3, 8.3, 3.4), (-10.5, 3.6, 8.7, 1.0), (-9.0, 4.8, 8.7, -0.8),
        (-7.0, 5.7, 8.5, -2.2), (-5.0, 6.25, 8.5, -4.8), (-3.0, 6.6, 8.5, -7.6), (-1.0, 6.85, 8.5, -9.2),
        (1.0, 7.0, 8.95, -9.9), (3.0, 7.15, 8.9, -10.1), (5.0, 7.0, 8.5, -9.6), (7.0, 6.1, 7.3, -8.2),
        (8.6, 4.5, 5.3, -6.0), (9.4, 2.8, 3.2, -3.8), (9.8, 0.6, 0.2, -1.0),
    ),
}  # fmt: skip
EYE_BALL = (5.8, 2.95, 0.0, 2.25)  # centre and radius


def skull(figure: Figure) -> Field:
    """The head without features, in drawn centimetres (N, 3) -> (N,)."""
    rows = np.array(_SKULL[figure.skeleton.sex])
    stations = np.column_stack([rows[:, 0], rows[:, 1], rows[:, 2], -rows[:, 3], np.zeros(len(rows))])
    return Loft(np.zeros(3), np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]), stations, 2.25)


def _blended(parts: list[tuple[Field, float]], base: Field) -> Field:
    """Fields added one after the other, each rounded over its own width."""

    def distance(q: Array) -> Array:
        d = base(q)
        for field, k in parts:
            d = smooth_min(d, field(q), k)
        return d

    return distance


def _features(figure: Figure) -> Field:
    """Skull with cheeks, nose, eyelids, lips and ears, drawn on the left half."""
    woman = figure.female
    big = 0.82 if woman else 1.02
    v = np.array
    nose_tip = v([9.65, 0.0, -3.3]) if woman else v([9.95, 0.0, -3.75])
    face = _blended([
        (ellipsoid(v([5.1, 3.9, -3.2]), v([2.4, 2.1, 2.2])), 2.5),
        (ellipsoid(v([4.9, 2.6, -6.2]), v([2.3, 1.7, 2.1]) if woman else v([2.4, 2.0, 2.3])), 2.0),
        (ellipsoid(v([7.4, 0.0, -9.8 if woman else -10.1]), v([1.2, 1.3, 1.1] if woman else [1.4, 2.0, 1.3])), 1.4),
        (cone(v([7.75, 0.0, 0.6]), nose_tip, 0.62 * big, 0.66 * big), 0.9),
        (ellipsoid(nose_tip, v([0.85, 0.9, 0.75]) * big), 0.5),
        (ellipsoid(nose_tip + v([-0.95, 1.05 * big, -0.25]), v([0.8, 0.62, 0.6]) * big), 0.5),
    ], skull(figure))  # fmt: skip
    socket = ellipsoid(v([9.4, 3.0, 0.1]), v([1.75, 2.1, 1.5]))
    cx, cy, cz, r = EYE_BALL
    lid = ellipsoid(v([cx, cy, cz]), v([r + 0.12, r + 0.12, r + 0.12]))
    lips = [
        (ellipsoid(v([8.35, 0.0, -6.15]), v([0.72, 2.0, 0.5])), 0.5),
        (ellipsoid(v([8.3, 0.0, -7.05]), v([0.78, 1.6, 0.55])), 0.4),
    ]
    ear = _ear()

    def distance(q: Array) -> Array:
        d = smooth_max(face(q), -socket(q), 0.9)
        if not woman:
            brow = cone(v([8.3, 1.0, 1.9]), v([7.3, 4.4, 2.0]), 0.45, 0.4)
            d = smooth_min(d, brow(q), 1.2)
        d = smooth_min(d, lid(q), 0.35)
        for field, k in lips:
            d = smooth_min(d, field(q), k)
        return smooth_min(d, ear(q), 0.35)

    return distance


def _ear() -> Field:
    """A bowl with a rim, leaning back."""
    tilt = np.radians(14.0)
    out = np.radians(24.0)
    back = np.array([[np.cos(tilt), 0.0, -np.sin(tilt)], [0.0, 1.0, 0.0], [np.sin(tilt), 0.0, np.cos(tilt)]])
    flare = np.array([[np.cos(out), -np.sin(out), 0.0], [np.sin(out), np.cos(out), 0.0], [0.0, 0.0, 1.0]])
    turn = flare.T @ back
    centre = np.array([-0.9, 7.15, -1.2])
    shell = ellipsoid(centre, np.array([1.75, 0.62, 2.9]), turn)
    bowl = ellipsoid(centre + np.array([0.35, 0.65, 0.15]), np.array([1.05, 0.55, 1.9]), turn)
    lobe = ellipsoid(centre + np.array([0.55, -0.1, -2.4]), np.array([0.7, 0.45, 0.8]))
    return lambda q: smooth_max(smooth_min(shell(q), lobe(q), 0.4), -bowl(q), 0.3)


def head(figure: Figure) -> Field:
    """Head and neck down into the collar, in metres."""
    drawing = Drawing.of(figure)
    features = _features(figure)
    high, low = neck_axis(figure)
    below = low - 0.6 * (high - low)
    neck = cone(high, low, figure.neck[0], figure.neck[1])
    root = cone(low, below, figure.neck[1], figure.neck[1] + 0.01)
    throat = cone(drawing.place(4.6, 0.0, -9.0), low + np.array([0.012, 0.0, 0.01]), 0.030, 0.036)

    def distance(p: Array) -> Array:
        column = smooth_min(smooth_min(neck(p), root(p), 0.02), throat(p), 0.03)
        return smooth_min(features(drawing.drawn(p)) * drawing.scale, column, 0.014)

    return distance
