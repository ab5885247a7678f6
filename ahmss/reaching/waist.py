"""The trunk bent at the waist alone, hips as they are: what one who sits, or is carried by a walk, gives to a reach."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import align, conjugate, from_axis_angle, multiply, rotate
from ahmss.reaching.leaning import EASY, STRETCHED
from ahmss.reaching.reacher import Reacher

__all__ = ["bent_towards", "wanted_stretch"]

_SPINE = INDEX["spine"]
_EASIER = 0.82  # the share of its length that an arm keeps on the way, as far as the waist can give it
_MOST = np.radians(48.0)
_SOFT = np.radians(8.0)  # the last part of it is approached slowly


def wanted_stretch(stretched: Array) -> Array:
    """The share of its length that an arm keeps where it would be stretched so far, shares (...), without the trunk."""
    over = np.maximum(stretched - EASY, 0.0)
    span = STRETCHED - EASY
    return np.minimum(stretched, EASY) + span * (1.0 - np.exp(-over / span))


def bent_towards(
    reacher: Reacher, hips: Array, root: Array, spine: Array, wrist: Array, *, eases: bool = False
) -> Array:
    """The spine's rotations (..., 4), hips <- spine, that bring the shoulder as near to a wrist as the arm asks.

    The shoulder goes round the waist in the plane of the waist, itself and the wrist: the cosine rule says how far.

    Args:
        reacher: the arm.
        hips: (..., 4) world <- hips. root: (..., 3) the hips' place.
        spine: (..., 4) the spine as it is without the reach, hips <- spine.
        wrist: (..., 3) where the wrist shall be, in the world.
        eases: the waist gives all that the arm would be stretched beyond what is easy, as of who is on the way and has
            no other help.
    """
    turned = multiply(hips, spine)
    waist = root + rotate(hips, np.broadcast_to(reacher.skeleton.offsets[_SPINE], root.shape))
    lever = rotate(turned, np.broadcast_to(reacher.arm.place, root.shape))
    to_wrist = wrist - waist
    a, b = np.linalg.norm(lever, axis=-1), np.maximum(np.linalg.norm(to_wrist, axis=-1), 1e-6)
    stretched = np.linalg.norm(to_wrist - lever, axis=-1) / reacher.length
    distance = (np.minimum(stretched, _EASIER) if eases else wanted_stretch(stretched)) * reacher.length
    now = np.arccos(np.clip((lever * to_wrist).sum(axis=-1) / (a * b), -1.0, 1.0))
    then = np.arccos(np.clip((a**2 + b**2 - distance**2) / (2.0 * a * b), -1.0, 1.0))
    angle = _softened(np.maximum(now - then, 0.0))
    axis = np.cross(lever, to_wrist)
    size = np.linalg.norm(axis, axis=-1, keepdims=True)
    axis = np.where(size > 1e-9, axis / np.maximum(size, 1e-9), np.array([0.0, 0.0, 1.0]))
    return align(multiply(conjugate(hips), multiply(from_axis_angle(axis, angle), turned)), spine)


def _softened(angle: Array) -> Array:
    """Angles up to the most that a waist gives, the last of it slowly."""
    start = _MOST - _SOFT
    return np.minimum(angle, start) + _SOFT * (1.0 - np.exp(-np.maximum(angle - start, 0.0) / _SOFT))
