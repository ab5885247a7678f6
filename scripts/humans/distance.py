"""Signed distances in metres, negative inside: the clay of which the humans are made.

A field takes points (N, 3) and gives distances (N,). Fields are joined by a smooth minimum, so that a calf grows out of
a knee without a seam.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.interpolate import PchipInterpolator

from ahmss.body.array import Array

__all__ = [
    "Field",
    "Loft",
    "bend",
    "cone",
    "ellipsoid",
    "half_space",
    "intersect",
    "join",
    "smooth_max",
    "smooth_min",
]

Field = Callable[[Array], Array]


def smooth_min(a: Array, b: Array, k: float) -> Array:
    """The lesser of two distances, rounded where they differ by less than k."""
    h = np.maximum(k - np.abs(a - b), 0.0) / k
    return np.minimum(a, b) - h * h * (0.25 * k)


def smooth_max(a: Array, b: Array, k: float) -> Array:
    """The greater of two distances, rounded where they differ by less than k."""
    return -smooth_min(-a, -b, k)


def join(fields: Sequence[Field], k: float) -> Field:
    """The union of fields, rounded over k."""

    def distance(p: Array) -> Array:
        d = fields[0](p)
        for other in fields[1:]:
            d = smooth_min(d, other(p), k)
        return d

    return distance


def intersect(a: Field, b: Field, k: float = 1e-4) -> Field:
    """What lies in both fields; the edge between them is rounded over k."""
    return lambda p: smooth_max(a(p), b(p), k)


def bend(a: Field, b: Field, joint: Array, along: Array, width: float) -> Field:
    """One limb from two that meet at a joint: `a` before it, `b` after it, from one to the other within `width`."""
    n = along / np.linalg.norm(along)

    def distance(p: Array) -> Array:
        t = np.clip(0.5 + 0.5 * ((p - joint) @ n) / width, 0.0, 1.0)
        w = t * t * (3.0 - 2.0 * t)
        return (1.0 - w) * a(p) + w * b(p)

    return distance


def half_space(point: Array, outwards: Array) -> Field:
    """The side of a plane that `outwards` points away from."""
    n = np.asarray(outwards, float) / np.linalg.norm(outwards)
    return lambda p: (p - np.asarray(point, float)) @ n


def cone(a: Array, b: Array, ra: float, rb: float) -> Field:
    """A capsule from a to b whose radius goes from ra to rb."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    ba = b - a
    length2 = float(ba @ ba)

    def distance(p: Array) -> Array:
        t = np.clip((p - a) @ ba / length2, 0.0, 1.0)
        return np.linalg.norm(p - a - t[:, None] * ba, axis=1) - (ra + (rb - ra) * t)

    return distance


def ellipsoid(centre: Array, radii: Array, turn: Array | None = None) -> Field:
    """An ellipsoid; the columns of `turn` (3, 3) are its axes. The distance is a first-order estimate."""
    c, r = np.asarray(centre, float), np.asarray(radii, float)

    def distance(p: Array) -> Array:
        q = p - c if turn is None else (p - c) @ turn
        k0 = np.linalg.norm(q / r, axis=1)
        k1 = np.linalg.norm(q / (r * r), axis=1)
        return np.where(k0 < 1e-6, -r.min(), k0 * (k0 - 1.0) / np.maximum(k1, 1e-9))

    return distance


@dataclass(frozen=True)
class Loft:
    """A limb or trunk: cross-sections strung on a straight axis, smooth between the stations.

    origin (3,); along, front (3,) unit directions. stations (n, 5): place along the axis, half width, reach to the
    front, reach to the back, and sideways shift of the middle, metres. Cross-sections are superellipses of `power`.
    """

    origin: Array
    along: Array
    front: Array
    stations: Array
    power: float = 2.0
    _curve: PchipInterpolator = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Lay the curves through the stations."""
        table = np.asarray(self.stations, float)
        object.__setattr__(self, "_curve", PchipInterpolator(table[:, 0], table[:, 1:], axis=0))

    def __call__(self, p: Array) -> Array:
        """Distances (N,) of points (N, 3); beyond the ends the axis is cut square."""
        along = self.along / np.linalg.norm(self.along)
        front = self.front - (self.front @ along) * along
        front = front / np.linalg.norm(front)
        side = np.cross(along, front)
        q = p - self.origin
        s, v, u = q @ along, q @ front, q @ side
        low, high = float(np.asarray(self.stations)[0][0]), float(np.asarray(self.stations)[-1][0])
        width, fore, aft, shift = self._curve(np.clip(s, low, high)).T
        depth = 0.5 * (fore + aft)
        radial = _superellipse(u - shift, v - 0.5 * (fore - aft), width, depth, self.power)
        return np.maximum(radial, np.maximum(low - s, s - high))


def _superellipse(u: Array, v: Array, a: Array, b: Array, n: float) -> Array:
    """First-order distance to |u/a|^n + |v/b|^n = 1."""
    a, b = np.maximum(a, 1e-4), np.maximum(b, 1e-4)
    x, y = np.abs(u) / a, np.abs(v) / b
    total = np.maximum(x**n + y**n, 1e-9)
    g = total ** (1.0 / n)
    slope = g ** (1.0 - n) * np.hypot(x ** (n - 1.0) / a, y ** (n - 1.0) / b)
    return np.maximum((g - 1.0) / np.maximum(slope, 1e-6), -np.minimum(a, b))
