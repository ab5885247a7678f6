"""A start that is called off: before a foot is lifted the weight that was shifted for it goes back."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import slerp
from ahmss.body.skeleton import Skeleton
from ahmss.walking.journey import Journey
from ahmss.walking.legs import foot_frames

__all__ = ["back", "last_moment"]

_LAST = 0.76  # share of the time until a foot is lifted: coming to rest from there takes until just before it


def last_moment(going: Journey) -> int:
    """The last frame of a walk from standing at which it may be called off."""
    stands = going.nominal.bearing.any(axis=-1).all(axis=-1)
    return int(_LAST * np.argmin(stands))


def back(skeleton: Skeleton, going: Journey, since: int) -> tuple[Array, Array, Array, Array]:
    """From a frame, at which no foot is lifted yet, back to the first one, in twice the time.

    The time of the walk goes on as fast as it did at first and comes to rest at 0, by a quintic.

    Returns:
        rotations (2 since, 15, 4), root (n, 3), ankles (n, 2, 3), feet (n, 2, 4): those after `since`.
    """
    u = np.linspace(0.0, 1.0, 2 * since + 1)[1:]
    times = since * np.clip(1.0 + u * (2.0 - u * u * (22.0 - u * (31.0 - 12.0 * u))), 0.0, None)
    before = times.astype(np.intp)
    share, shaped = (times - before)[:, None], going.shaping.part(0, int(times.max()) + 2)
    rotations = slerp(shaped.rotations[before], shaped.rotations[before + 1], share)
    root = (1.0 - share) * shaped.root[before] + share * shaped.root[before + 1]
    return rotations, root, *foot_frames(skeleton, rotations, root)
