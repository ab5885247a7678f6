"""A plain figure for a human whose shape is not there: one rounded bar a link, in the skeleton's measures."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS
from ahmss.body.quaternion import to_matrix
from ahmss.body.skeleton import Skeleton
from ahmss_viewer.surface import Skin, Surface

__all__ = ["plain_figure"]

_SKIN, _SHIRT, _TROUSERS, _SHOES = (226, 178, 148), (96, 138, 170), (70, 76, 92), (50, 44, 42)
_SIDES, _RINGS = 12, 7


def plain_figure(skeleton: Skeleton) -> tuple[Surface, ...]:
    """A skinned surface (about 7,000 faces) that stands for a human."""
    rotations, root = skeleton.upright()
    places, world = forward(rotations, root, skeleton.offsets)
    T_world_link = np.zeros((len(LINKS), 4, 4))
    T_world_link[:, :3, :3], T_world_link[:, :3, 3], T_world_link[:, 3, 3] = to_matrix(world), places, 1.0
    positions: list[NDArray[Any]] = []
    normals: list[NDArray[Any]] = []
    colours: list[NDArray[Any]] = []
    joints: list[NDArray[Any]] = []
    faces: list[NDArray[Any]] = []
    count = 0
    for link, name in enumerate(LINKS):
        ends = [skeleton.tips[link]]
        if link == INDEX["spine"]:  # from shoulder to shoulder
            ends += [skeleton.offsets[INDEX["right_upper_arm"]], skeleton.offsets[INDEX["left_upper_arm"]]]
        for number, end in enumerate(ends):
            radius = float(skeleton.radii[link]) * (1.0 if number == 0 else 0.4)
            body, out, triangles = _bar(np.asarray(end, float), radius)
            T = T_world_link[link]
            positions.append(body @ T[:3, :3].T + T[:3, 3])
            normals.append(out @ T[:3, :3].T)
            colours.append(np.tile([*_colour(name), 255], (len(body), 1)))
            joints.append(np.full(len(body), link))
            faces.append(triangles + count)
            count += len(body)
    held = np.zeros((count, 4), np.uint8)
    held[:, 0] = np.concatenate(joints)
    whole = np.tile(np.array([255, 0, 0, 0], np.uint8), (count, 1))
    skin = Skin(held, whole, np.linalg.inv(T_world_link).astype(float))
    surface = Surface(
        np.concatenate(positions).astype(np.float32), np.concatenate(normals).astype(np.float32),
        np.concatenate(colours).astype(np.uint8), np.concatenate(faces).astype(np.uint32), skin=skin,
    )  # fmt: skip
    return (surface,)


def _colour(name: str) -> tuple[int, int, int]:
    """Clothes by region."""
    if name.endswith("_leg") or name == "hips":
        return _TROUSERS
    if name.endswith("_foot"):
        return _SHOES
    return _SHIRT if name == "spine" or name.endswith("_arm") else _SKIN


def _bar(end: NDArray[Any], radius: float) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """A capsule from the origin to `end`: vertices, normals, faces."""
    length = float(np.linalg.norm(end))
    x = end / length if length > 1e-9 else np.array([1.0, 0.0, 0.0])
    aside = np.array([0.0, 1.0, 0.0]) if abs(x[1]) < 0.9 else np.array([0.0, 0.0, 1.0])
    z = np.cross(x, aside)
    z /= np.linalg.norm(z)
    turn = np.stack([x, np.cross(z, x), z], axis=1)
    angle = np.linspace(-np.pi / 2, np.pi / 2, _RINGS + 1)
    along = np.concatenate([np.sin(angle[: _RINGS // 2 + 1]), np.sin(angle[_RINGS // 2 + 1 :])])
    shift = np.where(np.arange(_RINGS + 1) <= _RINGS // 2, 0.0, length)
    around = 2.0 * np.pi * np.arange(_SIDES) / _SIDES
    wide = np.cos(angle)[:, None]
    out = np.stack([
        np.broadcast_to(along[:, None], (_RINGS + 1, _SIDES)), wide * np.cos(around), wide * np.sin(around),
    ], axis=-1).reshape(-1, 3)  # fmt: skip
    body = radius * out + np.repeat(shift, _SIDES)[:, None] * [1.0, 0.0, 0.0]
    ring, side = np.meshgrid(np.arange(_RINGS), np.arange(_SIDES), indexing="ij")
    a, b = ring * _SIDES + side, ring * _SIDES + (side + 1) % _SIDES
    c, d = a + _SIDES, b + _SIDES
    faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([b, d, c], -1).reshape(-1, 3)])
    return body @ turn.T, out @ turn.T, faces
