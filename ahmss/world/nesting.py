"""Objects in objects: from places in what contains them to places in the world."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import multiply, normalize, rotate
from ahmss.world.schema import NewObject

__all__ = ["in_world"]


def in_world(objects: Sequence[NewObject], pose_of: Callable[[str], Array]) -> Array:
    """World poses (n, 7) of new objects, parents before what they contain: one generation after another.

    `pose_of` gives the world pose (7,) of an object that is there already.
    """
    poses = np.array([(*new.place, *new.rotation) for new in objects], float).reshape(-1, 7)
    row_of: dict[str, int] = {}
    depth = np.zeros(len(objects), int)
    parents = np.zeros_like(poses)
    for row, new in enumerate(objects):
        row_of[new.name] = row
        if new.parent in row_of:
            depth[row] = depth[row_of[new.parent]] + 1
        else:
            parents[row] = pose_of(new.parent) if new.parent else (0, 0, 0, 1, 0, 0, 0)
    inner = np.array([row_of.get(new.parent, -1) for new in objects])
    for generation in range(depth.max(initial=0) + 1):
        rows = np.flatnonzero(depth == generation)
        frames = parents[rows] if generation == 0 else poses[inner[rows]]
        poses[rows] = _compose(frames, poses[rows])
    return poses


def _compose(parents: Array, poses: Array) -> Array:
    """Poses in their parents' frames, in the world: all (n, 7)."""
    turns = parents[:, 3:]
    places = parents[:, :3] + rotate(turns, poses[:, :3])
    return np.concatenate([places, normalize(multiply(turns, poses[:, 3:]))], axis=1)
