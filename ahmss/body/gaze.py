"""Gaze: the head turned towards a place, the spine helping a little with what is beyond the neck.

The eyes are no links of the body: they are taken to cover what the head leaves (Freedman & Sparks 1997: the head adds
little to small shifts of gaze, and the eyes saturate).
"""

from __future__ import annotations

import math

from ahmss.body.components import (
    FLOATS,
    Functions,
    Quaternion,
    Scalar,
    Vector,
    about,
    conjugate,
    multiply,
    nlerp,
    on_side_of,
    rotate,
    saturate,
)

__all__ = ["solve_gaze"]

_SHARE = 0.9  # of the angle to the place, the rest is the eyes'
_YAW, _PITCH_DOWN, _PITCH_UP = math.radians(75.0), math.radians(45.0), math.radians(40.0)
_SPINE_FROM, _SPINE_SOFT, _SPINE_MOST = math.radians(30.0), math.radians(30.0), math.radians(20.0)
_SPINE_SHARE = 0.4  # of the angle beyond
_BEHIND = math.radians(115.0)  # from here on the interest fades: straight behind neither side is nearer
_NEAR = 0.3  # metres: of what passes the eyes nearer than this, nobody's head keeps up with the direction
_X, _Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)


def solve_gaze(
    m: Functions, head: Vector, eye: Vector, given: tuple[Quaternion, Quaternion], place: Vector, weight: Scalar
) -> tuple[Quaternion, Quaternion]:
    """Rotations of spine and head that look at a place.

    Args:
        m: the functions of floats or of arrays.
        head: the head's joint in the spine's frame, metres.
        eye: the point between the eyes in the head's frame, metres.
        given: rotations of spine and head, each parent <- child.
        place: what is looked at, in the hips' frame seen from the spine's joint, metres.
        weight: 0..1.
    """
    q_spine, q_head = given
    yaw, pitch, (aside, near) = _direction(m, rotate(conjugate(q_spine), place), head, eye)
    beyond = m.maximum(m.maximum(yaw, -yaw) - _SPINE_FROM, 0.0)
    beyond = beyond * beyond / (beyond + _SPINE_SOFT)  # starts without a jerk
    help_ = aside * saturate(m, _SPINE_SHARE * beyond, -_SPINE_MOST, _SPINE_MOST) * m.where(yaw < 0.0, -1.0, 1.0)
    q_spine_new = q_spine
    if m is not FLOATS or help_ != 0.0:  # as a rule the neck alone is enough: the rest would change nothing
        q_spine_new = multiply(q_spine, about(m, _X, weight * help_))
        yaw, pitch, (aside, near) = _direction(m, rotate(conjugate(q_spine_new), place), head, eye)
    q_look = multiply(
        about(m, _X, aside * saturate(m, _SHARE * yaw, -_YAW, _YAW)),
        about(m, _Y, near * saturate(m, _SHARE * pitch, -_PITCH_UP, _PITCH_DOWN)),
    )
    return q_spine_new, on_side_of(m, nlerp(m, q_head, q_look, weight), q_head)


def _direction(m: Functions, place: Vector, head: Vector, eye: Vector) -> tuple[Scalar, Scalar, tuple[Scalar, Scalar]]:
    """Yaw (to the left) and pitch (downwards), radians, from the eyes to the place; the spine has x up, -z ahead.

    The eyes are taken at their height above the neck, on its axis, so that the place need not be found by iteration.
    With them the interest 0..1 that they turn aside and up or down with: none where a place has no such direction,
    which is behind, straight above and below, and in the eyes themselves.
    """
    up, left, ahead = place[0] - head[0] - eye[0], place[1] - head[1], head[2] - place[2]
    level = m.sqrt(left * left + ahead * ahead)
    yaw = m.atan2(left, ahead)
    behind = _rise(m, (math.pi - m.maximum(yaw, -yaw)) / (math.pi - _BEHIND))
    near = _rise(m, m.sqrt(up * up + level * level) / _NEAR)
    steep = _NEAR + m.maximum(up, 0.0)  # what is higher than the neck bends back turns aside less
    return yaw, m.atan2(-up, m.maximum(level, 1e-9)), (behind * _rise(m, level / steep), near)


def _rise(m: Functions, x: Scalar) -> Scalar:
    """From 0 at 0 smoothly to 1 at 1 and beyond; x >= 0."""
    x = m.minimum(x, 1.0)
    return x * x * (3.0 - 2.0 * x)
