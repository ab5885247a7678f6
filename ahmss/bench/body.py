"""The cost of the arrays: blending four motions and forward kinematics for a thousand humans at once."""

from __future__ import annotations

import statistics
import time

import numpy as np

from ahmss.body.array import component_major
from ahmss.body.blending import blend
from ahmss.body.kinematics import forward
from ahmss.body.links import LINKS
from ahmss.body.quaternion import normalize
from ahmss.body.skeleton import Skeleton

__all__ = ["us_per_human"]


def us_per_human(humans: int = 1000, motions: int = 4, repeats: int = 60) -> float:
    """Microseconds a human for one blend (4.11) and forward kinematics (4.9, 4.10); the median of `repeats`."""
    random = np.random.default_rng(0)
    skeleton = Skeleton.of()
    upright, root = skeleton.upright()
    noise = 0.2 * random.standard_normal((motions, humans, len(LINKS), 4))
    rotations = component_major(motions, humans, len(LINKS), 4)
    rotations[...] = normalize(upright + noise)
    importance = component_major(motions, humans, len(LINKS))
    importance[...] = random.random((motions, humans, len(LINKS)))
    roots = root + random.standard_normal((humans, 3))
    previous = component_major(humans, len(LINKS), 4)
    previous[...] = upright
    out = forward(previous, roots, skeleton.offsets)
    took: list[float] = []
    for _ in range(repeats):
        begun = time.perf_counter()
        previous = blend(rotations, importance, previous)
        forward(previous, roots, skeleton.offsets, out)
        took.append(time.perf_counter() - begun)
    return 1e6 * statistics.median(took) / humans
