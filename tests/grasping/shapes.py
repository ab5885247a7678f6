"""Meshes for hands to hold, and how deep points are in them, measured without the grid that the hands use."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.quaternion import from_matrix
from ahmss.database import Workspace
from ahmss.database.footprint import triangles_of
from ahmss.grasping.distance import build
from ahmss.grasping.field import Field

ROOT = Path(__file__).resolve().parents[2]
WORKSPACE = Workspace(ROOT)
THICK = 0.006  # metres, half of a mug's handle
MUGS = {"mug46": (0.046, 0.088), "mug36": (0.036, 0.07), "mug25": (0.025, 0.06), "mug_aside": (0.046, 0.088)}
NEAR = 0.03  # metres beyond which nobody asks how far it is
TOGETHER = 20_000  # pairs of points and triangles


@dataclass(frozen=True)
class Thing:
    """Triangles (T, 3, 3) and where they are gripped: site (7,), grip, and where the palm faces for a power grip."""

    triangles: Array
    site: Array
    grip: str
    palm: Array

    @property
    def near(self) -> Array:
        return self.triangles[np.linalg.norm(self.triangles.mean(axis=1) - self.site[:3], axis=1) < 1.2]


def frame(place: tuple[float, float, float], x: tuple[int, int, int], z: tuple[int, int, int]) -> Array:
    """A frame (7,) whose x and z point along the object's axes."""
    a, b = np.array(x, float), np.array(z, float)
    return np.concatenate([place, from_matrix(np.stack([a, np.cross(b, a), b], axis=1))])


def kind(name: str) -> Array:
    shape = WORKSPACE.objects.shape(name)
    assert shape is not None
    return triangles_of(shape.glb)


def box(width: float, height: float = 0.12) -> Array:
    half = 0.5 * width
    mesh = trimesh.creation.box(bounds=[[-half, -half, 0.0], [half, half, height]])
    return np.array(mesh.vertices[mesh.faces])


def lathe(profile: list[tuple[float, float]], sides: int = 24) -> Array:
    """A body of rotation about z from radii and heights, given so that the outside is to the right of the way."""
    turns = 2.0 * np.pi * np.arange(sides + 1) / sides
    rings = np.array([[[r * np.cos(a), r * np.sin(a), z] for a in turns] for r, z in profile])
    a, b, c, d = rings[:-1, :-1], rings[:-1, 1:], rings[1:, 1:], rings[1:, :-1]
    return np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)]).reshape(-1, 3, 3)


PLATE = [
    (0.0, 0.0),
    (0.05, 0.0),
    (0.06, 0.004),
    (0.115, 0.018),
    (0.12, 0.022),
    (0.115, 0.024),
    (0.06, 0.01),
    (0.0, 0.008),
]
KNOB = [(0.0, 0.0), (0.012, 0.0), (0.012, 0.03), (0.02, 0.035), (0.02, 0.05), (0.0, 0.055)]


def mug(deep: float, tall: float) -> Array:
    """A mug with a C-handle at its +x: so far its bar is from the wall, so tall is the loop inside, metres."""
    body = trimesh.creation.revolve(
        [[0.0, 0.0], [0.0425, 0.0], [0.0425, 0.12], [0.0385, 0.12], [0.0385, 0.004], [0.0, 0.004]], sections=32
    )
    turns = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 17)
    ring = 2.0 * np.pi * np.arange(10) / 10
    out = np.stack([np.cos(turns), np.zeros(17), np.sin(turns)], axis=-1)
    path = np.array([0.04, 0.0, 0.06]) + out * np.array([deep + THICK + 0.0025, 0.0, 0.5 * tall + THICK])
    across = np.cos(ring)[:, None, None] * out + np.sin(ring)[:, None, None] * np.array([0.0, 1.0, 0.0])
    rings = path + THICK * across
    a, b, c, d = rings[:, :-1], np.roll(rings, -1, 0)[:, :-1], np.roll(rings, -1, 0)[:, 1:], rings[:, 1:]
    handle = np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)]).reshape(-1, 3, 3)
    caps = [
        np.stack([np.broadcast_to(path[i], (10, 3)), *pair], axis=1)
        for i, pair in (
            (0, (np.roll(rings[:, 0], -1, 0), rings[:, 0])),
            (-1, (rings[:, -1], np.roll(rings[:, -1], -1, 0))),
        )
    ]
    return np.concatenate([np.array(body.vertices[body.faces]), handle, *caps])


@cache
def thing(name: str) -> Thing:
    """`cup40` to `cup110`, `lever`, `tap`, `plate`, `box60`, `box80`, `box150`, `knob`, and `MUGS`."""
    ahead = np.array([1.0, 0.0, 0.0])
    if name.startswith("cup"):
        scale = float(name[3:]) / 72.0
        triangles = kind("cup") * np.array([scale, scale, max(1.0, scale)])
        return Thing(triangles, frame((0.0, 0.0, 0.052), (1, 0, 0), (0, 0, 1)), "power", ahead)
    if name.startswith("box"):
        return Thing(box(0.001 * float(name[3:])), frame((0, 0, 0.06), (1, 0, 0), (0, 1, 0)), "precision", ahead)
    if name.startswith("mug"):
        deep, tall = MUGS[name]
        site = frame((0.04 + deep + THICK + 0.0025, 0.0, 0.06), (-1, 0, 0), (0, 0, 1))
        return Thing(mug(deep, tall), site, "power", np.array([0.0, -1.0, 0.0]) if name == "mug_aside" else -ahead)
    if name == "lever":
        kept = WORKSPACE.objects.get("door").sites["lever"]
        site = np.array([*kept.position, *kept.rotation])
        return Thing(kind("door"), site, kept.grip, np.array([0.0, 1.0, 0.0]))
    if name == "tap":
        kept = WORKSPACE.objects.get("tap").sites["handle"]
        return Thing(kind("tap"), np.array([*kept.position, *kept.rotation]), kept.grip, -ahead)
    if name == "plate":
        return Thing(lathe(PLATE), frame((0.0, 0.0, 0.012), (1, 0, 0), (0, 0, 1)), "precision", ahead)
    assert name == "knob"
    return Thing(lathe(KNOB), frame((0.0, 0.0, 0.035), (0, 0, -1), (0, 1, 0)), "precision", ahead)


@cache
def field(name: str) -> Field:
    triangles, place = thing(name).triangles, thing(name).site[:3]
    vertices = triangles.reshape(-1, 3)
    return build(vertices, np.arange(len(vertices)).reshape(-1, 3), place - 0.14, place + 0.14)


def outside(points: Array, triangles: Array, near: float = NEAR) -> Array:
    """The distance (n) of points (n, 3) from triangles, negative inside, `near` for what is farther; exactly.

    The side is told by the winding number: the solid angles of all triangles (Van Oosterom and Strackee 1983).
    """
    low, high = points.min(axis=0) - near, points.max(axis=0) + near
    met = triangles[((triangles.max(axis=1) > low) & (triangles.min(axis=1) < high)).all(axis=1)]
    lows, highs = met.min(axis=1) - near, met.max(axis=1) + near
    found = np.full(len(points), near)
    for some in _parts(points, met):
        about = np.ones((len(some), len(met)), bool)
        for axis, at in enumerate(points[some].T):
            about &= (at[:, None] > lows[:, axis]) & (at[:, None] < highs[:, axis])
        point, triangle = np.nonzero(about)
        if len(point):
            on = trimesh.triangles.closest_point(met[triangle], points[some][point])
            np.minimum.at(found, some[point], np.linalg.norm(on - points[some][point], axis=1))
    close = np.flatnonzero(found < near)
    found[close] *= np.where(np.abs(winding(points[close], triangles)) > 0.5, -1.0, 1.0)
    return found


def winding(points: Array, triangles: Array) -> Array:
    """How often (n) triangles go around points (n, 3); coordinates each by itself, (n, T)."""
    total = np.zeros(len(points))
    for some in _parts(points, triangles):
        a, b, c = (triangles[:, corner, :, None].swapaxes(0, 1) - points[some].T[:, None] for corner in range(3))
        la, lb, lc = (np.sqrt((v * v).sum(axis=0)) for v in (a, b, c))
        volume = (a * np.stack([b[i - 2] * c[i - 1] - b[i - 1] * c[i - 2] for i in range(3)])).sum(axis=0)
        below = la * lb * lc + (a * b).sum(axis=0) * lc + (b * c).sum(axis=0) * la + (c * a).sum(axis=0) * lb
        total[some] = np.arctan2(volume, below).sum(axis=0) / (2.0 * np.pi)
    return total


def _parts(points: Array, triangles: Array) -> list[NDArray[np.intp]]:
    """The numbers of the points, so many at a time that what is made of each with each triangle stays at hand."""
    return np.array_split(np.arange(len(points)), len(points) * len(triangles) // TOGETHER + 1)
