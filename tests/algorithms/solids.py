"""How deep the skin of a human is in boxes, as viewers show it."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from ahmss.algorithm import HumanPose, Transform
from ahmss.body.links import LINKS
from tests.demo.skin import Skin

from .scene import WORKSPACE

Box = tuple[float, float, float, float, float, float]
SEAT: tuple[Box, ...] = ((-0.21, 0.21, -0.21, 0.21, 0.395, 0.43),)
LEGS: tuple[Box, ...] = tuple(
    (x - 0.018, x + 0.018, y - 0.018, y + 0.018, 0.0, 0.39) for x in (-0.19, 0.19) for y in (-0.19, 0.19)
)
LEAF: tuple[Box, ...] = ((0.0, 0.8, -0.02, 0.02, 0.01, 2.0),)
JAMBS: tuple[Box, ...] = tuple((x - 0.035, x + 0.035, -0.075, 0.075, 0.0, 2.05) for x in (-0.44, 0.44))


@cache
def skin(name: str) -> Skin:
    """The skin of a shipped human."""
    model = WORKSPACE.humans.get(name)
    assert model.shape is not None
    return Skin.read(model.shape.read_bytes(), model.skeleton)


def deepest(name: str, pose: HumanPose, frame: Transform, boxes: Sequence[Box]) -> tuple[float, str]:
    """How deep, metres, a vertex is in one of an object's boxes, and of which link; negative where none is in one."""
    vertices = np.arange(0, len(skin(name).vertices), 2)
    seen = frame.inverse().apply(skin(name).posed(pose.rotations, pose.root, vertices))
    walls = np.array(boxes)
    gaps = np.concatenate([seen[:, None] - walls[:, ::2], walls[:, 1::2] - seen[:, None]], axis=-1)
    depth = gaps.min(axis=-1).max(axis=-1)
    worst = int(depth.argmax())
    return float(depth[worst]), LINKS[skin(name).link[vertices[worst]]]
