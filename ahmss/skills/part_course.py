"""The frames in which a hand comes to a part, closes, goes with it, opens, leaves it and returns: where its palm is."""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.quaternion import rotate
from ahmss.motion.easing import minimum_jerk
from ahmss.skills.part_ways import Part, on_part

__all__ = ["along", "course", "moved"]

_COMES, _CLOSES, _OPENS, _LEAVES, _RETURNS = 0.3, 0.25, 0.2, 0.35, 0.4  # seconds


def along(part: Part, palms: Array) -> Array:
    """Where palms (n, 7) that are on the part now are before it, and when it has gone its way, off it and on it."""
    ends = np.array([0.0, 1.0, 1.0])
    places = on_part(part, palms, ends)
    places[:2, :, :3] += rotate(part.way(ends[:2])[1], part.off)[:, None]
    return places


def moved(task: HumanTask, part: Part, set_at: Array) -> tuple[Array, Array]:
    """Palms (n, 7) from before the part, where the hand is set (7,), to it, with it, off it, and back to where they
    came from; and how far the fingers are closed (n), 0 to 1.
    """
    way, closed, back = course(task, part)
    palms = on_part(part, part.palm(set_at).row()[None], way)[:, 0]
    palms[:, :3] += back[:, None] * rotate(part.way(way)[1], part.off)
    return palms, closed


def course(task: HumanTask, part: Part) -> tuple[Array, Array, Array]:
    """From before the part on, the shares of its way (n), how far the fingers are closed (n), and the hand off (n)."""
    counts = [round(seconds * task.rate) for seconds in (_COMES, _CLOSES, part.seconds, _OPENS, _LEAVES, _RETURNS)]
    share = [minimum_jerk(np.arange(1, count + 1) / count) for count in counts]
    zero = [np.zeros(count) for count in counts]
    back = np.concatenate([1.0 - share[0], zero[1], zero[2], zero[3], share[4], zero[5] + 1.0])
    way = np.concatenate([zero[0], zero[1], share[2], zero[3] + 1.0, zero[4] + 1.0, 1.0 - share[5]])
    closed = np.concatenate([zero[0], share[1], zero[2] + 1.0, 1.0 - share[3], zero[4], zero[5]])
    return way, closed, back
