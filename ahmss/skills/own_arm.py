"""One's own other arm in the way of what a hand carries: as it is held up beside it, where it has just let go, say."""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, rotate
from ahmss.reaching.performing import Performed
from ahmss.reaching.reacher import SIDES, Reacher
from ahmss.reaching.skin import hand_skin, skin_of

__all__ = ["in_own_arm"]

_EVERY = 2  # frames
_LEVEL = np.array([1.0, 1.0, 0.0])


def in_own_arm(task: HumanTask, made: Performed, held: Transform) -> tuple[float, Array]:
    """How deep, metres, what a hand carries on its way is in forearm or hand of the other arm at the most.

    It is taken as the box around it; 0 where its shape is not known. And the level unit vector (3,) away from that
    hand, as the thing is beside it at the start: to that side it passes it. held: the thing, the task's object, in the
    palm's frame.
    """
    thing = task.object
    if thing is None or thing.shape is None:
        return 0.0, np.zeros(3)
    low, high = thing.shape.vertices.min(axis=0), thing.shape.vertices.max(axis=0)
    other = Reacher.of(task.human, SIDES[1 - made.plan.reacher.row])
    points, radii = skin_of(other, made.rotations[::_EVERY], made.root[::_EVERY])
    palms = made.targets[::_EVERY, made.plan.reacher.row, :7]
    place, turned = palms[:, :3] + rotate(palms[:, 3:], held.place), multiply(palms[:, 3:], held.rotation)
    seen = rotate(conjugate(turned)[:, None], points - place[:, None])
    outside = np.maximum(low - seen, seen - high)
    apart = np.linalg.norm(np.maximum(outside, 0.0), axis=-1) + np.minimum(outside.max(axis=-1), 0.0)
    hand = hand_skin(other, task.start.rotations, task.start.root)[0].mean(axis=0)
    begins = Transform.of(made.plan.hands[made.plan.reacher.row]).then(held)
    away = (begins.apply(0.5 * (low + high)) - hand) * _LEVEL
    return max(float((radii - apart).max()), 0.0), away / max(float(np.linalg.norm(away)), 1e-9)
