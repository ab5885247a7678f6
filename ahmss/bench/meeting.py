"""Where an object must be for a shipped clip to be played as it was meant."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.body.inverse import RIGHT_HAND, grips
from ahmss.body.skeleton import Skeleton
from ahmss.motion.clip import load

__all__ = ["meeting_site"]


def meeting_site(motion: Path, skeleton: Skeleton) -> Transform:
    """The site that the clip's right hand meets, in the floor frame of the human; the frame itself if it meets none."""
    clip = load(motion)
    if clip.targets is None or not clip.targets[:, RIGHT_HAND, 7].any():
        return Transform(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
    met = int(clip.targets[:, RIGHT_HAND, 7].argmax())
    palm = Transform.of(grips(skeleton, clip.rotations[met], clip.root[met])[RIGHT_HAND])
    return palm.then(Transform.of(clip.targets[met, RIGHT_HAND]).inverse())
