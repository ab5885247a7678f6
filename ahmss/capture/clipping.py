"""A take made into a clip: the sensors' rotations become those of a human's links, and the feet find the ground."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import LINKS, PARENTS
from ahmss.body.quaternion import conjugate, multiply, normalize
from ahmss.body.skeleton import Skeleton
from ahmss.motion.resample import continuous

__all__ = ["joint_rotations"]


def joint_rotations(skeleton: Skeleton, world: Array) -> Array:
    """Rotations parent <- child (F, 43, 4) of world rotations (F, 15, 4); the fingers are relaxed."""
    relaxed, _ = skeleton.relaxed()
    tracked = world.shape[-2]
    out = np.empty((*world.shape[:-2], len(LINKS), 4))
    out[..., tracked:, :] = relaxed[tracked:]
    out[..., 0, :] = world[..., 0, :]
    parents = list(PARENTS[1:tracked])
    out[..., 1:tracked, :] = multiply(conjugate(world[..., parents, :]), world[..., 1:, :])
    return continuous(normalize(out))
