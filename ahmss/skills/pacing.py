"""POSE rows shown more slowly where a hand or an arm would turn too fast."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import slerp
from ahmss.motion.pacing import slowed

__all__ = ["PACE", "paced"]

PACE = np.radians(5.2)
"""What a joint of arm and hand turns in a frame at the most, radians: what is shown goes on from how the body moves."""


def paced(rows: Array, links: list[int], free: Array, most: float = PACE) -> Array:
    """A motion of rows (n, 260 or 272) as (k, as wide), slower where some link turns by more than `most`; k >= n.

    Args:
        rows: of one motion. links: those that count. free: (n) whether a frame may be slowed down: hands may be while
            nobody steps. most: radians a frame.
    """
    rotations = rows[:, 4:176].reshape(-1, 43, 4)
    at = slowed(rotations[:, links], most, free)
    if len(at) == len(rows):
        return rows
    first = np.minimum(at.astype(np.intp), len(rows) - 2)
    share = (at - first)[:, None]
    before, after = rows[first], rows[first + 1]
    out = before + share * (after - before)
    out[:, 4:176] = slerp(rotations[first], rotations[first + 1], share).reshape(-1, 172)
    ends, then = (part[:, 220:260].reshape(-1, 5, 8)[..., 3:7] for part in (before, after))
    turned = (ends != 0.0).any(axis=-1) & (then != 0.0).any(axis=-1)
    one = np.array([1.0, 0.0, 0.0, 0.0])
    between = slerp(np.where(turned[..., None], ends, one), np.where(turned[..., None], then, one), share)
    out[:, 220:260].reshape(-1, 5, 8)[..., 3:7] = np.where(turned[..., None], between, ends)
    return out
