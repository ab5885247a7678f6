"""Quaternion algebra (Ichiguchi 2000, 4.1 to 4.8 and 5.7).

Quaternions are `(w, x, y, z)`, Hamilton's product, unit where they are rotations; `q_parent_child` takes a child's
coordinates to the parent's by `q v q*`. Every function takes any leading shape.
"""

from __future__ import annotations

import numpy as np

from ahmss.body import single
from ahmss.body.array import Array

__all__ = [
    "IDENTITY",
    "about_z",
    "align",
    "between",
    "conjugate",
    "cross",
    "from_axis_angle",
    "from_matrix",
    "from_rotation_vector",
    "inverse",
    "multiply",
    "norm",
    "normalize",
    "rotate",
    "slerp",
    "to_matrix",
    "to_rotation_vector",
]

IDENTITY: Array = np.array([1.0, 0.0, 0.0, 0.0])
_CONJUGATE: Array = np.array([1.0, -1.0, -1.0, -1.0])
# (4.4) as a table: what q[j] adds to p's factor i of component k. For a few quaternions two calls beat twenty-eight.
_TIMES: Array = np.array([
    [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],
    [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0],
    [0, 0, 1, 0, 0, 0, 0, 1, -1, 0, 0, 0, 0, -1, 0, 0],
    [0, 0, 0, 1, 0, 0, -1, 0, 0, 1, 0, 0, -1, 0, 0, 0],
], float)  # fmt: skip
_FEW = 2400
_NEXT, _AFTER = np.array([1, 2, 0]), np.array([2, 0, 1])
_NEARLY_PARALLEL = 1.0 - 1e-9  # above this cosine sin(theta) loses its digits and the chord serves


def multiply(p: Array, q: Array) -> Array:
    """The product p q of (..., 4) quaternions (4.4): first the rotation q, then p."""
    if q.ndim == 1 == p.ndim:
        return single.multiply(p, q)
    if q.size < _FEW:
        return np.einsum("...i,...ik->...k", p, (q @ _TIMES).reshape(*q.shape[:-1], 4, 4))
    pw, px, py, pz = p[..., 0], p[..., 1], p[..., 2], p[..., 3]
    qw, qx, qy, qz = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    out = np.empty(np.broadcast_shapes(p.shape, q.shape))
    out[..., 0] = pw * qw - px * qx - py * qy - pz * qz
    out[..., 1] = pw * qx + px * qw + py * qz - pz * qy
    out[..., 2] = pw * qy - px * qz + py * qw + pz * qx
    out[..., 3] = pw * qz + px * qy - py * qx + pz * qw
    return out


def conjugate(q: Array) -> Array:
    """The conjugate q* of (..., 4) quaternions (4.5)."""
    return q * _CONJUGATE


def norm(q: Array) -> Array:
    """N(q) = w^2 + x^2 + y^2 + z^2 of (..., 4) quaternions (4.6): the square of the length."""
    return np.einsum("...i,...i->...", q, q)


def inverse(q: Array) -> Array:
    """The inverse q* / N(q) of (..., 4) quaternions (4.7)."""
    return conjugate(q) / norm(q)[..., None]


def rotate(q: Array, v: Array) -> Array:
    """Vectors (..., 3) turned by unit quaternions (..., 4): `q v q*` ((4.8), whose print has the other direction)."""
    if q.ndim == 1 == v.ndim:
        return single.rotate(q, v)
    w, u = q[..., :1], q[..., 1:]
    t = 2.0 * cross(u, v)
    return v + w * t + cross(u, t)


def cross(a: Array, b: Array) -> Array:
    """The cross product of (..., 3) vectors; numpy's own makes the same several times slower."""
    if a.ndim == 1 == b.ndim:
        return single.cross(a, b)
    if max(a.size, b.size) < _FEW:  # six products in two calls
        return a.take(_NEXT, -1) * b.take(_AFTER, -1) - a.take(_AFTER, -1) * b.take(_NEXT, -1)
    ax, ay, az = a[..., 0], a[..., 1], a[..., 2]
    bx, by, bz = b[..., 0], b[..., 1], b[..., 2]
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    out[..., 0] = ay * bz - az * by
    out[..., 1] = az * bx - ax * bz
    out[..., 2] = ax * by - ay * bx
    return out


def normalize(q: Array) -> Array:
    """(..., 4) quaternions scaled to length 1."""
    if q.ndim == 1:
        return single.normalize(q)
    return q / np.sqrt(norm(q))[..., None]


def align(q: Array, reference: Array) -> Array:
    """Each of q (..., 4) or its negative, whichever lies on the hemisphere of `reference` (..., 4)."""
    dot = np.einsum("...i,...i->...", q, reference)
    return np.where(dot < 0.0, -1.0, 1.0)[..., None] * q


def from_rotation_vector(v: Array) -> Array:
    """Unit quaternions (..., 4) of rotation vectors (..., 3): axis times angle, radians."""
    if v.ndim == 1:
        return single.from_rotation_vector(*v.tolist())
    angle = np.sqrt(np.einsum("...i,...i->...", v, v))
    half = 0.5 * angle
    out = np.empty((*v.shape[:-1], 4))
    out[..., 0] = np.cos(half)
    out[..., 1:] = (0.5 * np.sinc(half / np.pi))[..., None] * v
    return out


def to_rotation_vector(q: Array) -> Array:
    """The shortest rotation vectors (..., 3), radians, of unit quaternions (..., 4); q and -q give the same."""
    q = np.where(q[..., :1] < 0.0, -q, q)
    sine = np.sqrt(np.einsum("...i,...i->...", q[..., 1:], q[..., 1:]))
    angle = 2.0 * np.arctan2(sine, q[..., 0])
    scale = np.where(sine > 1e-12, angle / np.maximum(sine, 1e-12), 2.0)
    return scale[..., None] * q[..., 1:]


def from_axis_angle(axis: Array, angle: Array | float) -> Array:
    """Unit quaternions (..., 4) that turn by `angle` radians (...) about unit axes (..., 3)."""
    axis = np.asarray(axis, float)
    if isinstance(angle, float) and axis.ndim == 1:
        x, y, z = axis.tolist()
        return single.from_rotation_vector(x * angle, y * angle, z * angle)
    return from_rotation_vector(axis * np.asarray(angle, float)[..., None])


def to_matrix(q: Array) -> Array:
    """Rotation matrices (..., 3, 3) of unit quaternions (..., 4)."""
    basis = np.broadcast_to(np.eye(3), (*q.shape[:-1], 3, 3))
    return np.swapaxes(rotate(q[..., None, :], basis), -1, -2)


def from_matrix(m: Array) -> Array:
    """Unit quaternions (..., 4), w >= 0, of rotation matrices (..., 3, 3)."""
    diagonal = np.stack([m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]], axis=-1)
    trace = diagonal.sum(axis=-1)
    # Four times each product of two components; the row of the largest component is the best conditioned.
    k = np.empty((*m.shape[:-2], 4, 4))
    k[..., 0, 0] = 1.0 + trace
    for i in range(3):
        k[..., i + 1, i + 1] = 1.0 - trace + 2.0 * diagonal[..., i]
    for i, (a, b) in enumerate(((2, 1), (0, 2), (1, 0))):
        k[..., 0, i + 1] = k[..., i + 1, 0] = m[..., a, b] - m[..., b, a]
    for a, b in ((0, 1), (0, 2), (1, 2)):
        k[..., a + 1, b + 1] = k[..., b + 1, a + 1] = m[..., a, b] + m[..., b, a]
    best = np.argmax(np.diagonal(k, axis1=-2, axis2=-1), axis=-1)
    q = normalize(np.take_along_axis(k, best[..., None, None], axis=-2)[..., 0, :])
    return np.where(q[..., :1] < 0.0, -q, q)


def about_z(q: Array) -> Array:
    """The turn about z in rotations (..., 4): q = about_z(q) * a tilt about a level axis; none where upside down."""
    turn = q * np.array([1.0, 0.0, 0.0, 1.0])
    size = np.sqrt(norm(turn))[..., None]
    return np.where(size > 1e-9, turn / np.maximum(size, 1e-9), IDENTITY)


def slerp(q0: Array, q1: Array, t: Array | float) -> Array:
    """Spherical linear interpolation (5.7) from q0 to q1 (..., 4) at t (...), the short way round.

    Nearly equal quaternions, whose sin(theta) is lost in rounding, go by the chord.
    """
    t = np.asarray(t, float)[..., None]
    dot = np.einsum("...i,...i->...", q0, q1)[..., None]
    q1 = np.where(dot < 0.0, -1.0, 1.0) * q1
    cosine = np.abs(dot)
    near = cosine > _NEARLY_PARALLEL
    theta = np.arccos(np.where(near, 0.0, np.minimum(cosine, 1.0)))
    sine = np.sin(theta)
    c0 = np.where(near, 1.0 - t, np.sin((1.0 - t) * theta) / sine)
    c1 = np.where(near, t, np.sin(t * theta) / sine)
    return normalize(c0 * q0 + c1 * q1)


def between(u: Array, v: Array) -> Array:
    """The smallest rotations (..., 4) that turn directions u (..., 3) to directions v (..., 3), of any length > 0."""
    u = u / np.linalg.norm(u, axis=-1, keepdims=True)
    v = v / np.linalg.norm(v, axis=-1, keepdims=True)
    w = 1.0 + np.einsum("...i,...i->...", u, v)
    opposite = w < 1e-9
    helper = np.where(np.abs(u[..., :1]) < 0.9, np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]))
    axis = np.where(opposite[..., None], cross(u, helper), cross(u, v))
    return normalize(np.concatenate([np.where(opposite, 0.0, w)[..., None], axis], axis=-1))
