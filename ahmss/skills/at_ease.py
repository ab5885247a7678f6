"""A motion that was made whole, slower where a joint or a palm would turn faster than of people who are in no hurry.

What follows a reach (closing, leading, letting go, going back) has a pace of its own, which an arm that is nearly
stretched, or turns far, may not have. What the shipped algorithms share, and an author may use.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import LEFT_HAND, RIGHT_HAND, solve
from ahmss.body.links import INDEX, LINKS
from ahmss.reaching.arm_on_way import AIMED

__all__ = ["at_ease", "resampled", "times_at_ease"]

_PALM = np.radians(7.5)  # in a frame, that a palm turns in the world
_WIDE, _SMOOTH = 15, 4.0  # frames around what is too fast, and over which the pace changes
_JOINTS = [i for i, link in enumerate(LINKS) if link.endswith(("arm", "hand")) or i in (INDEX["spine"], INDEX["head"])]
_ROTATIONS, _TARGETS = slice(4, 176), slice(220, 260)  # of a row
_ROUNDS = 6  # of making it slower
_RATE = 60.0  # frames a second that the figures are for


def at_ease(task: HumanTask, rows: Array) -> Array:
    """POSE rows (n, 260) of a motion, more of them where it is too fast; as they are where their number was said.

    An elbow that leaves straight bends by as the root of how far its hand goes, so that once may not be enough.
    """
    for _ in range(_ROUNDS):
        times = times_at_ease(task, rows)
        if len(times) == len(rows):
            break
        rows = resampled(rows, times)
    return rows


def times_at_ease(task: HumanTask, rows: Array, links: Sequence[int] = (), *, wish: bool = False) -> Array:
    """The times (m,), in frames of rows (n, 260), at which these are to be shown, from 0 to n - 1.

    Args:
        task: who, and whether the number of frames was said. rows: the motion.
        links: further joints that count, as a hand's fingers. wish: whether the number that was said is but a wish.
    """
    n, rate = len(rows), task.rate
    if n < 3 or (task.length and not wish):
        return np.arange(float(n))
    targets = rows[:, _TARGETS].reshape(n, 5, 8)
    shown = solve(task.human, rows[:, _ROTATIONS].reshape(n, 43, 4), rows[:, 1:4], targets)
    rotations, targets = shown[:, [*_JOINTS, *links]], targets[:, RIGHT_HAND : LEFT_HAND + 1]
    palms = _turned(targets[..., 3:7]) * (targets[1:, :, 7] > 0.0) * (targets[:-1, :, 7] > 0.0)
    fast = np.maximum(_turned(rotations).max(axis=-1) / AIMED, palms.max(axis=-1) / _PALM) * rate / _RATE
    if fast.max() <= 1.0:
        return np.arange(float(n))
    slower = gaussian_filter1d(maximum_filter1d(np.maximum(fast, 1.0), _WIDE, mode="nearest"), _SMOOTH, mode="nearest")
    at = np.concatenate([[0.0], np.cumsum(slower)])
    count = int(np.ceil(at[-1]))
    return np.interp(np.arange(count + 1), at * count / at[-1], np.arange(float(n)))


def resampled(rows: Array, times: Array) -> Array:
    """POSE rows (m, 260) at times (m,) in frames of rows (n, 260), between which hardly anything turns."""
    before = np.minimum(times.astype(np.intp), len(rows) - 1)
    after = np.minimum(before + 1, len(rows) - 1)
    share = (times - before)[:, None]
    out = (1.0 - share) * rows[before] + share * rows[after]
    rotations = rows[:, _ROTATIONS].reshape(len(rows), 43, 4)
    out[:, _ROTATIONS] = _between(rotations[before], rotations[after], share).reshape(len(times), 172)
    targets, made = rows[:, _TARGETS].reshape(len(rows), 5, 8), out[:, _TARGETS].reshape(len(times), 5, 8)
    made[..., 3:7] = _between(targets[before, :, 3:7], targets[after, :, 3:7], share)
    out[:, _TARGETS] = made.reshape(len(times), 40)
    return out


def _turned(rotations: Array) -> Array:
    """Radians (n - 1, m) from frame to frame of rotations (n, m, 4); 0 where there are none."""
    cos = np.abs((rotations[1:] * rotations[:-1]).sum(axis=-1))
    return np.where(cos > 0.0, 2.0 * np.arccos(np.clip(cos, 0.0, 1.0)), 0.0)


def _between(first: Array, last: Array, share: Array) -> Array:
    """Between rotations (m, k, 4) that differ little, at shares (m, 1), by the shorter way; zeros stay zeros."""
    last = np.where((first * last).sum(axis=-1, keepdims=True) < 0.0, -last, last)
    mixed = (1.0 - share[..., None]) * first + share[..., None] * last
    length = np.linalg.norm(mixed, axis=-1, keepdims=True)
    return np.divide(mixed, length, out=np.zeros_like(mixed), where=length > 0.0)
