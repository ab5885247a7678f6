"""How near arm and hand are to things, before the arm is solved: the elbow where it would go by itself."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from ahmss.body.arm import hand_angles, with_hand
from ahmss.body.arm_choice import present_side
from ahmss.body.arm_swing import HAND, limits_of, swing_of
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import multiply, rotate
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.reacher import Reacher

__all__ = ["ARM", "MARGIN", "UPPER_ARM", "arm_skin", "bare_arm", "gaps", "hand_skin", "limbs", "skin_of"]

MARGIN = 0.02
"""Metres of air that hand and arm keep."""

_UPPER, _THICK = np.array([0.22, 0.5, 0.75])[:, None], np.array([0.055, 0.045, 0.045])  # of the upper arm; metres
UPPER_ARM = slice(0, len(_UPPER))
"""Of what `gaps` gives those of the upper arm."""

ARM = slice(0, 8)
"""Those of upper arm and forearm."""

_FOREARM = np.linspace(0.0, 1.0, 5)[:, None]
_RADII = np.array([0.042, 0.042, 0.042, 0.04, 0.034])  # metres, from the elbow to the wrist
_ALONG = (0.0, 0.5, 1.0)  # of a link
_WRIST = 0.72  # of a forearm's thickness
_X = np.array([1.0, 0.0, 0.0])


def gaps(reacher: Reacher, palms: Array, spine: tuple[Array, Array], present: Array, prisms: Sequence[Prism]) -> Array:
    """Metres (..., 16) between the skin of the arm and the nearest thing, negative inside.

    What is farther than the margin is told to be anywhere beyond it.

    Args:
        reacher: the arm.
        palms: (..., 7) in the world.
        spine: the spine link's place (..., 3) and rotation (..., 4) in the world.
        present: (3, 4) the arm's links now, whose elbow goes along.
        prisms: the things.
    """
    place, _ = reacher.hand(palms)
    arm, wrist = reacher.arm, reacher.wrist(palms, spine)
    links = np.broadcast_to(present, (*wrist.place.shape[:-1], 3, 4))
    swing = swing_of(arm, wrist, present_side(arm, links, wrist.place))
    solved = swing.links(np.zeros(swing.bend.shape))
    low, high = limits_of(arm)[HAND].T
    solved = with_hand(solved, np.clip(hand_angles(solved), low, high))  # turned as far as the joints allow
    upper = multiply(spine[1], multiply(arm.rotation, solved[..., 0, :]))
    rotation = multiply(multiply(upper, solved[..., 1, :]), solved[..., 2, :])
    shoulder, along = reacher.shoulder(spine), arm.lengths[0] * rotate(upper, _X)
    upper_arm = shoulder[..., None, :] + _UPPER * along[..., None, :]
    elbow = shoulder + along
    forearm = elbow[..., None, :] + _FOREARM * (place - elbow)[..., None, :]
    points, radii = _hand(reacher)
    hand = place[..., None, :] + rotate(rotation[..., None, :], points)
    radii = np.concatenate([_THICK, _RADII, radii])
    return clearance(prisms, np.concatenate([upper_arm, forearm, hand], axis=-2), MARGIN + float(radii.max())) - radii


def skin_of(reacher: Reacher, rotations: Array, root: Array) -> tuple[Array, Array]:
    """Points (..., n, 3) in forearm, hand and fingers of poses (..., 43, 4), and how thick skin is around them (n,)."""
    skeleton, links = reacher.skeleton, _links(reacher.side)
    places, turned = forward(rotations, root, skeleton.offsets)
    steps = rotate(turned[..., links, :], skeleton.tips[links])
    points = [places[..., links, :] + share * steps for share in _ALONG]
    radii = np.tile(skeleton.radii[links], (len(_ALONG), 1))
    radii[-1, 0] *= _WRIST
    return np.concatenate(points, axis=-2), radii.ravel()


def arm_skin(reacher: Reacher, rotations: Array, root: Array) -> tuple[Array, Array]:
    """Points (..., n, 3) and radii (n,) of `skin_of`, and of the upper arm."""
    points, radii = skin_of(reacher, rotations, root)
    places, _ = forward(rotations, root, reacher.skeleton.offsets)
    shoulder, elbow = places[..., None, reacher.links.start, :], places[..., None, reacher.links.start + 1, :]
    return np.concatenate([points, shoulder + _UPPER * (elbow - shoulder)], axis=-2), np.concatenate([radii, _THICK])


def limbs(shoulder: Array, elbow: Array, wrist: Array) -> tuple[Array, Array]:
    """Points (..., 8, 3) in upper arm and forearm between joints (..., 3), and how thick skin is around them (8,)."""
    upper = shoulder[..., None, :] + _UPPER * (elbow - shoulder)[..., None, :]
    lower = elbow[..., None, :] + _FOREARM * (wrist - elbow)[..., None, :]
    return np.concatenate([upper, lower], axis=-2), np.concatenate([_THICK, _RADII])


def bare_arm(reacher: Reacher, rotations: Array, root: Array) -> tuple[Array, Array]:
    """Those of poses (..., 43, 4)."""
    places, _ = forward(rotations, root, reacher.skeleton.offsets)
    first = reacher.links.start
    return limbs(places[..., first, :], places[..., first + 1, :], places[..., first + 2, :])


def hand_skin(reacher: Reacher, rotations: Array, root: Array) -> tuple[Array, Array]:
    """Those points (..., n, 3) and radii (n,) of `skin_of` that are the hand's and the fingers'."""
    points, radii = skin_of(reacher, rotations, root)
    own = np.tile(np.arange(len(_links(reacher.side))) > 0, len(_ALONG))
    return points[..., own, :], radii[own]


@lru_cache(maxsize=16)
def _links(side: str) -> list[int]:
    return [INDEX[f"{side}_lower_arm"], INDEX[f"{side}_hand"], *fingers(side)]


@lru_cache(maxsize=16)
def _hand(reacher: Reacher) -> tuple[Array, Array]:
    """Points (8, 3) of an open hand in its own frame, knuckle and tip of each finger, and the skin's radii (8,)."""
    skeleton, points, radii = reacher.skeleton, [], []
    for finger in ("index", "middle", "ring", "little"):
        links = [INDEX[f"{reacher.side}_{finger}_{segment}"] for segment in ("proximal", "intermediate", "distal")]
        knuckle = skeleton.offsets[links[0]]
        points += [knuckle, knuckle + skeleton.tips[links].sum(axis=0)]
        radii += [skeleton.radii[links[0]], skeleton.radii[links[2]]]
    return np.array(points), np.array(radii)
