"""What of a finger touches: its pad as the bones have it, and the skin that viewers show, where it is furthest."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from ahmss.algorithm import HumanPose
from ahmss.body.array import Array
from ahmss.body.fingertip import pad
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from tests.demo.skin import Skin

from .scene import WORKSPACE, Body

GIVES = 0.0015  # metres by which a fingertip's flesh gives way: what is no further behind touches as well
WITHIN = np.array([(a, b, 4 - a - b) for a in range(5) for b in range(5 - a)]) / 4.0  # places within a triangle


@cache
def skin_of(name: str) -> Skin:
    """The skin of a human of humandb/."""
    return Skin.read(WORKSPACE.humans.shape(name).glb, WORKSPACE.humans.get(name).skeleton)


def pads(body: Body, shown: Sequence[HumanPose], side: str, into: Array, finger: str = "index") -> Array:
    """Where the pad of a finger (F, 3) touches what it pushes along (3,), in the world."""
    link = INDEX[f"{side}_{finger}_distal"]
    rotations, root = np.array([p.rotations for p in shown]), np.array([p.root for p in shown])
    places, turned = forward(rotations, root, body.skeleton.offsets)
    tips = places[:, link] + rotate(turned[:, link], body.skeleton.tips[link])
    along = rotate(turned[:, link], np.array([1.0, 0.0, 0.0]))
    return pad(tips, along, float(body.skeleton.radii[link]), into)


def skins(body: Body, shown: Sequence[HumanPose], side: str, into: Array, finger: str = "index") -> Array:
    """Where the skin of a finger's end (F, 3) touches what it pushes along (3,), in the world."""
    skin, link = skin_of(body.name), INDEX[f"{side}_{finger}_distal"]
    faces = skin.faces[(skin.link == link)[skin.faces].any(axis=1)]
    own, of = np.unique(faces, return_inverse=True)
    return np.array([touched(skin.posed(p.rotations, p.root, own)[of.reshape(faces.shape)], into) for p in shown])


def touched(faces: Array, into: Array) -> Array:
    """Where skin, triangles (n, 3, 3), touches what it is pushed against along (3,): the middle of what does, as far
    as any of it is.
    """
    across = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    area = np.repeat(np.linalg.norm(across, axis=1), len(WITHIN))
    points = (WITHIN @ faces).reshape(-1, 3)
    along = points @ into
    on = along > along.max() - GIVES
    place = area[on] @ points[on] / area[on].sum()
    return place + (along.max() - place @ into) * into
