"""Which of several palms an arm takes most easily: what its joints allow, near the middle of their ranges.

Where the wrist is free to turn, a person takes the turn that ends comfortably (Rosenbaum's end-state comfort).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ahmss.body.arm import hand_angles
from ahmss.body.arm_choice import present_side
from ahmss.body.arm_swing import allowed, limits_of, nearest_swing, swing_of
from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, from_matrix, multiply, rotate
from ahmss.reaching.reacher import Reacher

__all__ = ["across", "around_axis", "discomfort", "palms_at", "solved"]

_OVER, _MISSING = 8.0, 60.0  # what an arm costs that no swing of the elbow serves, and a metre too far
_ACROSS, _RIGHT_HANDED = 3.0, 0.15  # what a metre across the body costs, and the left hand at all
_RAISED, _CHANGE = 0.25, 0.3  # what an upper arm at shoulder height costs, and an elbow swung by a radian
_WEIGHTS = np.array([1.0, 2.0, 1.0])  # forearm's turn, hand's bend to the sides, to palm and back
_YAWS = np.radians(np.arange(-15.0, 106.0, 10.0))
_ROLLS = np.radians(np.arange(-45.0, 136.0, 15.0))
_PITCHES = np.radians([-35.0, -10.0, 15.0])
_ASIDE = np.radians([-25.0, 0.0, 25.0, 50.0])
_UP = np.array([0.0, 0.0, 1.0])


def discomfort(reacher: Reacher, grip: Array, spine: tuple[Array, Array], present: Array) -> tuple[Array, Any, Array]:
    """What palms (..., 7) cost an arm, whether its joints can take them, and the metres that they are too far or near.

    Args:
        reacher: the arm.
        grip: palms in the world.
        spine: place (..., 3) and rotation (..., 4) of the spine link.
        present: (3, 4) the arm's present links, whose elbow goes along.
    """
    arm, limits = reacher.arm, limits_of(reacher.arm)
    links, phi, found, missing = _swung(reacher, grip, spine, present)
    half = 0.5 * (limits[3:, 1] - limits[3:, 0])
    bent = (hand_angles(links) - 0.5 * limits[3:].sum(axis=-1)) / half
    cost = (_WEIGHTS * bent**2).sum(axis=-1) + _CHANGE * phi**2
    down = rotate(spine[1], rotate(multiply(arm.rotation, links[..., 0, :]), np.array([1.0, 0.0, 0.0])))[..., 2]
    cost = cost + _RAISED * (1.0 + down) ** 2 + np.where(found, 0.0, _OVER)
    return cost + _MISSING * missing, found, missing


def solved(reacher: Reacher, grip: Array, spine: tuple[Array, Array], present: Array) -> Array:
    """The arm's links (..., 3, 4) for palms (..., 7), the elbow as near to where it is as the joints allow."""
    return _swung(reacher, grip, spine, present)[0]


def _swung(
    reacher: Reacher, grip: Array, spine: tuple[Array, Array], present: Array
) -> tuple[Array, Array, Any, Array]:
    """Links (..., 3, 4), the elbow's swing (...), whether the joints allow it, metres too far or near."""
    arm, wrist = reacher.arm, reacher.wrist(grip, spine)
    links = np.broadcast_to(present, (*wrist.place.shape[:-1], 3, 4))
    swing = swing_of(arm, wrist, present_side(arm, links, wrist.place))
    phi, found = nearest_swing(allowed(swing.measures(), limits_of(arm)), np.zeros(swing.bend.shape))
    return swing.links(phi), phi, found, np.abs(swing.missing)


def across(reacher: Reacher, place: Array, shoulder: Array, heading: float) -> float:
    """What it costs an arm to come to a place (3,) on the other side of its shoulder (3,), for who faces a heading."""
    left = np.array([-np.sin(heading), np.cos(heading), 0.0])
    own = _RIGHT_HANDED if reacher.sign > 0.0 else 0.0
    return own + _ACROSS * max(-reacher.sign * float((place - shoulder) @ left), 0.0)


def around_axis(site: Array, sign: float) -> Array:
    """Palms' rotations (n, 4) around the z axis of a site (7) whose x points away from the human.

    Turned to the hand's own side: a right hand looks ahead and to the left.
    """
    return multiply(site[3:7], from_axis_angle(_UP, -sign * _YAWS))


def palms_at(shoulder: Array, place: Array, sign: float) -> Array:
    """Natural rotations (n, 4) of a palm that comes to a place (3,) from a shoulder (3,), no orientation being given.

    The fingers point on from the shoulder, a little aside and up or down; the palm looks inward (0) to down (90).
    """
    ahead, rise = _direction(shoulder, place)
    aside, pitch, roll = (a.ravel() for a in np.meshgrid(_ASIDE, _PITCHES, _ROLLS, indexing="ij"))
    return _palm(sign, ahead - sign * aside, pitch - 0.6 * rise, roll)


def _direction(shoulder: Array, place: Array) -> tuple[float, float]:
    """Heading and rise, radians, from a shoulder to a place."""
    x, y, z = (place - shoulder).tolist()
    return float(np.arctan2(y, x)), float(np.clip(np.arctan2(z, np.hypot(x, y)), -1.2, 1.0))


def _palm(sign: float, heading: Array, pitch: Array, roll: Array) -> Array:
    """Rotations (..., 4) of palms whose fingers point at a heading, pitched down, rolled from inward to down."""
    # Grip axes of a hand that points along +x, thumb up: fingers are -y of the right grip's frame, +y of the left's.
    inward = np.array([0.0, -sign, 0.0])
    pointing = from_matrix(np.stack([inward, np.cross(_UP, inward), _UP], axis=-1))
    turn = multiply(from_axis_angle(_UP, heading), from_axis_angle(np.array([0.0, 1.0, 0.0]), pitch))
    return multiply(multiply(turn, from_axis_angle(np.array([1.0, 0.0, 0.0]), sign * roll)), pointing)
