"""Of one quaternion or vector what `quaternion` makes of many: by Python's own floats, three to ten times sooner.

Sums go in the order in which numpy goes (a sum of squares adds every other one first), so that one alone comes out as
it does among others, on most processors to the last digit.
"""

from __future__ import annotations

import math

import numpy as np

from ahmss.body.array import Array

__all__ = ["cross", "from_rotation_vector", "multiply", "normalize", "rotate"]

_LEAST = float(np.finfo(float).eps)  # what sinc takes for nothing


def multiply(p: Array, q: Array) -> Array:
    """The product p q (4.4) of quaternions (4,)."""
    a, b, c, d = p.tolist()
    w, x, y, z = q.tolist()
    return np.array((
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    ), float)  # fmt: skip


def rotate(q: Array, v: Array) -> Array:
    """The vector v (3,) turned by a unit quaternion (4,) (4.8)."""
    w, a, b, c = q.tolist()
    x, y, z = v.tolist()
    tx, ty, tz = 2.0 * (b * z - c * y), 2.0 * (c * x - a * z), 2.0 * (a * y - b * x)
    return np.array((
        x + w * tx + (b * tz - c * ty), y + w * ty + (c * tx - a * tz), z + w * tz + (a * ty - b * tx)
    ), float)  # fmt: skip


def cross(u: Array, v: Array) -> Array:
    """The cross product of vectors (3,)."""
    a, b, c = u.tolist()
    x, y, z = v.tolist()
    return np.array((b * z - c * y, c * x - a * z, a * y - b * x), float)


def normalize(q: Array) -> Array:
    """A quaternion (4,) scaled to length 1."""
    w, x, y, z = q.tolist()
    length = math.sqrt((w * w + y * y) + (x * x + z * z)) or math.nan  # as of many, where it is nothing
    return np.array((w / length, x / length, y / length, z / length))


def from_rotation_vector(x: float, y: float, z: float) -> Array:
    """The unit quaternion (4,) of a rotation vector: axis times angle, radians."""
    half = 0.5 * math.sqrt((x * x + z * z) + y * y)
    turn = math.pi * (half / math.pi) or _LEAST
    sinc = 0.5 * (float(np.sin(turn)) / turn)
    return np.array((float(np.cos(half)), sinc * x, sinc * y, sinc * z))
