"""How deep a hand that closes comes into what it takes, as its arm can really bring it there."""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import grips, solve
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import slerp
from ahmss.grasping.field import Solid
from ahmss.grasping.hand import Hand
from ahmss.reaching.reacher import SIDES
from ahmss.skills.closing_way import fingers_at, moved_at, palms_at

__all__ = ["closing_depth"]

_LOOKS = np.linspace(0.1, 1.0, 13)  # shares of the time
_SPINE = INDEX["spine"]


def closing_depth(
    task: HumanTask,
    side: str,
    solid: Solid,
    palm: Array,
    fingers_on: tuple[Array, Array | None],
    spine: Array | None = None,
    out: float = 0.0,
    by: float = 1.0,
) -> Array:
    """Metres (n) by which skin of a hand is in the object at some moments while it closes, the last of them closed.

    Args:
        task: whose body it is, as it is now.
        side: the hand.
        solid: the object, in its frame.
        palm: (7,) where it holds, in the world.
        fingers_on: (14, 4) as they hold, and as they open before.
        spine, out, by: as of `ahmss.skills.grasping.Closing`.
    """
    thing, start, row = task.object, task.start, SIDES.index(side)
    assert thing is not None
    links = list(fingers(side))
    shape, wide = fingers_on
    rotations = np.repeat(start.rotations[None], len(_LOOKS), axis=0)
    rotations[:, links] = fingers_at(_LOOKS, start.rotations[links], shape, wide, by)
    if spine is not None:
        rotations[:, _SPINE] = slerp(rotations[:, _SPINE], spine, moved_at(_LOOKS, by))
    root = np.repeat(start.root[None], len(_LOOKS), axis=0)
    targets = np.zeros((len(_LOOKS), 5, 8))
    targets[:, row, :7], targets[:, row, 7] = palms_at(_LOOKS, start.grip(side).row(), palm, out, by), 1.0
    shown = solve(task.human, rotations, root, targets)
    palms = thing.frame.inverse().then(Transform.of(grips(task.human, shown, root)[:, row])).row()
    hand = Hand.of(task.human, side)
    deep = [hand.depth(solid, palms[[k]], shown[[k]][:, links]) for k in range(len(_LOOKS))]
    return np.maximum(np.array(deep), hand.palm_depth(solid, palms))
