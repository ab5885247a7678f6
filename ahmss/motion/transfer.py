"""A clip of one of our humans given to another: as any motion is, but fingers, contacts and targets come along."""

from __future__ import annotations

from dataclasses import replace

import msgspec
import numpy as np

from ahmss.body.array import Array
from ahmss.body.floor_frame import floor_frame
from ahmss.body.kinematics import forward
from ahmss.body.quaternion import multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.alignment import TRACKED, BodyMotion
from ahmss.motion.clip import Clip
from ahmss.motion.contact import foot_points
from ahmss.motion.grounding import ground
from ahmss.motion.retarget import retarget

__all__ = ["body_of", "transfer"]

_BALL = 1


def transfer(clip: Clip, performer: Skeleton, skeleton: Skeleton) -> Clip:
    """The clip on another human's lengths, beginning in the same place and heading.

    Feet stay on the ground and hands where they were relative to the body, scaled (`retarget`). Targets stay what they
    are: places on objects, which don't grow with the human.

    Args:
        clip: what is performed.
        performer: the human that the clip was made for.
        skeleton: who shall perform it.
    """
    tracked = len(TRACKED)
    rotations, root = retarget(body_of(clip, performer), skeleton)
    rotations[:, tracked:] = clip.rotations[:, tracked:]
    place, turn = floor_frame(clip.rotations[0], clip.root[0])
    rotations[:, 0], root = multiply(turn, rotations[:, 0]), place + rotate(turn, root)
    if clip.header.times is None:  # keyframes are no way that feet go
        rotations, root, _ = ground(skeleton, rotations, root, clip.rate)
    header = msgspec.structs.replace(clip.header, human=skeleton.name)
    return replace(clip, rotations=rotations, root=root, header=header)


def body_of(clip: Clip, performer: Skeleton) -> BodyMotion:
    """What a clip says of the body, in the world, as a file of another maker would."""
    places, world = forward(clip.rotations, clip.root, performer.offsets)
    balls: Array = np.ascontiguousarray(foot_points(performer, clip.rotations, clip.root)[:, :, _BALL])
    return BodyMotion(world[:, : len(TRACKED)], places[:, : len(TRACKED)], balls, clip.rate)
