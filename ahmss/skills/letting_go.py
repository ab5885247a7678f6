"""The fingers of a hand that lets go of what it has laid down: they open, and come to rest as it is drawn back.

They do so as far as what is under them leaves room.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.quaternion import slerp
from ahmss.errors import AlgorithmError
from ahmss.grasping.hand import Hand
from ahmss.grasping.holding import widened
from ahmss.motion.fingers import opened
from ahmss.reaching.prism import Prism
from ahmss.skills.sunk import SUNK, sunk_going

__all__ = ["letting_go"]

_RESTS = (1.0, 0.5, 0.0)  # how far fingers come to rest: the first at which there is room
_EVERY = 3  # frames that are looked at


def letting_go(
    task: HumanTask, palms: Array, shape: Array, open_by: Array, gone: Array, about: Sequence[Prism]
) -> Array:
    """The fingers (n, 14, 4): as wide as the hand came to it, the other way round, and then at rest.

    Args:
        task: who lays down its object. palms: (n, 7). shape: (14, 4) as the fingers hold.
        open_by: (n,) how far they are open, 0 to 1. gone: (n,) how far the hand is drawn back, 0 to 1.
        about: what is about the place.

    Raises:
        AlgorithmError: there is no room for them; says by how much.
    """
    assert task.object is not None
    hand = Hand.of(task.human, task.hand)
    wide = slerp(shape, widened(hand, hand.flexion(shape), hand.thumb(shape)), open_by[:, None])
    deep = np.inf
    for rests in _RESTS:
        shapes = slerp(wide, opened(task.hand, shape[:2]), rests * gone[:, None])
        deep = sunk_going(task, task.hand, palms[::_EVERY], shapes[::_EVERY], about)
        if deep < SUNK:
            return shapes
    raise AlgorithmError(
        f"fingers would be {1000.0 * deep:.0f} mm in what is under {task.object.name} as they let go of it there; say "
        "a higher place, or one that it lies on"
    )
