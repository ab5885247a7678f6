"""Standing at ease: what a human starts from, and returns to. One keyframe."""

from __future__ import annotations

import numpy as np

from ahmss.algorithm import importance_of
from ahmss.body.skeleton import Skeleton
from ahmss.motion.clip import Clip, ClipHeader
from ahmss.motion.poser import STANDING, pose

__all__ = ["clip"]


def clip(skeleton: Skeleton) -> Clip:
    """Feet a little apart, weight over them, arms hanging and not quite straight, fingers curled."""
    rotations, root = pose(skeleton, STANDING)
    root = root * np.array([0.0, 0.0, 1.0])  # relative to the floor frame, which is under the hips
    return Clip(
        rotations=rotations[None], root=root[None], importance=importance_of({"": 0.9, "root": 0.9})[None],
        contacts=np.ones((1, 2)), rate=60.0, targets=None,
        header=ClipHeader(origin="made by scripts/make_motions.py", human=skeleton.name, times=(1.0,)),
    )  # fmt: skip
