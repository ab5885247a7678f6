"""How near forearm and hand are to things, before the arm is solved: the elbow where it would go by itself."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ahmss.body.arm_choice import present_side
from ahmss.body.arm_swing import swing_of
from ahmss.body.array import Array
from ahmss.body.quaternion import multiply, rotate
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.reacher import Reacher

__all__ = ["MARGIN", "gaps"]

MARGIN = 0.02
"""Metres of air that hand and forearm keep."""

_FOREARM, _HAND = np.linspace(0.0, 1.0, 5)[:-1], np.linspace(0.0, 1.0, 4)
_RADII = np.array([0.042, 0.042, 0.042, 0.04, 0.035, 0.03, 0.022, 0.014])  # metres, from the elbow to the finger tips
_TIPS = 1.95  # of the hand's own link: to the tips of the fingers
_X = np.array([1.0, 0.0, 0.0])


def gaps(reacher: Reacher, palms: Array, spine: tuple[Array, Array], present: Array, prisms: Sequence[Prism]) -> Array:
    """Metres (..., 8) between the skin of forearm and hand and the nearest thing, negative inside.

    Args:
        reacher: the arm.
        palms: (..., 7) in the world.
        spine: the spine link's place (..., 3) and rotation (..., 4) in the world.
        present: (3, 4) the arm's links now, whose elbow goes along.
        prisms: the things.
    """
    place, rotation = reacher.hand(palms)
    arm, wrist = reacher.arm, reacher.wrist(palms, spine)
    links = np.broadcast_to(present, (*wrist.place.shape[:-1], 3, 4))
    swing = swing_of(arm, wrist, present_side(arm, links, wrist.place))
    upper = multiply(spine[1], multiply(arm.rotation, swing.upper))
    elbow = reacher.shoulder(spine) + arm.lengths[0] * rotate(upper, _X)
    along = rotate(rotation, _X) * (_TIPS * reacher.skeleton.tips[reacher.links.stop - 1, 0])
    forearm = elbow[..., None, :] + _FOREARM[:, None] * (place - elbow)[..., None, :]
    hand = place[..., None, :] + _HAND[:, None] * along[..., None, :]
    return clearance(prisms, np.concatenate([forearm, hand], axis=-2)) - _RADII
