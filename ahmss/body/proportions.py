"""Usual human proportions: from a stature and a sex to a skeleton.

Lengths as shares of stature after Drillis & Contini (1966), masses after de Leva (1996), joint ranges after the AAOS.
The shoulder is the joint's centre, 2 % of stature under the acromion that Drillis & Contini measure, and the upper arm
is as much shorter, so that the elbow stays where they have it.
"""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import INDEX, LINKS, fingers
from ahmss.body.quaternion import from_matrix
from ahmss.body.skeleton import Skeleton

__all__ = ["measure"]

# Shares of stature.
_UPPER_ARM, _FOREARM, _THIGH, _SHANK, _ANKLE, _FOOT = 0.170, 0.146, 0.245, 0.246, 0.039, 0.152
_HIP_HEIGHT, _WAIST_HEIGHT, _SHOULDER_HEIGHT, _NECK_HEIGHT, _EYE_HEIGHT = 0.530, 0.590, 0.802, 0.850, 0.936
_HIP_HALF, _SHOULDER_HALF = {"male": 0.050, "female": 0.053}, {"male": 0.112, "female": 0.102}
_HAND = 0.108

# Fingers, in shares of the hand's length: root of each finger (along, across to the thumb, out of the palm), segments,
# and the skin's radius around them. The roots are the knuckles; the thumb's lies half way along its metacarpal, so that
# its two links can both oppose and bend.
_FINGERS = {
    "thumb": ((0.17, 0.13, 0.05), (0.29, 0.18), (0.062, 0.052)),
    "index": ((0.46, 0.13, 0.0), (0.245, 0.14, 0.11), (0.050, 0.045, 0.040)),
    "middle": ((0.47, 0.03, 0.0), (0.26, 0.16, 0.11), (0.050, 0.045, 0.040)),
    "ring": ((0.45, -0.07, 0.0), (0.245, 0.15, 0.11), (0.048, 0.043, 0.038)),
    "little": ((0.41, -0.165, 0.0), (0.195, 0.115, 0.10), (0.042, 0.038, 0.034)),
}
_PALM = 0.085  # from the plane of the knuckles to the palm's skin
# The skin's mean radius around the other links, in shares of stature.
_RADII = {
    "hips": 0.085, "spine": 0.085, "head": 0.045, "upper_arm": 0.027, "lower_arm": 0.023, "hand": 0.009,
    "upper_leg": 0.045, "lower_leg": 0.030, "foot": 0.025,
}  # fmt: skip
_SEGMENTS = {2: ("proximal", "distal"), 3: ("proximal", "intermediate", "distal")}

# Percent of body mass (de Leva 1996): head, trunk, upper arm, forearm, hand, thigh, shank, foot.
_MASS = {
    "male": (6.94, 43.46, 2.71, 1.62, 0.61, 14.16, 4.33, 1.37),
    "female": (6.68, 42.57, 2.55, 1.38, 0.56, 14.78, 4.81, 1.29),
}
_PELVIS_SHARE = 0.257  # of the trunk's mass: the part below the waist
_BODY_MASS_INDEX = 22.0

# Ranges in degrees about each link's x, y, z from upright (right side; x and z mirror to the left). The thumb's first
# link stands for two joints: out of the palm it goes by the abduction of the one at the wrist, 70 degrees, and by the
# flexion of the next, 50 (AAOS, Joint Motion: Method of Measuring and Recording, 1965).
_LIMITS = {
    "hips": ((-180, 180), (-180, 180), (-180, 180)),
    "spine": ((-45, 45), (-25, 80), (-35, 35)),
    "head": ((-80, 80), (-45, 45), (-45, 45)),
    "upper_arm": ((-90, 90), (-180, 180), (-180, 180)),
    "lower_arm": ((-85, 85), (-5, 150), (-10, 10)),
    "hand": ((-10, 10), (-35, 25), (-80, 80)),
    "upper_leg": ((-45, 45), (-125, 35), (-50, 50)),
    "lower_leg": ((-10, 10), (-2, 150), (-8, 8)),
    "foot": ((-25, 25), (-30, 60), (-25, 25)),
    "thumb_proximal": ((-60, 60), (-30, 80), (-120, 30)),
    "thumb_distal": ((-10, 10), (-10, 10), (-85, 20)),
    "finger": ((-10, 10), (-20, 20), (-100, 45)),
}


def measure(stature: float, sex: str, name: str) -> Skeleton:
    """The skeleton of usual proportions for a stature (metres) and a sex ("male" or "female")."""
    offsets, tips = _lengths(stature, sex)
    hand = _HAND * stature
    return Skeleton(
        name=name, stature=stature, sex=sex, offsets=offsets, tips=tips,
        mass=_masses(stature, sex), radii=_radii(stature), limits=_limits(), grips=_grips(hand), soles=_soles(stature),
        eye=np.array([(_EYE_HEIGHT - _NECK_HEIGHT) * stature, 0.0, -0.050 * stature]),
    )  # fmt: skip


def _lengths(h: float, sex: str) -> tuple[Array, Array]:
    """Offsets and tips, both (43, 3)."""
    offsets, tips = np.zeros((len(LINKS), 3)), np.zeros((len(LINKS), 3))
    offsets[INDEX["spine"]] = ((_WAIST_HEIGHT - _HIP_HEIGHT) * h, 0.0, 0.0)
    offsets[INDEX["head"]] = ((_NECK_HEIGHT - _WAIST_HEIGHT) * h, 0.0, 0.0)
    tips[INDEX["hips"]] = offsets[INDEX["spine"]]
    tips[INDEX["spine"]] = offsets[INDEX["head"]]
    tips[INDEX["head"]] = ((1.0 - _NECK_HEIGHT) * h, 0.0, 0.0)
    for side, sign in (("right", -1.0), ("left", 1.0)):
        chain = (
            ("upper_arm", ((_SHOULDER_HEIGHT - _WAIST_HEIGHT) * h, sign * _SHOULDER_HALF[sex] * h, 0.0), _UPPER_ARM),
            ("lower_arm", (_UPPER_ARM * h, 0.0, 0.0), _FOREARM),
            ("hand", (_FOREARM * h, 0.0, 0.0), 0.5 * _HAND),
            ("upper_leg", (0.0, sign * _HIP_HALF[sex] * h, 0.0), _THIGH),
            ("lower_leg", (_THIGH * h, 0.0, 0.0), _SHANK),
            ("foot", (_SHANK * h, 0.0, 0.0), 0.75 * _FOOT),
        )
        for link, offset, length in chain:
            offsets[INDEX[f"{side}_{link}"]] = offset
            tips[INDEX[f"{side}_{link}"]] = (length * h, 0.0, 0.0)
        _finger_lengths(offsets, tips, side, sign, _HAND * h)
    return offsets, tips


def _finger_lengths(offsets: Array, tips: Array, side: str, sign: float, hand: float) -> None:
    """Fill in the fingers of one hand of the given length; the palm is at sign * y, the thumb at -z."""
    for finger, ((along, thumbwards, palmwards), lengths, _) in _FINGERS.items():
        for i, segment in enumerate(_SEGMENTS[len(lengths)]):
            link = INDEX[f"{side}_{finger}_{segment}"]
            base = (along * hand, sign * palmwards * hand, -thumbwards * hand)
            offsets[link] = base if i == 0 else (lengths[i - 1] * hand, 0.0, 0.0)
            tips[link] = (lengths[i] * hand, 0.0, 0.0)


def _masses(stature: float, sex: str) -> Array:
    """Masses (43,) in kilograms; each finger link bears an even share of two fifths of its hand."""
    head, trunk, upper_arm, forearm, hand, thigh, shank, foot = (m / 100.0 for m in _MASS[sex])
    shares = {"upper_arm": upper_arm, "lower_arm": forearm, "hand": 0.6 * hand}
    shares |= {"upper_leg": thigh, "lower_leg": shank, "foot": foot}
    mass = np.zeros(len(LINKS))
    mass[INDEX["head"]] = head
    mass[INDEX["hips"]], mass[INDEX["spine"]] = _PELVIS_SHARE * trunk, (1.0 - _PELVIS_SHARE) * trunk
    for side in ("right", "left"):
        for link, share in shares.items():
            mass[INDEX[f"{side}_{link}"]] = share
        mass[list(fingers(side))] = 0.4 * hand / 14.0
    return mass / mass.sum() * _BODY_MASS_INDEX * stature**2


def _radii(stature: float) -> Array:
    """The skin's mean radius (43,) around each link, metres."""
    radii = np.zeros(len(LINKS))
    for i, name in enumerate(LINKS):
        key = next((k for k in _RADII if name.endswith(k)), "")
        if key:
            radii[i] = _RADII[key] * stature
            continue
        _, finger, segment = name.split("_")
        shares = _FINGERS[finger][2]
        radii[i] = shares[_SEGMENTS[len(shares)].index(segment)] * _HAND * stature
    return radii


def _limits() -> Array:
    """Joint ranges (43, 3, 2) in radians; what turns about x or z is mirrored for the left."""
    limits = np.zeros((len(LINKS), 3, 2))
    for i, name in enumerate(LINKS):
        key = next((k for k in _LIMITS if name.endswith(k)), "finger")
        limits[i] = np.radians(_LIMITS[key])
        if name.startswith("left"):
            limits[i, 0], limits[i, 2] = -limits[i, 0, ::-1], -limits[i, 2, ::-1]
    return limits


def _grips(hand: float) -> Array:
    """Palm frames (2, 7), right and left: on the palm's surface, x out of it, z to the thumb."""
    grips = np.zeros((2, 7))
    for row, sign in ((0, -1.0), (1, 1.0)):
        x, z = np.array([0.0, sign, 0.0]), np.array([0.0, 0.0, -1.0])
        grips[row, :3] = (0.40 * hand, sign * _PALM * hand, -0.01 * hand)
        grips[row, 3:] = from_matrix(np.stack([x, np.cross(z, x), z], axis=-1))
    return grips


def _soles(h: float) -> Array:
    """Heel, ball and toe tip (3, 3) in the right foot's frame, metres: x forward, z up, on the floor when upright."""
    ankle, foot = _ANKLE * h, _FOOT * h
    return np.array([[-0.24 * foot, 0.0, -ankle], [0.48 * foot, -0.02 * foot, -ankle], [0.76 * foot, 0.0, -ankle]])
