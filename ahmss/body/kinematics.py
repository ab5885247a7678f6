"""Forward kinematics: from joint rotations to the links in the world (Ichiguchi 2000, 4.9 and 4.10)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.links import LINKS, PARENTS
from ahmss.body.quaternion import multiply, rotate

__all__ = ["forward"]


def _levels() -> tuple[tuple[NDArray[np.intp], NDArray[np.intp]], ...]:
    """The links by depth below the hips, each with its parents: one array step a depth serves all its links."""
    depth = [0] * len(LINKS)
    for link in range(1, len(LINKS)):
        depth[link] = depth[PARENTS[link]] + 1
    levels: list[tuple[NDArray[np.intp], NDArray[np.intp]]] = []
    for level in range(1, max(depth) + 1):
        links = [link for link in range(len(LINKS)) if depth[link] == level]
        levels.append((np.array(links), np.array([PARENTS[link] for link in links])))
    return tuple(levels)


_LEVELS = _levels()


def forward(rotations: Array, root: Array, offsets: Array) -> tuple[Array, Array]:
    """Places and rotations of all links in the world.

    Args:
        rotations: (..., 43, 4) unit quaternions, parent <- child; row 0 is world <- hips.
        root: (..., 3) place of the hips' joint in the world, metres.
        offsets: (43, 3) each joint's place in its parent's frame, metres.

    Returns:
        places (..., 43, 3) in metres (4.9) and rotations (..., 43, 4), world <- link (4.10).
    """
    places = np.empty((*rotations.shape[:-1], 3))
    world = np.empty(rotations.shape)
    places[..., 0, :] = root
    world[..., 0, :] = rotations[..., 0, :]
    for links, parents in _LEVELS:
        q_world_parent = world[..., parents, :]
        world[..., links, :] = multiply(q_world_parent, rotations[..., links, :])
        places[..., links, :] = places[..., parents, :] + rotate(q_world_parent, offsets[links])
    return places, world
