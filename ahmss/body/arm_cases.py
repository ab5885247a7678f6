"""The six cases of appendix B: wrist pose to joint angles, one of the seven joints fixed in each (Ichiguchi 2000, B.1).

The arm is `Rz(theta_1) Rx(theta_2) Rz(theta_3) T(L1) Ry(theta_4) T(L2) Ry(theta_5) Rx(theta_6) Rz(theta_7)`, T along z
(B.1 to B.8). All here is in its own axes; `ahmss.body.arm` turns them to our links. Letters are the thesis's: `si` and
`ci` are sine and cosine of theta_i, `pij` and `rij` elements of matrices. Nine equations are wrong in print; where one
is corrected it is said. Functions give both roots of an equation along a last axis of 2.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ahmss.body.array import Array

__all__ = ["CASES", "Cases", "elbow", "shoulder_angles", "six_cases", "wrist_angles"]

CASES = (0, 1, 2, 6, 4, 5)
"""The joint, counted from 0, that each case fixes, four solutions each, in the thesis's order."""

_SLACK = 1e-10  # metres by which rounding may take a root out of reach
_EXACT = 5e-10  # metres: a root so near to a double one that rounding moves the wrist further is none
_TINY = 1e-12  # metres, or a sine: beneath it an angle is undefined
_NEAR = 1e-5  # a sine beneath which a quotient by it loses digits
_DIGIT = 1e-14
_BOTH = np.array([1.0, -1.0])


class Cases(NamedTuple):
    """All solutions of some wrist poses; those without a real root hold any numbers."""

    angles: Array  # (..., 24, 7) radians in [-pi, pi]
    real: Any  # (..., 24) bool


class _Pose(NamedTuple):
    """What the equations of all cases share; scalars as (..., 1), so that roots broadcast."""

    L1: float
    L2: float
    p14: Array
    p24: Array
    p34: Array
    rotation: Array  # (..., 3, 3)
    theta_4: Array  # (..., 1)
    s4: Array
    c4: Array
    given: Array  # (..., 7, 1) the present angles, where nothing else says what an angle shall be
    wrist: tuple[Array, Array, Array]  # alpha, beta, gamma of (B.24)


def six_cases(lengths: Array, place: Array, rotation: Array, present: Array) -> Cases:
    """All solutions, up to 24, of wrist poses: six cases of four, each with one joint as it is at present (B.1.3).

    Where an angle is free (a straight arm, `s2 = 0`, `c6 = 0`) it is the present one or, as the thesis has it, 0.

    Args:
        lengths: (2,) L1 and L2, upper arm and forearm, metres.
        place: (..., 3) the wrist in the arm's fixed frame, metres.
        rotation: (..., 3, 3) the hand's axes in that frame.
        present: (..., 7) radians; gives the fixed joint of each case.
    """
    q, in_reach = _pose(lengths, place, rotation, present)
    angles: list[Array] = []
    real: list[Any] = []
    for case, solve in zip(CASES, (_fix_1, _fix_2, _fix_3, _fix_7, _fix_5, _fix_6), strict=True):
        three, possible = solve(q, present[..., case, None])
        given = np.broadcast_arrays(*three, q.theta_4)
        four = _add_wrist(q, given) if case < 3 else _add_shoulder(q, given)
        angles.append(four)
        real.append(np.repeat(possible & in_reach, 4, axis=-1))
    found = _wrapped(np.concatenate(angles, axis=-2))
    off = np.linalg.norm(_wrist_place(lengths, found) - place[..., None, :], axis=-1)
    return Cases(found, np.concatenate(real, axis=-1) & (off < _EXACT))


def elbow(lengths: Array, distance: Array) -> tuple[Array, Any]:
    """theta_4 (...) >= 0 for the distance (...) of wrist and shoulder (B.10), and whether the arm can have it.

    Of the two signs in (B.10) this is the minus: the elbow bends one way. An arm that is straight but for the last
    digit of the distance is straight: else it would be bent by 1e-8.
    """
    L1, L2 = lengths
    straight = np.abs(distance - L1 - L2) < _DIGIT * (L1 + L2)
    cosine = (L1**2 + L2**2 - distance**2) / (2.0 * L1 * L2)
    real = (distance <= L1 + L2 + _SLACK) & (distance >= abs(L1 - L2) - _SLACK)
    return np.where(straight, 0.0, np.pi - np.arccos(np.clip(cosine, -1.0, 1.0))), real


def _pose(lengths: Array, place: Array, rotation: Array, present: Array) -> tuple[_Pose, Any]:
    theta_4, in_reach = elbow(lengths, np.linalg.norm(place, axis=-1)[..., None])
    # (B.24); beta is printed with p33 for p32.
    alpha, beta, gamma = (-(rotation[..., :, j] * place).sum(axis=-1)[..., None] for j in range(3))
    p14, p24, p34 = (place[..., i, None] for i in range(3))
    L1, L2 = (float(length) for length in lengths)
    s4, c4 = np.sin(theta_4), np.cos(theta_4)
    return _Pose(L1, L2, p14, p24, p34, rotation, theta_4, s4, c4, present[..., None], (alpha, beta, gamma)), in_reach


Three = tuple[Array, Array, Array]


def _fix_1(q: _Pose, theta_1: Array) -> tuple[Three, Any]:
    """theta_1 fixed: (B.12) to (B.14). A straight arm (`s4 = 0`) keeps theta_3, if theta_1 is in its line at all."""
    s1, c1 = np.sin(theta_1), np.cos(theta_1)
    across, side = q.s4 * q.L2, c1 * q.p14 + s1 * q.p24
    theta_3 = _BOTH * np.arccos(_quotient(side, across))  # (B.13)
    theta_3 = np.where(across < _TINY, q.given[..., 2, :], theta_3)
    theta_2 = _turn(across * np.sin(theta_3), q.c4 * q.L2 + q.L1, -s1 * q.p14 + c1 * q.p24, q.p34)  # (B.14)
    return (theta_1, theta_2, theta_3), np.abs(side) <= across + _SLACK


def _fix_2(q: _Pose, theta_2: Array) -> tuple[Three, Any]:
    """theta_2 fixed: (B.15), (B.16). Where `s4 s2 = 0` theta_3 stays, if the height is right at all.

    The second root of (B.15) is printed with a minus that does not belong there.
    """
    s2, c2 = np.sin(theta_2), np.cos(theta_2)
    across, along = q.s4 * q.L2, q.c4 * q.L2 + q.L1
    height = q.p34 - along * c2
    first = np.arcsin(_quotient(height, across * s2))
    theta_3 = np.concatenate([first, np.pi - first], axis=-1)  # (B.15)
    theta_3 = np.where(np.abs(across * s2) < _TINY, q.given[..., 2, :], theta_3)
    s3, c3 = np.sin(theta_3), np.cos(theta_3)
    theta_1 = _turn(q.p24, q.p14, across * s3 * c2 - along * s2, across * c3)  # (B.16)
    # On the axis itself every theta_1 serves.
    theta_1 = np.where(np.hypot(q.p14, q.p24) < _TINY, q.given[..., 0, :], theta_1)
    return (theta_1, theta_2, theta_3), np.abs(height) <= np.abs(across * s2) + _SLACK


def _fix_3(q: _Pose, theta_3: Array) -> tuple[Three, Any]:
    """theta_3 fixed: (B.18). A wrist on the axis itself, where theta_1 is free, keeps it.

    (B.17) is printed with c3 for s3 in its second line and p14 for p24 in its third.
    """
    s3, c3 = np.sin(theta_3), np.cos(theta_3)
    level, side = np.hypot(q.p14, q.p24), q.s4 * c3 * q.L2
    root = np.sqrt(np.maximum(level**2 - side**2, 0.0))
    theta_1 = np.arctan2(q.p24, q.p14) + _BOTH * np.arctan2(root, side)  # (B.18)
    theta_1 = np.where(level < _TINY, q.given[..., 0, :], theta_1)
    s1, c1 = np.sin(theta_1), np.cos(theta_1)
    theta_2 = _turn(q.p34, -s1 * q.p14 + c1 * q.p24, q.c4 * q.L2 + q.L1, q.s4 * q.L2 * s3)
    return (theta_1, theta_2, theta_3), np.abs(side) <= level + _SLACK


def _fix_7(q: _Pose, theta_7: Array) -> tuple[Three, Any]:
    """theta_7 fixed: (B.25) to (B.27). A shoulder in the hand's x axis leaves theta_6 free: it stays.

    (B.25), third line, is printed without gamma c5 c6.
    """
    u, v, gamma = *_in_hand(q, theta_7), q.wrist[2]
    theta_6 = np.arctan2(-gamma, v) + _BOTH * np.pi / 2.0  # (B.26)
    theta_6 = np.where(np.hypot(gamma, v) < _TINY, q.given[..., 5, :], theta_6)
    a = v * np.sin(theta_6) + gamma * np.cos(theta_6)
    theta_5 = _turn(a, u, -q.c4 * q.L1 - q.L2, q.s4 * q.L1)  # (B.27)
    return (theta_5, theta_6, theta_7), np.full(gamma.shape, True)


def _fix_5(q: _Pose, theta_5: Array) -> tuple[Three, Any]:
    """theta_5 fixed: (B.29) to (B.31). Where theta_7 or theta_6 is free it stays.

    (B.30) is printed with c^2 for c in its arctangent.
    """
    s5, c5 = np.sin(theta_5), np.cos(theta_5)
    alpha, beta, gamma = q.wrist
    c = c5 * q.s4 * q.L1 + s5 * (q.c4 * q.L1 + q.L2)
    level = np.hypot(alpha, beta)
    root = np.sqrt(np.maximum(level**2 - c**2, 0.0))
    theta_7 = np.arctan2(-beta, alpha) + _BOTH * np.arctan2(root, c)  # (B.30)
    theta_7 = np.where(level < _TINY, q.given[..., 6, :], theta_7)
    _, a = _in_hand(q, theta_7)
    d = s5 * q.s4 * q.L1 + c5 * (-q.L2 - q.c4 * q.L1)
    theta_6 = np.arctan2(a * d, gamma * d)  # (B.31)
    theta_6 = np.where(np.abs(d) < _TINY, q.given[..., 5, :], theta_6)
    return (theta_5, theta_6, theta_7), np.abs(c) <= level + _SLACK


def _fix_6(q: _Pose, theta_6: Array) -> tuple[Three, Any]:
    """theta_6 fixed: (B.32), (B.33). Where theta_7 is free (`c6 = 0`) it stays.

    (B.32) is printed with alpha and beta exchanged in its first arctangent.
    """
    s6, c6 = np.sin(theta_6), np.cos(theta_6)
    alpha, beta, gamma = q.wrist
    level = np.hypot(alpha * c6, beta * c6)
    root = np.sqrt(np.maximum(level**2 - (gamma * s6) ** 2, 0.0))
    theta_7 = np.arctan2(alpha * c6, beta * c6) + _BOTH * np.arctan2(root, gamma * s6)  # (B.32)
    theta_7 = np.where(level < _TINY, q.given[..., 6, :], theta_7)
    u, v = _in_hand(q, theta_7)
    theta_5 = _turn(q.s4 * q.L1, -q.c4 * q.L1 - q.L2, u, v * s6 + gamma * c6)  # (B.33)
    return (theta_5, theta_6, theta_7), np.abs(gamma * s6) <= level + _SLACK


def _in_hand(q: _Pose, theta_7: Array) -> tuple[Array, Array]:
    """The shoulder seen from the hand before its last turn, x and y: the left side of (B.23)."""
    alpha, beta, _ = q.wrist
    s7, c7 = np.sin(theta_7), np.cos(theta_7)
    return alpha * c7 - beta * s7, alpha * s7 + beta * c7


def wrist_angles(r: Array) -> Three:
    """Both theta_5, theta_6, theta_7 (..., 2) of rotations (..., 3, 3) `Ry Rx Rz` (B.20) to (B.22).

    (B.20) is printed with c5 s6 for c5 c6 in its last element. theta_6 is taken from its sine and cosine at once, which
    keeps all digits near a right angle; there theta_7 comes from the first row of (B.20), as its own quotient has none.
    """
    r11, r12, r13, r21, r22, r23, r31, r32, r33 = (r[..., i, j, None] for i in range(3) for j in range(3))
    c6 = _BOTH * np.hypot(r13, r33)
    theta_6 = np.arctan2(-r23, c6)  # (B.21)
    size = np.abs(c6)
    by = _BOTH * np.where(size < _TINY, 1.0, size)  # the sign of c6 is what matters to an arctangent
    theta_5 = np.where(size < _TINY, np.arctan2(-r31, r11), np.arctan2(r13 / by, r33 / by))  # (B.22)
    s5, c5 = np.sin(theta_5), np.cos(theta_5)
    at_right_angle = np.arctan2(s5 * r32 - c5 * r12, c5 * r11 - s5 * r31)
    theta_7 = np.where(size < _NEAR, at_right_angle, np.arctan2(r21 / by, r22 / by))  # (B.22)
    return theta_5, theta_6, theta_7


def shoulder_angles(r: Array) -> Three:
    """Both theta_1, theta_2, theta_3 (..., 2) of rotations (..., 3, 3) `Rz Rx Rz` (B.35), (B.36).

    theta_3 of (B.36) is printed with a minus before r32. Near `s2 = 0` it comes from the first row, see `wrist_angles`.
    """
    r11, r12, r13, r21, r22, r23, r31, r32, r33 = (r[..., i, j, None] for i in range(3) for j in range(3))
    s2 = _BOTH * np.hypot(r13, r23)
    theta_2 = np.arctan2(s2, r33)
    size = np.abs(s2)
    by = _BOTH * np.where(size < _TINY, 1.0, size)
    theta_1 = np.where(size < _TINY, np.arctan2(r21, r11), np.arctan2(r13 / by, -r23 / by))  # (B.36)
    s1, c1 = np.sin(theta_1), np.cos(theta_1)
    in_line = np.arctan2(-c1 * r12 - s1 * r22, c1 * r11 + s1 * r21)
    theta_3 = np.where(size < _NEAR, in_line, np.arctan2(r31 / by, r32 / by))  # (B.36)
    return theta_1, theta_2, theta_3


def _add_wrist(q: _Pose, shoulder: Any) -> Array:
    """(..., 4, 7): two shoulders, each with both wrists (B.19)."""
    theta_1, theta_2, theta_3, theta_4 = shoulder
    held = _about("z", theta_1) @ _about("x", theta_2) @ _about("z", theta_3) @ _about("y", theta_4)
    wrist = wrist_angles(np.swapaxes(held, -1, -2) @ q.rotation[..., None, :, :])
    return _four((*(theta[..., None] for theta in shoulder), *wrist))


def _add_shoulder(q: _Pose, wrist: Any) -> Array:
    """(..., 4, 7): two wrists, each with both shoulders (B.34)."""
    theta_5, theta_6, theta_7, theta_4 = wrist
    moved = _about("y", theta_4) @ _about("y", theta_5) @ _about("x", theta_6) @ _about("z", theta_7)
    shoulder = shoulder_angles(q.rotation[..., None, :, :] @ np.swapaxes(moved, -1, -2))
    theta_5, theta_6, theta_7, theta_4 = (theta[..., None] for theta in wrist)
    return _four((*shoulder, theta_4, theta_5, theta_6, theta_7))


def _four(thetas: tuple[Array, ...]) -> Array:
    """Seven angles, each (..., 2, 1 or 2), as (..., 4, 7)."""
    seven = np.stack(np.broadcast_arrays(*thetas), axis=-1)
    return seven.reshape(*seven.shape[:-3], 4, 7)


def _wrist_place(lengths: Array, angles: Array) -> Array:
    """The wrist (..., 3) of angles (..., 7): (B.11)."""
    s1, s2, s3, s4, *_ = np.moveaxis(np.sin(angles), -1, 0)
    c1, c2, c3, c4, *_ = np.moveaxis(np.cos(angles), -1, 0)
    across, along = s4 * lengths[1], c4 * lengths[1] + lengths[0]
    level = across * s3 * c2 - along * s2
    return np.stack(
        [c1 * across * c3 - s1 * level, s1 * across * c3 + c1 * level, across * s3 * s2 + along * c2], axis=-1
    )


def _turn(a: Array, b: Array, c: Array, d: Array) -> Array:
    """The angle t with `a cos t - b sin t = c` and `a sin t + b cos t = d`, as all cases need it."""
    return np.arctan2(a * d - b * c, a * c + b * d)


def _quotient(over: Array, under: Array) -> Array:
    """over / under as a sine or cosine: where it has no meaning, or rounding takes it out of range, the nearest."""
    undefined = np.abs(under) < _TINY
    return np.clip(np.where(undefined, 0.0, over / np.where(undefined, 1.0, under)), -1.0, 1.0)


def _about(axis: str, theta: Array) -> Array:
    """Rotation matrices (..., 3, 3) about x, y or z."""
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    m = np.zeros((*theta.shape, 3, 3))
    m[..., 3 - i - j, 3 - i - j] = 1.0
    m[..., i, i] = m[..., j, j] = np.cos(theta)
    m[..., j, i] = np.sin(theta)
    m[..., i, j] = -m[..., j, i]
    return m


def _wrapped(angles: Array) -> Array:
    """The same angles within [-pi, pi]."""
    return angles - 2.0 * np.pi * np.round(angles / (2.0 * np.pi))
