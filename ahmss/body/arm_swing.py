"""The freedom that a wrist pose leaves an arm: the swing of the elbow about the line from shoulder to wrist.

Beyond the thesis, whose 24 solutions are points of it. Turned by the swing phi about the line, the upper arm's
quaternion is `cos(phi/2) q_0 + sin(phi/2) q_1`, and so is the wrist's. A limit on `2 arctan(q_i / q_w)` is then
`A cos(phi) + B sin(phi) + C >= 0`, which holds on one arc of the circle, in closed form; the swings within all limits
are what those arcs share, at most a few arcs. Nothing is sampled, so however short an arc is, it is found.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ahmss.body.arm import Arm, Wrist, split_wrist
from ahmss.body.arm_cases import elbow
from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, cross, from_axis_angle, from_matrix, multiply, rotate

__all__ = ["HAND", "SHOULDER", "Swing", "allowed", "elbow_side", "limits_of", "nearest_swing", "shortest", "swing_of"]

SHOULDER = slice(0, 3)
"""Of the measured angles, the shoulder's."""
HAND = slice(3, 6)
"""Of the measured angles, the forearm's turn and the hand's bend."""

_TOUCHING = 1e-10  # radians, twice over, by which an angle may be beyond a limit for rounding's sake
_SHORTEST = 1e-9  # radians: a shorter arc is a point where two limits meet from outside
_INSIDE = 1e-10  # radians by which the nearest swing keeps off an arc's end, so that rounding keeps it within limits
_TINY = 1e-12
_HALF_TURN = 0.5 * np.pi - 1e-9  # of half an angle: a limit that forbids nothing
_HALF = np.array([[0.5, 0.0, 0.5], [-0.5, 0.0, 0.5], [0.0, 0.5, 0.0]])  # cos^2, sin^2, sin cos of phi/2 as waves


@dataclass(frozen=True, eq=False)
class Swing:
    """Arms whose wrists are in place, but for the swing phi, radians; 0 has the elbow to the side asked for.

    line (..., 3): the unit vector from shoulder to wrist. bend (...): theta_4, radians. missing (...): metres by which
    the wrist is too far (> 0) or too near (< 0); then the arm is as long or as short as it can be, in that direction.
    upper (..., 4): the upper arm at swing 0. rotation (..., 4): the hand's, against the shoulder frame.
    """

    line: Array
    bend: Array
    missing: Array
    upper: Array
    rotation: Array

    def links(self, phi: Array) -> Array:
        """The links (..., 3, 4) at swings phi (...)."""
        upper = multiply(from_axis_angle(self.line, phi), self.upper)
        bend = _about_y(self.bend)
        turn, hand = split_wrist(multiply(conjugate(multiply(upper, bend)), self.rotation))
        return np.stack([upper, multiply(bend, turn), hand], axis=-2)

    def measures(self) -> Array:
        """The six angles that have limits, as (..., 6, 2, 3): each is `2 arctan(product / square)`.

        In this order: the shoulder about x, y, z, the forearm's turn, the hand about y, z. Square, then product, are
        waves: A, B and C of `A cos(phi) + B sin(phi) + C`. The elbow's bend is given by the distance alone.
        """
        line = np.concatenate([np.zeros_like(self.line[..., :1]), self.line], axis=-1)
        w, x, y, z = _half_waves(self.upper, multiply(line, self.upper))
        square = _times(w, w)
        pairs = [(square, _times(w, x)), (square, _times(w, y)), (square, _times(w, z))]
        # The hand against the forearm's bone: conj(forearm) conj(turn about the line) hand.
        forearm = conjugate(multiply(self.upper, _about_y(self.bend)))
        w, x, y, z = _half_waves(multiply(forearm, self.rotation), -multiply(multiply(forearm, line), self.rotation))
        pairs.append((_times(w, w), _times(w, x)))
        # Less the forearm's turn (w, x) the bend is (w - x i)(y + z i) over w^2 + x^2.
        square = _times(w, w) + _times(x, x)
        pairs += [(square, _times(w, y) + _times(x, z)), (square, _times(w, z) - _times(x, y))]
        return np.stack([np.stack(pair, axis=-2) for pair in pairs], axis=-3)


def swing_of(arm: Arm, wrist: Wrist, side: Array, *, beyond: bool = False) -> Swing:
    """The freedom of wrist poses (...).

    Args:
        arm: its measures; the elbow bends no further than its limit.
        wrist: places (..., 3) and rotations (..., 4) in the shoulder frame.
        side: (..., 3) where the elbow points at swing 0, as far as that is square to the line from shoulder to wrist.
        beyond: the elbow is straightened beyond the line, by as much as it would be bent, whatever its limit.
    """
    distance = np.linalg.norm(wrist.place, axis=-1)
    L1, L2 = arm.lengths
    reach = np.clip(distance, shortest(arm), L1 + L2)
    bend, _ = elbow(arm.lengths, reach)
    bend = np.minimum(bend, _most_bent(arm)) * (-1.0 if beyond else 1.0)
    line = np.where(distance[..., None] < _TINY, np.array([1.0, 0.0, 0.0]), wrist.place)
    line = line / np.linalg.norm(line, axis=-1, keepdims=True)
    outward = _square_to(line, side)
    # The elbow lies at this angle from the line, in the plane of line and outward.
    along, across = L1 + L2 * np.cos(bend), L2 * np.sin(bend)
    x = along[..., None] * line + across[..., None] * outward
    x = x / np.linalg.norm(x, axis=-1, keepdims=True)
    y = cross(outward, line)
    axes: Any = np.stack([x, y, cross(x, y)], axis=-1)
    return Swing(line, bend, distance - reach, from_matrix(axes), wrist.rotation)


def shortest(arm: Arm) -> float:
    """Metres between shoulder and wrist where the elbow is bent as far as it goes."""
    L1, L2 = arm.lengths
    return float(np.sqrt(max(L1**2 + L2**2 + 2.0 * L1 * L2 * np.cos(_most_bent(arm)), 0.0)))


def elbow_side(line: Array, upper: Array) -> Array:
    """Where the elbow points (..., 3), square to the line from shoulder to wrist, of upper arms (..., 4).

    The elbow's axis says it, so a straight arm has a side too.
    """
    return cross(line, rotate(upper, np.array([0.0, 1.0, 0.0])))


def limits_of(arm: Arm) -> Array:
    """The limits (6, 2), radians, of the angles that `Swing.measures` gives."""
    upper, lower, hand = arm.limits
    return np.clip(np.concatenate([upper, lower[:1], hand[1:]]), -np.pi, np.pi)


def allowed(measures: Array, limits: Array) -> Array:
    """The arcs (..., 2 n, 2), radians, begin <= end, on which n measures (..., n, 2, 3) are within limits (..., n, 2).

    In rising order, beginning within [-pi, pi] and ending within a turn of that; the rest is nan. The whole circle is
    one arc from -pi to pi.
    """
    square, product = measures[..., 0, :], measures[..., 1, :]
    low, high = 0.5 * limits[..., :1], 0.5 * limits[..., 1:]
    under = np.sin(high) * square - np.cos(high) * product  # tan(angle / 2) <= tan(high / 2)
    over = np.cos(low) * product - np.sin(low) * square
    A, B, C = np.moveaxis(np.concatenate([under, over], axis=-2), -1, 0)
    half = np.arccos(np.clip(-C / np.maximum(np.hypot(A, B), 1e-300), -1.0, 1.0))
    middle = np.arctan2(B, A)
    # Between two neighbouring ends no wave changes its sign: one place there tells of all.
    ends = np.sort(_wrapped(np.concatenate([middle - half, middle + half], axis=-1)), axis=-1)
    following = np.concatenate([ends[..., 1:], ends[..., :1] + 2.0 * np.pi], axis=-1)
    fine = _fine(square, product, limits, 0.5 * (ends + following))
    begin = np.where(fine & ~np.roll(fine, 1, axis=-1), ends, np.nan)
    end = _end_of_run(fine, ends)
    begin = np.where(end - begin < _SHORTEST, np.nan, begin)
    order = np.argsort(begin, axis=-1)[..., : 2 * limits.shape[-2]]  # nan last
    begin = np.take_along_axis(begin, order, axis=-1)
    arcs = np.stack([begin, np.where(np.isnan(begin), np.nan, np.take_along_axis(end, order, axis=-1))], axis=-1)
    arcs[fine.all(axis=-1), 0] = (-np.pi, np.pi)
    return arcs


def _fine(square: Array, product: Array, limits: Array, phi: Array) -> Any:
    """Whether all measures, waves (..., n, 3), are within limits (..., n, 2) at swings phi (..., m): (..., m).

    By sin((limit - angle) / 2), whose size does not depend on how small square and product are: both vanish where a
    joint is turned by half a turn, and there limits seem met by rounding.
    """
    basis = np.stack([np.cos(phi), np.sin(phi), np.ones_like(phi)], axis=-1)
    s, p = basis @ np.swapaxes(square, -1, -2), basis @ np.swapaxes(product, -1, -2)
    low, high = 0.5 * limits[..., None, :, 0], 0.5 * limits[..., None, :, 1]
    least = -_TOUCHING * np.hypot(s, p)
    under = (np.sin(high) * s - np.cos(high) * p >= least) | (high >= _HALF_TURN)
    over = (np.cos(low) * p - np.sin(low) * s >= least) | (low <= -_HALF_TURN)
    return np.all(under & over, axis=-1)


def nearest_swing(arcs: Array, phi: Array) -> tuple[Array, Any]:
    """The swing (...) within arcs (..., n, 2) that is nearest to phi (...), and whether there is one; else phi."""
    begin, length = arcs[..., 0], arcs[..., 1] - arcs[..., 0]
    whole = length >= 2.0 * np.pi - _SHORTEST
    inset = np.where(whole, 0.0, np.minimum(_INSIDE, 0.5 * length))
    offset = np.mod(phi[..., None] - begin, 2.0 * np.pi)
    kept = np.clip(offset, inset, length - inset)
    around = np.where(offset > np.pi + 0.5 * length, inset, kept)  # nearer to the beginning, the other way round
    moved = _wrapped(around - offset)
    distance = np.where(np.isnan(moved), np.inf, np.abs(moved))
    best = np.argmin(distance, axis=-1)[..., None]
    found: Any = np.isfinite(np.take_along_axis(distance, best, axis=-1)[..., 0])
    return np.where(found, phi + np.take_along_axis(moved, best, axis=-1)[..., 0], phi), found


def _most_bent(arm: Arm) -> float:
    return min(max(float(arm.limits[1, 1, 1]), 0.0), np.pi)


def _half_waves(q0: Array, q1: Array) -> list[Array]:
    """The components of `cos(phi/2) q0 + sin(phi/2) q1`, each as (..., 2)."""
    return [np.stack([q0[..., i], q1[..., i]], axis=-1) for i in range(4)]


def _times(a: Array, b: Array) -> Array:
    """The product of two half waves (..., 2) as a wave (..., 3)."""
    products = np.stack([a[..., 0] * b[..., 0], a[..., 1] * b[..., 1], a[..., 0] * b[..., 1] + a[..., 1] * b[..., 0]])
    return np.moveaxis(products, 0, -1) @ _HALF


def _end_of_run(fine: Any, ends: Array) -> Array:
    """Where the run of fine places that each place is in ends (..., m): at the next end whose place is not fine."""
    m = ends.shape[-1]
    out = np.empty_like(ends)
    last = np.full(ends.shape[:-1], np.nan)
    for j in range(2 * m - 1, -1, -1):
        last = np.where(fine[..., j % m], last, ends[..., j % m] + (2.0 * np.pi if j >= m else 0.0))
        if j < m:
            out[..., j] = last
    return out


def _square_to(line: Array, side: Array) -> Array:
    """The part of a direction square to unit lines (..., 3), of length 1; any where it has none."""
    spare = np.where(np.abs(line[..., 1:2]) < 0.9, np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]))
    square = side - (side * line).sum(axis=-1)[..., None] * line
    none = np.linalg.norm(square, axis=-1)[..., None] < 1e-9
    square = np.where(none, spare - (spare * line).sum(axis=-1)[..., None] * line, square)
    square = square / np.linalg.norm(square, axis=-1, keepdims=True)
    square = square - (square * line).sum(axis=-1)[..., None] * line
    return square / np.linalg.norm(square, axis=-1, keepdims=True)


def _about_y(angle: Array) -> Array:
    return from_axis_angle(np.array([0.0, 1.0, 0.0]), angle)


def _wrapped(angles: Array) -> Array:
    return angles - 2.0 * np.pi * np.round(angles / (2.0 * np.pi))
