"""A sole on the floor and just over it: how it rolls over heel and toe, and how far off it keeps in the air.

What is nearer to the floor than two millimetres and moves seems to slide over it.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d
from shapely import LineString

from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.motion.easing import minimum_jerk

__all__ = ["CLEAR", "FLAT", "clearance", "middle", "pushed_off", "rolled", "sole_angles", "turned"]

CLEAR = 0.0022  # metres that a foot is over the floor, at least, in its first and last frame in the air
FLAT = 1e-6  # radians of pitch over which a foot stands on its heel
_FALL, _RISE = 7.0, 6.0  # how soon what a foot is higher is over, before it lands and after it has lifted
# Frames over which a foot's pitch is smoothed as it pushes off, how many before and after count; and how far the toes
# point down, radians, from where on it is smoothed in full.
_SOFTLY, _COUNT, _DOWN = 2.0, 4, 0.08
_UP, _LEFT, _FORWARD = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0])


def sole_angles(feet: Array) -> tuple[Array, Array]:
    """Heading without jumps and pitch (toes up), both (F, ...), of feet (F, ..., 4)."""
    ahead = rotate(feet, _FORWARD)
    return np.unwrap(np.arctan2(ahead[..., 1], ahead[..., 0]), axis=0), np.arcsin(np.clip(ahead[..., 2], -1.0, 1.0))


def pushed_off(pitch: Array) -> Array:
    """A foot's pitch (F,), from a landing to the next, with a softer push-off.

    The heel rises sooner, and the toes leave less fast: an ankle and a knee that follow a heel which
    rises all at once would leap.
    """
    share = minimum_jerk(-pitch / _DOWN)
    return pitch + share * (gaussian_filter1d(pitch, _SOFTLY, mode="nearest", radius=_COUNT) - pitch)


def middle(soles: Array, place: Array, heading: float) -> LineString:
    """The line on the floor from heel to toe of a flat foot, its ankle over a place (2,)."""
    ahead = np.array([np.cos(heading), np.sin(heading)])
    return LineString([place + soles[0, 0] * ahead, place + soles[2, 0] * ahead])


def turned(yaw: Array, pitch: Array) -> Array:
    """Rotations (..., 4) of feet with a heading and a pitch."""
    return multiply(from_axis_angle(_UP, yaw), from_axis_angle(_LEFT, -pitch))


def rolled(place: Array, heading: Array | float, yaw: Array, pitch: Array, soles: Array) -> Array:
    """The ankle (F, 3) of a foot that bears, turned about its heel while its toes are up, else about its toes.

    Args:
        place, heading: of the ankle, (2,) or (F, 2), and of the foot where it stands flat; radians.
        yaw, pitch: (F,), of the foot as it is.
        soles: (3, 3) its heel, ball and toe.
    """
    level = np.full((*np.shape(heading), 1), -soles[0, 2])
    toe = np.concatenate([place, level], axis=-1) + rotate(from_axis_angle(_UP, heading), soles[2])
    heel = toe - rotate(from_axis_angle(_UP, yaw), soles[2] - soles[0])
    q = turned(yaw, pitch)
    on_heel = (pitch > FLAT)[:, None]
    return np.where(on_heel, heel - rotate(q, soles[0]), toe - rotate(q, soles[2]))


def clearance(u: Array, step: Array) -> Array:
    """By how much a foot is higher in the air (F,), metres, at shares u of its swing, of which a frame is `step`.

    CLEAR in its first and its last frame; it comes down the way from a little higher, as the leg, almost straight,
    would else bend at once.
    """
    left = 1.0 - u
    lifted = (left / np.maximum(1.0 - step, 1e-9)) ** _RISE
    landing = left * u**_FALL / np.maximum(step * (1.0 - step) ** _FALL, 1e-9)
    return CLEAR * (lifted + landing)
