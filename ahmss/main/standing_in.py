"""How an object made of objects stands in the world, as entries of its file: what another main has placed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, rotate
from ahmss.database.placement import Placed
from ahmss.world.schema import ObjectRecord
from ahmss.world.view import World

__all__ = ["standing_in"]

_THERE = 1e-5  # metres, and of a quaternion: what is so near stands where its file says


def standing_in(world: World, file: Sequence[Placed]) -> tuple[Placed, ...]:
    """The entries as the world has them, parents first: those that are where the file says are just as it says.

    So is what somebody has carried elsewhere, which stays there.

    Args:
        world: where the object is. file: what it is by its file, itself first, where it stands.
    """
    told, found = {one.name: one for one in file}, {file[0].name: file[0]}
    for name, record in sorted(world.objects.items(), key=lambda one: one[0].count("/")):
        if record.parent not in found:
            continue
        entry, pose = told.get(name), world.pose(name)
        own = _within(world.pose(record.parent), pose)
        same = entry is not None and entry.kind == record.kind
        found[name] = entry if entry is not None and same and _stays(record, entry, own) else _placed(record, pose, own)
    return tuple(found.values())


def _stays(record: ObjectRecord, entry: Placed, own: Array) -> bool:
    """Whether a part is where its entry says, or was carried off."""
    if record.moved or not record.attached:
        return True
    place, turn = np.array(entry.local_position), np.array(entry.local_rotation)
    turned = min(float(np.abs(own[3:] - sign * turn).max()) for sign in (1.0, -1.0))
    return max(float(np.abs(own[:3] - place).max()), turned) < _THERE


def _within(parent: Array, pose: Array) -> Array:
    """A pose (7,) of the world in the frame of another (7,)."""
    back = conjugate(parent[3:])
    return np.concatenate([rotate(back, pose[:3] - parent[:3]), multiply(back, pose[3:])])


def _placed(record: ObjectRecord, pose: Array, own: Array) -> Placed:
    x, y, z, w, i, j, k = pose.tolist()
    u, v, n, a, b, c, d = own.tolist()
    return Placed(record.name, record.kind, record.parent, (x, y, z), (w, i, j, k), (u, v, n), (a, b, c, d))
