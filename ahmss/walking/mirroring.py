"""A walk seen in a mirror at the plane y = 0: the clips that table A.1 does not list (Ichiguchi 2000, A.1)."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import INDEX, LINKS
from ahmss.walking.library import BODY, WalkClip

__all__ = ["mirror", "mirrored"]


def _other_side(name: str) -> str:
    if name.startswith("right"):
        return name.replace("right", "left", 1)
    return name.replace("left", "right", 1)


_SWAP = [INDEX[_other_side(name)] for name in LINKS[:BODY]]


def mirror(rotations: Array, root: Array) -> tuple[Array, Array]:
    """Poses of the body without fingers: right becomes left. Rotations (..., 15, 4), root (..., 3)."""
    return rotations[..., _SWAP, :] * np.array([1.0, -1.0, 1.0, -1.0]), root * np.array([1.0, -1.0, 1.0])


def mirrored(clip: WalkClip) -> WalkClip:
    """The clip of the mirrored key. Mirrored twice, a clip is itself again."""
    rotations, root = mirror(clip.rotations, clip.root)
    return WalkClip(clip.key.mirrored, rotations, root, clip.bearing[:, ::-1], clip.source)
