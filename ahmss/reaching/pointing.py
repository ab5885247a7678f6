"""A hand that points: the index finger straight, the others curled, and the palms that bring its pad to a place."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.fingertip import pad
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import IDENTITY, between, conjugate, from_axis_angle, from_matrix, multiply, rotate
from ahmss.body.skeleton import Skeleton

__all__ = ["palms_pointing", "pointing"]

_CURLED = np.radians([70.0, 85.0, 50.0])  # knuckle, middle and end joint of the other fingers
_STRAIGHT = np.radians([8.0, 4.0, 3.0])  # of the index: a finger that pushes is not quite straight
_THUMB = np.radians([45.0, 40.0])  # to the palm, and its end over the middle finger
_ROLLS = np.radians(np.arange(-20.0, 111.0, 10.0))  # from thumb up to palm down
_TILTS = np.radians([-30.0, -15.0, 0.0, 15.0, 30.0, 45.0])  # of the finger against the way it pushes, down and up
_SIDES = np.radians([-15.0, 0.0, 15.0])
_X = np.array([1.0, 0.0, 0.0])


def pointing(side: str) -> Array:
    """Rotations (14, 4) of the fingers of a "right" or "left" hand that points."""
    rotations = np.tile(IDENTITY, (14, 1))
    first, sign = fingers(side)[0], 1.0 if side == "left" else -1.0
    hinge = np.array([0.0, 0.0, sign])
    for finger in ("index", "middle", "ring", "little"):
        angles = _STRAIGHT if finger == "index" else _CURLED
        for segment, angle in zip(("proximal", "intermediate", "distal"), angles, strict=True):
            rotations[INDEX[f"{side}_{finger}_{segment}"] - first] = from_axis_angle(hinge, angle)
    thumb = INDEX[f"{side}_thumb_proximal"] - first
    rotations[thumb] = from_axis_angle(hinge, _THUMB[0])
    rotations[thumb + 1] = from_axis_angle(hinge, _THUMB[1])
    return rotations


def palms_pointing(
    skeleton: Skeleton, side: str, place: Array, into: Array, ahead: Array | None = None, *, exactly: bool = False
) -> Array:
    """Palms (n, 7) whose index finger touches a place with its pad (3,), the finger about along a direction (3,), unit.

    Thumb up to palm down, and the finger also a little tilted against the direction, unless it is to lie along it
    `exactly`: aside, down, and more upwards, as a hand that pushes downwards comes from before.

    Args:
        skeleton: the human's measures. side: of the hand. place: of its pad. into: which way it points.
        ahead: (3,) level, unit: where who points looks; left out: the level of `into`, where that has one.
        exactly: whether the finger lies along `into`.
    """
    tip, along, end, radius = _fingertip(skeleton, side)
    row, sign = (1, 1.0) if side == "left" else (0, -1.0)
    tilts, sides = (np.zeros(1), np.zeros(1)) if exactly else (_TILTS, _SIDES)
    tilt, aside, roll = (a.ravel() for a in np.meshgrid(tilts, sides, _ROLLS, indexing="ij"))
    # A hand whose fingers point along the level of `into`, thumb up: hand x along it, z down.
    down = np.array([0.0, 0.0, -1.0])
    level = into if abs(into[2]) < 0.9 else _X
    across = np.cross(down, level if ahead is None else ahead)
    across = across / np.linalg.norm(across)
    level = np.cross(across, down)
    hand = multiply(between(level, into), from_matrix(np.stack([level, across, down], axis=-1)))
    turn = multiply(from_axis_angle(across, tilt), from_axis_angle(down, aside))
    hand = multiply(turn, multiply(from_axis_angle(into, sign * roll), hand))
    hand = multiply(hand, between(along, _X))  # the finger itself, which is a little bent
    place = place - rotate(hand, pad(tip, end, radius, rotate(conjugate(hand), into)))
    grip = skeleton.grips[row]
    return np.concatenate([place + rotate(hand, grip[:3]), multiply(hand, grip[3:])], axis=-1)


def _fingertip(skeleton: Skeleton, side: str) -> tuple[Array, Array, Array, float]:
    """Of the index finger of a pointing hand its tip (3,), its direction (3,) from the knuckle, that of its end (3,),
    and the radius there; in the hand's frame.
    """
    shape, first = pointing(side), fingers(side)[0]
    links = [INDEX[f"{side}_index_{segment}"] for segment in ("proximal", "intermediate", "distal")]
    place, turned = np.zeros(3), IDENTITY
    for link in links:
        place = place + rotate(turned, skeleton.offsets[link])
        turned = multiply(turned, shape[link - first])
    tip = place + rotate(turned, skeleton.tips[links[-1]])
    along = tip - skeleton.offsets[links[0]]
    return tip, along / np.linalg.norm(along), rotate(turned, _X), float(skeleton.radii[links[-1]])
