"""How deep a human's skin is in the things around it and how far below the floor its feet are, frame by frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.bench.acted import Acted
from ahmss.bench.skin import Skin
from ahmss.bench.solids import Solids
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import LINKS
from ahmss.body.quaternion import rotate
from ahmss.database.workspace import Workspace
from ahmss.motion.contact import foot_points

__all__ = ["Depth", "in_things", "under_floor"]

_EVERY = 3  # frames: what goes through a thing is in it for longer


@dataclass(frozen=True)
class Depth:
    """For each frame how deep the skin is in a thing (F,), metres, which thing it is, and which link."""

    deepest: Array
    thing: tuple[str, ...]
    link: tuple[str, ...]


def in_things(acted: Acted, workspace: Workspace) -> Depth:
    """How deep the skin is in things that have an inside; looked at in every third frame, which counts for three.

    A round thing that nobody has, a cup, counts as filled.
    """
    skin = Skin.read(workspace.humans.shape(acted.body).glb)
    solids, link = Solids(workspace), skin.link
    frames = len(acted.root)
    deepest, thing, part = np.zeros(frames), [""] * frames, [""] * frames
    for frame in range(0, frames, _EVERY):
        points = skin.posed(acted.skeleton, acted.rotations[frame], acted.root[frame])
        low, high = points.min(axis=0), points.max(axis=0)
        for name, seen in acted.things.items():
            pose = seen.poses[frame]
            if np.isnan(pose[0]) or not _may_meet(solids, seen.kind, pose, low, high):
                continue
            depth = solids.depth(seen.kind, pose, seen.states[frame], points)
            if not seen.holders[frame]:  # fingers come round what they take
                depth = np.maximum(depth, solids.filled(seen.kind, pose, points))
            worst = int(depth.argmax())
            if depth[worst] > deepest[frame]:
                deepest[frame], thing[frame], part[frame] = depth[worst], name, LINKS[link[worst]]
        for other in range(frame + 1, min(frame + _EVERY, frames)):
            deepest[other], thing[other], part[other] = deepest[frame], thing[frame], part[frame]
    return Depth(deepest, tuple(thing), tuple(part))


def _may_meet(solids: Solids, kind: str, pose: Array, low: Array, high: Array) -> bool:
    """Whether a sphere about an object meets the box of a body."""
    for solid in solids.parts(kind):
        reach = np.linalg.norm(np.maximum(np.abs(solid.bounds[0]), np.abs(solid.bounds[1])))
        if ((pose[:3] + reach > low) & (pose[:3] - reach < high)).all():
            return True
    return False


def under_floor(acted: Acted) -> Array:
    """Metres (F,) by which the lowest sole, joint or tip is under the floor."""
    soles = foot_points(acted.skeleton, acted.rotations, acted.root)
    places, world = forward(acted.rotations, acted.root, acted.skeleton.offsets)
    ends = places + rotate(world, acted.skeleton.tips)
    lowest = np.minimum(soles[..., 2].min(axis=(1, 2)), np.minimum(places[..., 2], ends[..., 2]).min(axis=1))
    return np.maximum(-lowest, 0.0)
