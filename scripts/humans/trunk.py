"""Clothes of the trunk and legs: shirt with sleeves, collar, belt, trousers."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ahmss.body.array import Array
from humans.arm import bare_arm, upper_arm_loft
from humans.distance import Field, Loft, bend, cone, ellipsoid, half_space, intersect, join, smooth_max, smooth_min
from humans.figure import Figure

__all__ = ["belt", "collar_plane", "neck_axis", "shirt", "trousers", "trunk_loft"]

_UP, _FORWARD = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
_WAIST = 0.605  # shares of stature: where shirt and trousers meet


def trunk_loft(figure: Figure, thickness: float, low: float = 0.0, high: float = 2.0) -> Loft:
    """The trunk between two heights (shares of stature), grown by a thickness."""
    table = figure.trunk
    shares = np.unique(np.concatenate([np.clip([low, high], table[0, 0], table[-1, 0]), table[:, 0]]))
    shares = shares[(shares >= low) & (shares <= high)]
    stations = np.zeros((len(shares), 5))
    stations[:, 0] = shares * figure.height
    for column in (1, 2, 3):
        stations[:, column] = np.interp(shares, table[:, 0], table[:, column]) * figure.height + thickness
    return Loft(np.zeros(3), _UP, _FORWARD, stations, 2.35)


def neck_axis(figure: Figure) -> tuple[Array, Array]:
    """The neck's middle under the skull and at the collar (3,): it leans forward."""
    head = figure.bind.place("head")
    h = figure.height
    return head + np.array([-0.006, 0.0, 0.045]) * h, head + np.array([-0.013, 0.0, -0.03]) * h


def _both(right: Field) -> Field:
    """A field and its mirror at y = 0, by folding the left onto the right."""
    return lambda p: right(np.column_stack([p[:, 0], -np.abs(p[:, 1]), p[:, 2]]))


def _shoulder(figure: Figure, thickness: float) -> Field:
    """Deltoid and the slope from neck to shoulder."""
    h, joint = figure.height, figure.bind.place("right_upper_arm")
    _, low = neck_axis(figure)
    size = figure.limb * h / 1.76
    top = joint + np.array([-0.010, 0.16 * abs(joint[1]), -0.002 * h])
    slope = cone(low + np.array([-0.012, -0.020, -0.006]) * h, top, 0.026 * h + thickness, 0.029 * size + thickness)
    deltoid = ellipsoid(joint + np.array([0.0, -0.006, -0.017]) * h, np.array([0.049, 0.042, 0.054]) * size + thickness)
    return join((slope, deltoid), 0.04)


def shirt(figure: Figure) -> Field:
    """Trunk and sleeves down to the waist."""
    thickness = 0.006
    body = trunk_loft(figure, thickness, _WAIST - 0.012)  # ends under the belt
    shoulder = _shoulder(figure, thickness)
    if figure.long_sleeves:
        sleeve = bare_arm(figure, thickness + 0.002, 0.03, 1.02)
    else:
        sleeve = upper_arm_loft(figure, thickness + 0.002, 0.03, 0.6)
    chest = _chest(figure, thickness)

    def half(p: Array) -> Array:
        d = smooth_min(body(p), shoulder(p), 0.045)
        d = chest(p, d)
        return smooth_min(d, sleeve(p), 0.03)

    return _neckline(figure, _both(half))


def _chest(figure: Figure, thickness: float) -> Callable[[Array, Array], Array]:
    """The breast's or the chest muscle's addition to a trunk's distance."""
    h = figure.height
    if figure.female:
        centre, radii, k = np.array([0.030, -0.044, 0.722]) * h, np.array([0.044, 0.041, 0.040]) * h + thickness, 0.030
    else:
        centre, radii, k = np.array([0.018, -0.050, 0.738]) * h, np.array([0.046, 0.056, 0.042]) * h + thickness, 0.045
    breast = ellipsoid(centre, radii)
    return lambda p, d: smooth_min(d, breast(p), k)


def _neckline(figure: Figure, body: Field) -> Field:
    """The shirt with its collar, cut out around the neck, with a short slit in front."""
    h = figure.height
    high, low = neck_axis(figure)
    axis = (high - low) / np.linalg.norm(high - low)
    radius = figure.neck[1]
    ring = cone(low - 0.016 * h * axis, low + 0.044 * h * axis, radius + 0.034, radius + 0.006)
    top = half_space(low + np.array([0.0, 0.0, 0.030]) * h, np.array([0.34, 0.0, 1.0]))
    collar = intersect(intersect(ring, top, 0.006), _below(figure, 0.004), 0.004)
    hole = cone(high, low, radius + 0.003, radius + 0.003)
    notch = cone(low + np.array([0.02, 0.0, 0.060]) * h, low + np.array([0.078, 0.0, -0.042]) * h, 0.040 * h, 0.004 * h)
    return lambda p: smooth_max(smooth_max(smooth_min(body(p), collar(p), 0.004), -hole(p), 0.004), -notch(p), 0.006)


def _below(figure: Figure, by: float) -> Field:
    """The half-space above the collar's lower edge, which falls towards the front, lowered by a distance."""
    point, up = collar_plane(figure)
    return half_space(point - by * up, -up)


def collar_plane(figure: Figure) -> tuple[Array, Array]:
    """A point (3,) and the upward normal (3,) of the plane of the collar's lower edge."""
    up = np.array([0.42, 0.0, 1.0])
    return neck_axis(figure)[1] + np.array([0.0, 0.0, 0.008]) * figure.height, up / np.linalg.norm(up)


def belt(figure: Figure) -> Field:
    """A band that hides where shirt and trousers meet."""
    return trunk_loft(figure, 0.012, _WAIST - 0.018, _WAIST + 0.004)


def trousers(figure: Figure) -> Field:
    """Hips and legs down to the hem over the shoes."""
    h, bind = figure.height, figure.bind
    pelvis = trunk_loft(figure, 0.006, 0.0, _WAIST)
    hip, knee, ankle = (bind.place(f"right_{name}") for name in ("upper_leg", "lower_leg", "foot"))
    thigh = Loft(hip, knee - hip, _FORWARD, _leg(figure, float(np.linalg.norm(knee - hip)), (
        (-0.12, 7.6, 8.2, 9.4, 0.4), (0.0, 8.6, 8.6, 10.0, 0.2), (0.15, 8.9, 9.0, 9.6, 0.0), (0.4, 8.2, 8.9, 8.6, 0.0),
        (0.7, 6.8, 7.5, 7.2, 0.0), (0.9, 6.1, 6.7, 6.4, 0.0), (1.0, 5.9, 6.4, 6.2, 0.0), (1.3, 5.8, 6.2, 6.2, 0.0),
    )), 2.15)  # fmt: skip
    shank = Loft(knee, ankle - knee, _FORWARD, _leg(figure, float(np.linalg.norm(ankle - knee)), (
        (-0.3, 5.9, 6.4, 6.2, 0.0), (0.0, 5.9, 6.3, 6.2, 0.0), (0.10, 5.8, 5.9, 6.6, 0.0), (0.28, 6.0, 5.5, 7.6, 0.0),
        (0.5, 5.6, 5.2, 7.2, 0.0),
        (0.75, 5.1, 5.0, 6.3, 0.0), (0.95, 5.2, 5.4, 6.2, 0.0), (1.10, 5.3, 5.7, 6.3, 0.0),
    )), 2.15)  # fmt: skip
    back = -0.030 if figure.female else -0.023
    seat = ellipsoid(hip + np.array([back, 0.004, -0.010]) * h, np.array([0.048, 0.046, 0.052]) * h + 0.004)

    limb = bend(thigh, shank, knee, ankle - hip, 0.045)

    def leg(p: Array) -> Array:
        return smooth_min(limb(p), seat(p), 0.05)

    return lambda p: smooth_min(pelvis(p), _both(leg)(p), 0.045)


def _leg(figure: Figure, length: float, rows: tuple[tuple[float, ...], ...]) -> Array:
    """Stations in metres from shares of a bone and centimetres of a man's leg."""
    table = np.array(rows)
    girth = 0.01 * figure.height / 1.76 * (0.5 + 0.5 * figure.limb)
    out = np.zeros((len(table), 5))
    out[:, 0] = table[:, 0] * length
    out[:, 1:] = table[:, 1:] * girth
    return out
