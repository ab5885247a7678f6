"""How wide a hand opens about a part: less where its thumb or a finger would be in what is beside."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, rotate, slerp
from ahmss.grasping.hand import Hand
from ahmss.skills.box import Box, nearest

__all__ = ["opens_by"]

_SHARES = (1.0, 0.8, 0.65, 0.5)  # of as wide as it opens, that are tried
_BALLS, _EACH = 3, 6  # every so many of a link's balls, its ends among them; frames
_FAR, _DEEP = 0.03, 0.001  # metres: what is farther is not looked at; that balls may be in a box, where skin is not


def opens_by(
    task: HumanTask, side: str, palms: Array, closed: Array, fingers: tuple[Array, Array], boxes: Sequence[Box]
) -> float:
    """The largest share of as wide as it opens at which a hand's skin is in no box, or the one least deep in one.

    Args:
        side: the hand. palms: (n, 7) on its way, in the world. closed: (n,) how far it is closed there, 0 to 1.
        fingers: (14, 4) as they are wide open, and closed. boxes: what is beside.
    """
    some = np.flatnonzero(closed < 1.0)[::_EACH]
    if not boxes or not len(some):
        return _SHARES[0]
    hand, (wide, shape) = Hand.of(task.human, side), fingers
    turned = multiply(palms[some, 3:], conjugate(hand.grip[3:]))
    wrist = palms[some, :3] - rotate(turned, hand.grip[:3])
    gaps: list[float] = []
    for share in _SHARES:
        middles, radii = hand.balls(slerp(wide, shape, 1.0 - share * (1.0 - closed[some, None])))
        own, skin = middles[..., ::_BALLS, :].reshape(len(some), -1, 3), radii[:, ::_BALLS].ravel()
        places = (wrist[:, None] + rotate(turned[:, None], own)).reshape(-1, 1, 3)
        gaps.append(float((nearest(boxes, places, _FAR).reshape(len(some), -1) - skin).min()))
        if gaps[-1] > -_DEEP:
            break
    return _SHARES[int(np.argmax(gaps))]
