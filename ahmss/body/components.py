"""Quaternions and vectors as tuples of components, for code that serves one pose and a batch alike.

A component is a float, or an array of any shape. For one pose Python's own floats are several times faster than arrays
of four numbers; for a batch each component is one contiguous array. `FLOATS` and `ARRAYS` are the functions of each.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

__all__ = [
    "ARRAYS",
    "FLOATS",
    "FREE",
    "Functions",
    "Quaternion",
    "Scalar",
    "Vector",
    "about",
    "between",
    "conjugate",
    "cross",
    "dot",
    "multiply",
    "nlerp",
    "on_side_of",
    "relative",
    "rotate",
    "saturate",
    "twist",
]

FREE = 0.7
"""The share of a limit within which `saturate` changes nothing."""

Scalar = Any  # a float or an array
Vector = tuple[Scalar, Scalar, Scalar]
Quaternion = tuple[Scalar, Scalar, Scalar, Scalar]


class Functions(NamedTuple):
    """What floats and arrays call by different names; `where` evaluates both its values."""

    sqrt: Callable[[Scalar], Scalar]
    sin: Callable[[Scalar], Scalar]
    cos: Callable[[Scalar], Scalar]
    acos: Callable[[Scalar], Scalar]
    atan2: Callable[[Scalar, Scalar], Scalar]
    exp: Callable[[Scalar], Scalar]
    maximum: Callable[[Scalar, Scalar], Scalar]
    minimum: Callable[[Scalar, Scalar], Scalar]
    where: Callable[[Any, Scalar, Scalar], Scalar]


def _choose(condition: bool, a: float, b: float) -> float:
    return a if condition else b


FLOATS = Functions(math.sqrt, math.sin, math.cos, math.acos, math.atan2, math.exp, max, min, _choose)
ARRAYS = Functions(np.sqrt, np.sin, np.cos, np.arccos, np.arctan2, np.exp, np.maximum, np.minimum, np.where)


def multiply(p: Quaternion, q: Quaternion) -> Quaternion:
    """The product p q (4.4)."""
    a, b, c, d = p
    w, x, y, z = q
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )


def conjugate(q: Quaternion) -> Quaternion:
    """The conjugate q* (4.5)."""
    return (q[0], -q[1], -q[2], -q[3])


def relative(p: Quaternion, q: Quaternion) -> Quaternion:
    """The product p* q: q as seen from p."""
    a, b, c, d = p
    w, x, y, z = q
    return (
        a * w + b * x + c * y + d * z,
        a * x - b * w - c * z + d * y,
        a * y + b * z - c * w - d * x,
        a * z - b * y + c * x - d * w,
    )


def rotate(q: Quaternion, v: Vector) -> Vector:
    """The vector v turned by q: q v q* (4.8)."""
    w, a, b, c = q
    x, y, z = v
    tx = 2.0 * (b * z - c * y)
    ty = 2.0 * (c * x - a * z)
    tz = 2.0 * (a * y - b * x)
    return (x + w * tx + b * tz - c * ty, y + w * ty + c * tx - a * tz, z + w * tz + a * ty - b * tx)


def dot(u: Vector, v: Vector) -> Scalar:
    """The inner product."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def cross(u: Vector, v: Vector) -> Vector:
    """The outer product."""
    return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


def about(m: Functions, axis: Vector, angle: Scalar) -> Quaternion:
    """The turn by an angle, radians, about a unit axis."""
    half = 0.5 * angle
    sine = m.sin(half)
    return (m.cos(half), axis[0] * sine, axis[1] * sine, axis[2] * sine)


def between(m: Functions, u: Vector, v: Vector) -> Quaternion:
    """The smallest turn from direction u to direction v, of any length > 0; for opposite ones some half turn."""
    scale = m.sqrt(dot(u, u) * dot(v, v))
    w = scale + dot(u, v)
    x, y, z = cross(u, v)
    opposite = w < 1e-9 * scale
    if m is FLOATS and not opposite:  # as a rule: the rest would change nothing
        length = m.sqrt(w * w + x * x + y * y + z * z)
        return (w / length, x / length, y / length, z / length)
    # Any axis at right angles to u serves a half turn.
    along_x = u[0] * u[0] < 0.5 * dot(u, u)
    w = m.where(opposite, 0.0, w)
    x = m.where(opposite, m.where(along_x, 0.0, u[1]), x)
    y = m.where(opposite, m.where(along_x, u[2], -u[0]), y)
    z = m.where(opposite, m.where(along_x, -u[1], 0.0), z)
    length = m.sqrt(w * w + x * x + y * y + z * z)
    return (w / length, x / length, y / length, z / length)


def on_side_of(m: Functions, q: Quaternion, reference: Quaternion) -> Quaternion:
    """q or -q, whichever lies on the hemisphere of the reference."""
    side = q[0] * reference[0] + q[1] * reference[1] + q[2] * reference[2] + q[3] * reference[3]
    if m is FLOATS and side >= 0.0:
        return q
    sign = m.where(side < 0.0, -1.0, 1.0)
    return (sign * q[0], sign * q[1], sign * q[2], sign * q[3])


def nlerp(m: Functions, p: Quaternion, q: Quaternion, share: Scalar) -> Quaternion:
    """From p the short way to q by a share, along the chord: the arc of slerp at an uneven pace."""
    if m is FLOATS and share == 1.0:
        return on_side_of(m, q, p)
    a, b, c, d = on_side_of(m, q, p)
    w = p[0] + share * (a - p[0])
    x = p[1] + share * (b - p[1])
    y = p[2] + share * (c - p[2])
    z = p[3] + share * (d - p[3])
    length = m.sqrt(w * w + x * x + y * y + z * z)
    return (w / length, x / length, y / length, z / length)


def twist(m: Functions, q: Quaternion, axis: Vector) -> Scalar:
    """The angle, radians in [-pi, pi], of q's turn about a unit axis: q = swing * twist."""
    along = q[1] * axis[0] + q[2] * axis[1] + q[3] * axis[2]
    if m is FLOATS and q[0] >= 0.0:
        return 2.0 * m.atan2(along, q[0])
    return 2.0 * m.atan2(m.where(q[0] < 0.0, -along, along), m.where(q[0] < 0.0, -q[0], q[0]))


def saturate(m: Functions, x: Scalar, low: float, high: float) -> Scalar:
    """x as it is within the FREE share of low < 0 < high, beyond bending smoothly towards the limit."""
    knee_high, knee_low = FREE * high, FREE * low
    if m is FLOATS and knee_low <= x <= knee_high:  # as a rule: the rest would change nothing
        return x
    over = m.maximum(x - knee_high, 0.0) / (high - knee_high)
    under = m.maximum(knee_low - x, 0.0) / (knee_low - low)
    inside = m.minimum(m.maximum(x, knee_low), knee_high)
    return inside + (high - knee_high) * (1.0 - m.exp(-over)) - (knee_low - low) * (1.0 - m.exp(-under))
