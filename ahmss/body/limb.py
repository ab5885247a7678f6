"""One limb of two bones, arm or leg, solved onto a pose of its end in closed form.

The given pose says where the elbow or knee points; the solution bends the middle joint to the distance wanted, then
swings the whole limb by the smallest turn. Bones keep their length; near full stretch the end is approached softly.
"""

from __future__ import annotations

from typing import NamedTuple

from ahmss.body.components import (
    FLOATS,
    Functions,
    Quaternion,
    Scalar,
    Vector,
    about,
    between,
    cross,
    dot,
    multiply,
    nlerp,
    on_side_of,
    relative,
    rotate,
    saturate,
    twist,
)

__all__ = ["SOFTEST", "STRAIGHT", "SWIVEL", "Goal", "Limb", "Rotations", "solve_limb"]

SOFTEST = 0.0003  # the least share of the reach over which a limb that is stretched goes soft
STRAIGHT = 0.05  # how much of the hinge's own axis joins the plane of the bend, so that a straight limb has one
SWIVEL = 1.0  # radians that elbow or knee may turn aside for a hand or foot turned too far


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
    soft: float  # share of the reach, the last, over which the limb goes soft


class Goal(NamedTuple):
    """What the end shall meet, in the frame of the limb's parent."""

    place: Vector
    rotation: Quaternion | None  # None: the end keeps its rotation against the lower link
    weight: Scalar


Rotations = tuple[Quaternion, Quaternion, Quaternion]


def solve_limb(m: Functions, limb: Limb, given: Rotations, goal: Goal) -> Rotations:
    """Rotations, each parent <- child, of upper, lower and end link that meet the goal.

    All is computed in the frame of the given upper link, in which the upper bone is constant.
    """
    r_upper, r_lower, r_end = given
    share, a, base = goal.weight, limb.upper, limb.base
    q_end = multiply(r_lower, r_end)
    b, held = rotate(r_lower, limb.lower), rotate(q_end, limb.grip)
    hinge = _hinge(m, a, b)
    x, y, z = goal.place
    x, y, z = rotate((r_upper[0], -r_upper[1], -r_upper[2], -r_upper[3]), (x - base[0], y - base[1], z - base[2]))
    # The way from where the end is, by the weight.
    x0, y0, z0 = a[0] + b[0] + held[0], a[1] + b[1] + held[1], a[2] + b[2] + held[2]
    x, y, z = x0 + share * (x - x0), y0 + share * (y - y0), z0 + share * (z - z0)
    if goal.rotation is None:
        b = (b[0] + held[0], b[1] + held[1], b[2] + held[2])
    else:
        q_end = nlerp(m, q_end, multiply(relative(r_upper, goal.rotation), limb.grip_conjugate), share)
        held = rotate(q_end, limb.grip)
        x, y, z = x - held[0], y - held[1], z - held[2]
    reach = (x, y, z)
    bend = about(m, hinge, _bend(m, limb, hinge, b, m.sqrt(x * x + y * y + z * z)))
    b = rotate(bend, b)
    swing = between(m, (a[0] + b[0], a[1] + b[1], a[2] + b[2]), reach)
    new_lower = multiply(bend, r_lower)
    if goal.rotation is None:
        return on_side_of(m, multiply(r_upper, swing), r_upper), on_side_of(m, new_lower, r_lower), r_end
    swing, new_lower = _share_turn(m, limb, (r_lower, r_end, q_end), (swing, new_lower), reach)
    new_end = relative(multiply(swing, new_lower), q_end)
    return (
        on_side_of(m, multiply(r_upper, swing), r_upper),
        on_side_of(m, new_lower, r_lower),
        on_side_of(m, new_end, r_end),
    )


def _hinge(m: Functions, a: Vector, b: Vector) -> Vector:
    """The unit axis about which the middle joint bends: across the plane of the bones, else the upper link's y."""
    x, y, z = cross(a, b)
    scale = 1.0 / m.sqrt(dot(a, a) * dot(b, b))
    # Bent the wrong way (overstretched), the plane says nothing of the side: that part is left out.
    x, y, z = scale * x, STRAIGHT + m.maximum(scale * y, 0.0), scale * z
    length = m.sqrt(x * x + y * y + z * z)
    return (x / length, y / length, z / length)


def _bend(m: Functions, limb: Limb, h: Vector, b: Vector, distance: Scalar) -> Scalar:
    """The angle about hinge h by which bone b turns so that |a + b| is the distance, on the flexed side.

    With the upper bone a,
    a . R(phi) b = (a . h)(b . h) + A cos phi + B sin phi: the law of cosines for a hinge that need not be square.
    """
    a = limb.upper
    along = dot(a, h) * dot(b, h)
    A = dot(a, b) - along
    B = dot(a, cross(h, b))
    amplitude = m.maximum(m.sqrt(A * A + B * B), 1e-12)
    fixed = dot(a, a) + dot(b, b) + 2.0 * along
    longest = m.sqrt(fixed + 2.0 * amplitude)
    present = m.sqrt(m.maximum(fixed + 2.0 * A, 0.0))
    distance = _soften(m, distance, present, longest, limb.soft)
    cosine = (distance * distance - fixed) / (2.0 * amplitude)
    cosine = m.minimum(m.maximum(cosine, limb.most_bent), 1.0)
    return m.atan2(B, A) + m.acos(cosine)


def _soften(m: Functions, distance: Scalar, present: Scalar, longest: Scalar, soft: float) -> Scalar:
    """The distance asked for, slowing down before full stretch; a limb given stretched may be so."""
    start = m.minimum(m.maximum(present, (1.0 - soft) * longest), (1.0 - SOFTEST) * longest)
    span = longest - start
    over = m.maximum(distance - start, 0.0) / span
    return m.minimum(distance, start) + span * (1.0 - m.exp(-over))


def _share_turn(
    m: Functions, limb: Limb, given: Rotations, solved: tuple[Quaternion, Quaternion], reach: Vector
) -> tuple[Quaternion, Quaternion]:
    """Give the end's turn about the lower link's axis to that link within its limits, the excess to the swivel.

    The swivel is the turn of elbow or knee about the line from upper joint to end; neither moves the end. Where the
    end is turned as in the given pose, nothing changes.

    Args:
        m: the functions of floats or of arrays.
        limb: its measures.
        given: the lower and the end link's given rotations, parent <- child, and the end's wanted one.
        solved: the swing of the upper link, and the lower link's rotation in the swung frame.
        reach: from upper joint to end, metres.
    """
    r_lower, r_end, q_end = given
    swing, new_lower = solved
    axis = limb.lower_axis
    own = twist(m, r_lower, axis)
    before = own + twist(m, r_end, axis)
    kept = saturate(m, before, *limb.turn)
    after = own + twist(m, relative(multiply(swing, new_lower), q_end), axis)
    excess = (after - saturate(m, after, *limb.turn)) - (before - kept)
    if m is FLOATS and excess == 0.0:  # as a rule: no swivel
        return swing, multiply(new_lower, about(m, axis, after - before))
    length = m.maximum(m.sqrt(dot(reach, reach)), 1e-9)
    line = (reach[0] / length, reach[1] / length, reach[2] / length)
    swing = multiply(about(m, line, saturate(m, excess, -SWIVEL, SWIVEL)), swing)
    after = own + twist(m, relative(multiply(swing, new_lower), q_end), axis)
    return swing, multiply(new_lower, about(m, axis, saturate(m, after, *limb.turn) - kept))
