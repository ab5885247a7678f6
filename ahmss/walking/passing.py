"""A foot on its way goes round the leg that bears: legs that would brush each other where they pass are kept apart.

In a straight walk nothing is to be done. A leg that is still turned in would swing its knee, if not its foot, straight
through the other leg: it goes round.
"""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array

__all__ = ["around"]

_APART = 0.09  # metres across the way from leg to leg, where they pass
_LONG = 0.22, 0.35  # metres ahead or behind, where they do not pass each other yet: ankles, knees
_KNEE = 0.25  # metres that the knee of a leg in the air is ahead of its ankle; that of the other leg is over it
_HIPS = 0.17  # metres from hip to hip: knees are half as far apart as ankles, and half as far as hips
_ALONG = 0.7  # cosine of how far from the way the foot that bears may be turned: else one turns on the spot
_BEHIND = 0.08  # metres behind that foot, from where one must come to pass it
_BESIDE = 0.05  # metres behind it that one must come to
_RISES, _FALLS = 3, (3, 5)  # how a way aside begins, and ends: the later it is needed, the later
_LEAST = 0.25  # of a swing's bump: nearer to its ends a foot is not moved for what is needed there


def around(ankle: Array, u: Array, heading: Array, stands: tuple[Array, float], way: Array, sign: float) -> Array:
    """By how much the ankle of a swing (n, 2), metres, goes aside at each frame (n, 2), in the world.

    Args:
        ankle: where it would be.
        u: (n,) share of the swing, 0 where the foot leaves the ground and 1 where it lands.
        heading: (n,) of the foot, radians.
        stands: the ankle (2,) of the foot that bears meanwhile, and that foot's heading, radians.
        way: (2,) from the footstep that it leaves to the next.
        sign: 1 for a left foot, -1 for a right one.
    """
    stood = stands[0]
    ahead = way / max(float(np.linalg.norm(way)), 1e-9)
    outward = sign * np.array([-ahead[1], ahead[0]])
    along = (ankle - stood) @ ahead
    if _ahead(stands[1]) @ ahead < _ALONG or along[0] > -_BEHIND or along[-1] < -_BESIDE:
        return np.zeros_like(ankle)
    needed = np.zeros(len(u))
    off = ankle - stood
    knee = off + _KNEE * _ahead(heading)
    across = off @ outward, knee @ outward + 0.5 * (_HIPS - off @ outward)
    for along, apart, long in zip((off @ ahead, knee @ ahead), across, _LONG, strict=True):
        passing = np.clip(1.0 - (along / long) ** 2, 0.0, 1.0)
        needed = np.maximum(needed, (_APART - apart) * passing)
    aside = min((_covering(needed, u, falls) for falls in _FALLS), key=lambda one: float(one.max()))
    return aside[:, None] * outward


def _covering(needed: Array, u: Array, falls: int) -> Array:
    """What is `needed` (n,), and more, as a bump over a swing that falls as (1 - u) to a power."""
    peak = _RISES / (_RISES + falls)
    bump = (u / peak) ** _RISES * ((1.0 - u) / (1.0 - peak)) ** falls
    return bump * float(np.max(np.where(bump > _LEAST, needed / np.maximum(bump, _LEAST), 0.0), initial=0.0))


def _ahead(heading: Array | float) -> Array:
    return np.stack([np.cos(heading), np.sin(heading)], axis=-1)
