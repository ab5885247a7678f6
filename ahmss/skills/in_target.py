"""How deep a hand that reaches, its forearm, and the head that bends over it, are in what is reached for."""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import rotate
from ahmss.grasping.hand import Hand
from ahmss.reaching.performing import Performed
from ahmss.skills.grasping import field_at

__all__ = ["in_target"]

_EVERY = 2  # frames
_HEAD, _ROUND = INDEX["head"], 0.09  # metres
_FLESH = 0.8  # of the forearm's radius, which is less to its sides
_ALONG = np.array([0.3, 0.6, 0.9])


def in_target(task: HumanTask, made: Performed) -> float:
    """Metres by which skin of hand, forearm or head is in the shape of what is reached for, on the way or at its end.

    What is in it already as the hand sets out does not count; 0 where nothing is, or there is no shape.
    """
    thing = task.object
    if thing is None or thing.shape is None or task.site is None:
        return 0.0
    back, side = thing.frame.inverse(), made.plan.reacher.side
    field = field_at(task, back.then(task.site).place)
    hand = Hand.of(task.human, side)
    some = np.unique(np.append(np.arange(0, len(made.root), _EVERY), len(made.root) - 1))
    palms = back.then(Transform.of(made.targets[some, made.plan.reacher.row, :7])).row()
    shape = made.rotations[some][:, list(fingers(side))]
    first = max(hand.depth(field, palms[:1], shape[:1]), 0.0)
    deep = max(hand.depth(field, palms, shape) - first, float(hand.palm_depth(field, palms).max()) - first)
    places, turned = forward(made.rotations[some], made.root[some], task.human.offsets)
    tip = _ALONG[:, None, None] * rotate(turned[:, _HEAD], task.human.tips[_HEAD])
    head = _ROUND - float(field.clearance(back.apply(places[:, _HEAD] + tip)).min())
    arm = INDEX[f"{side}_lower_arm"]
    along = _ALONG[:, None, None] * rotate(turned[:, arm], task.human.tips[arm])
    forearm = _FLESH * float(task.human.radii[arm]) - float(field.clearance(back.apply(places[:, arm] + along)).min())
    return max(deep, head, forearm, 0.0)
