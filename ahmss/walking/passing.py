"""A foot on its way goes round the leg that bears: legs that would brush each other where they pass are kept apart.

In a straight walk nothing is to be done. After a footstep that is still turned in, the foot would swing straight
through the other leg: it turns out early and goes round.
"""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array

__all__ = ["around"]

_APART = 0.09  # metres from ankle to ankle across the way, where they pass; a straight walk has a little more
_WIDE = 0.12  # the same for a leg that is turned in, whose knee comes first
_LONG = 0.22  # metres ahead or behind, where they do not pass each other yet
_ALONG = 0.7  # cosine of how far from the way the foot that bears may be turned: else one turns on the spot
_BEHIND = 0.08  # metres behind that foot, from where one must come to pass it
_BESIDE = 0.04  # metres ahead of it, to where
_LEAST = 0.2  # of a swing's bump: nearer to its ends a foot is not moved for what is needed there


def around(ankle: Array, u: Array, stands: tuple[Array, float], way: Array, sign: float, *, turned_in: bool) -> Array:
    """By how much the ankle of a swing (n, 2), metres, goes aside at each frame (n, 2), in the world.

    Args:
        ankle: where it would be.
        u: (n,) share of the swing, 0 where the foot leaves the ground and 1 where it lands.
        stands: the ankle (2,) of the foot that bears meanwhile, and that foot's heading, radians.
        way: (2,) from the footstep that it leaves to the next.
        sign: 1 for a left foot, -1 for a right one.
        turned_in: whether the footstep that it leaves is turned otherwise than its way.
    """
    stood, heading = stands
    ahead = way / max(float(np.linalg.norm(way)), 1e-9)
    outward = sign * np.array([-ahead[1], ahead[0]])
    off = ankle - stood
    along = off @ ahead
    faces = float(np.cos(heading) * ahead[0] + np.sin(heading) * ahead[1])
    if faces < _ALONG or along[0] > -_BEHIND or along[-1] < _BESIDE:
        return np.zeros_like(ankle)
    passing = np.clip(1.0 - (along / _LONG) ** 2, 0.0, 1.0)
    lack = ((_WIDE if turned_in else _APART) - off @ outward) * passing
    bump = 64.0 * (u * (1.0 - u)) ** 3
    by = float(np.max(np.where(bump > _LEAST, lack / np.maximum(bump, _LEAST), 0.0), initial=0.0))
    return by * bump[:, None] * outward
