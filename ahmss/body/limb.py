"""One limb of two bones, arm or leg, solved onto a pose of its end in closed form.

The given pose says where the elbow or knee points; the solution bends the middle joint to the distance wanted, then
swings the whole limb by the smallest turn. Bones keep their length; near full stretch the end is approached softly.
"""

from __future__ import annotations

from typing import NamedTuple

from ahmss.body.components import (
    Functions,
    Quaternion,
    Scalar,
    Vector,
    about,
    between,
    conjugate,
    cross,
    dot,
    multiply,
    nlerp,
    on_side_of,
    rotate,
    saturate,
    twist,
)

__all__ = ["Goal", "Limb", "solve_limb"]

_SOFT, _SOFTEST = 0.02, 0.0003  # shares of the reach over which a stretched limb goes soft
_STRAIGHT = 0.05  # how much of the hinge's own axis joins the plane of the bend, so that a straight limb has one
_SWIVEL = 1.0  # radians that elbow or knee may turn aside for a hand or foot turned too far


class Limb(NamedTuple):
    """The fixed measures of a limb: upper link, lower link, end link (hand or foot)."""

    first: int  # index of the upper link; lower and end follow it
    base: Vector  # upper joint in the parent's frame, metres
    upper: Vector  # middle joint in the upper link's frame
    lower: Vector  # end joint in the lower link's frame
    lower_axis: Vector  # the same, unit: the forearm's axis of pronation
    grip: Vector  # what meets the target, in the end link's frame
    grip_conjugate: Quaternion  # the conjugate of its rotation
    turn: tuple[float, float]  # limits of the lower link's turn about its axis, radians
    most_bent: float  # cosine of the largest flexion


class Goal(NamedTuple):
    """What the end shall meet, in the frame of the limb's parent."""

    place: Vector
    rotation: Quaternion | None  # None: the end keeps its rotation against the lower link
    weight: Scalar


Rotations = tuple[Quaternion, Quaternion, Quaternion]


def solve_limb(m: Functions, limb: Limb, given: Rotations, goal: Goal) -> Rotations:
    """Rotations, each parent <- child, of upper, lower and end link that meet the goal.

    All is computed in the frame of the limb's parent (spine or hips).
    """
    q_upper, q_lower = given[0], multiply(given[0], given[1])
    q_end = multiply(q_lower, given[2])
    upper, lower = rotate(q_upper, limb.upper), rotate(q_lower, limb.lower)
    held = rotate(q_end, limb.grip)
    place = _mix(_sum(limb.base, upper, lower, held), goal.place, goal.weight)
    hinge = _hinge(m, q_upper, upper, lower)
    if goal.rotation is None:
        reach = _difference(place, limb.base)
        second = _sum(lower, held)
    else:
        q_end = nlerp(m, q_end, multiply(goal.rotation, limb.grip_conjugate), goal.weight)
        reach = _difference(_difference(place, rotate(q_end, limb.grip)), limb.base)
        second = lower
    bend = about(m, hinge, _bend(m, limb, hinge, upper, second, m.sqrt(dot(reach, reach))))
    swing = between(m, _sum(upper, rotate(bend, second)), reach)
    q_upper = multiply(swing, q_upper)
    q_lower = multiply(swing, multiply(bend, q_lower))
    if goal.rotation is None:
        return _local(m, given, q_upper, q_lower, None)
    q_upper, q_lower = _share_turn(m, limb, given, (q_upper, q_lower, q_end), reach)
    return _local(m, given, q_upper, q_lower, q_end)


def _hinge(m: Functions, q_upper: Quaternion, upper: Vector, lower: Vector) -> Vector:
    """The unit axis about which the middle joint bends: across the plane of the bend, else the upper link's y."""
    y = rotate(q_upper, (0.0, 1.0, 0.0))
    x_n, y_n, z_n = cross(upper, lower)
    scale = 1.0 / m.sqrt(dot(upper, upper) * dot(lower, lower))
    # Bent the wrong way (overstretched), the plane says nothing of the side: that part is left out.
    add = _STRAIGHT - m.minimum(scale * dot((x_n, y_n, z_n), y), 0.0)
    x_n, y_n, z_n = scale * x_n + add * y[0], scale * y_n + add * y[1], scale * z_n + add * y[2]
    length = m.sqrt(x_n * x_n + y_n * y_n + z_n * z_n)
    return (x_n / length, y_n / length, z_n / length)


def _bend(m: Functions, limb: Limb, h: Vector, a: Vector, b: Vector, distance: Scalar) -> Scalar:
    """The angle about hinge h by which bone b turns so that |a + b| is the distance, flexed side.

    a . R(phi) b = (a . h)(b . h) + A cos phi + B sin phi: the law of cosines for a hinge that need not be square.
    """
    along = dot(a, h) * dot(b, h)
    A = dot(a, b) - along
    B = dot(a, cross(h, b))
    amplitude = m.maximum(m.sqrt(A * A + B * B), 1e-12)
    fixed = dot(a, a) + dot(b, b) + 2.0 * along
    longest = m.sqrt(fixed + 2.0 * amplitude)
    present = m.sqrt(m.maximum(fixed + 2.0 * A, 0.0))
    distance = _soften(m, distance, present, longest)
    cosine = (distance * distance - fixed) / (2.0 * amplitude)
    cosine = m.minimum(m.maximum(cosine, limb.most_bent), 1.0)
    return m.atan2(B, A) + m.acos(cosine)


def _soften(m: Functions, distance: Scalar, present: Scalar, longest: Scalar) -> Scalar:
    """The distance asked for, slowing down before full stretch; a limb given stretched may be so."""
    start = m.minimum(m.maximum(present, (1.0 - _SOFT) * longest), (1.0 - _SOFTEST) * longest)
    span = longest - start
    over = m.maximum(distance - start, 0.0) / span
    return m.minimum(distance, start) + span * (1.0 - m.exp(-over))


def _share_turn(
    m: Functions, limb: Limb, given: Rotations, solved: Rotations, reach: Vector
) -> tuple[Quaternion, Quaternion]:
    """Give the end's turn about the lower link's axis to that link within its limits, the excess to the swivel.

    The swivel is the turn of elbow or knee about the line from upper joint to end; neither moves the end. Where the
    end is turned as in the given pose, nothing changes.
    """
    q_upper, q_lower, q_end = solved
    axis = limb.lower_axis
    own = twist(m, given[1], axis)
    before = own + twist(m, given[2], axis)
    kept = saturate(m, before, *limb.turn)
    after = own + twist(m, multiply(conjugate(q_lower), q_end), axis)
    excess = (after - saturate(m, after, *limb.turn)) - (before - kept)
    length = m.maximum(m.sqrt(dot(reach, reach)), 1e-9)
    line = (reach[0] / length, reach[1] / length, reach[2] / length)
    swivel = about(m, line, saturate(m, excess, -_SWIVEL, _SWIVEL))
    q_upper, q_lower = multiply(swivel, q_upper), multiply(swivel, q_lower)
    after = own + twist(m, multiply(conjugate(q_lower), q_end), axis)
    return q_upper, multiply(q_lower, about(m, axis, saturate(m, after, *limb.turn) - kept))


def _local(
    m: Functions, given: Rotations, q_upper: Quaternion, q_lower: Quaternion, q_end: Quaternion | None
) -> Rotations:
    """The rotations against each parent, on the hemisphere of the given ones."""
    upper = on_side_of(m, q_upper, given[0])
    lower = on_side_of(m, multiply(conjugate(q_upper), q_lower), given[1])
    if q_end is None:
        return upper, lower, given[2]
    return upper, lower, on_side_of(m, multiply(conjugate(q_lower), q_end), given[2])


def _mix(u: Vector, v: Vector, share: Scalar) -> Vector:
    return (u[0] + share * (v[0] - u[0]), u[1] + share * (v[1] - u[1]), u[2] + share * (v[2] - u[2]))


def _difference(u: Vector, v: Vector) -> Vector:
    return (u[0] - v[0], u[1] - v[1], u[2] - v[2])


def _sum(*vectors: Vector) -> Vector:
    x, y, z = vectors[0]
    for vector in vectors[1:]:
        x, y, z = x + vector[0], y + vector[1], z + vector[2]
    return (x, y, z)
