"""Solids of which furniture is made. Centimetres, z up; faces are lists of corners, outsides counter-clockwise."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

Points = Sequence[Sequence[float]]


@dataclass
class Piece:
    """Corners (n, 3) and faces, each a list of corner numbers, on a layer."""

    layer: str
    corners: np.ndarray
    faces: list[list[int]] = field(default_factory=list)

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Piece:
        """Shifted."""
        return Piece(self.layer, self.corners + np.array([x, y, z]), self.faces)

    def turned(self, axis: str, degrees: float) -> Piece:
        """Turned about an axis through the origin."""
        a = np.radians(degrees)
        i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
        m = np.eye(3)
        m[i, i], m[i, j], m[j, i], m[j, j] = np.cos(a), -np.sin(a), np.sin(a), np.cos(a)
        return Piece(self.layer, self.corners @ m.T, self.faces)

    def mirrored(self, axis: str) -> Piece:
        """Mirrored at the plane through the origin across an axis."""
        signs = np.array([-1.0 if a == axis else 1.0 for a in "xyz"])
        return Piece(self.layer, self.corners * signs, [f[::-1] for f in self.faces])

    def triangles(self) -> int:
        """How many triangles its faces make."""
        return sum(len(f) - 2 for f in self.faces)


def loft(layer: str, rings: Sequence[Points], *, bottom: bool = True, top: bool = True) -> Piece:
    """Rings of equally many points, lowest first, each counter-clockwise from above; closed by flat ends."""
    n = len(rings[0])
    corners = np.array([p for ring in rings for p in ring], float)
    faces = [
        [k * n + i, k * n + (i + 1) % n, (k + 1) * n + (i + 1) % n, (k + 1) * n + i]
        for k in range(len(rings) - 1)
        for i in range(n)
    ]
    if bottom:
        faces.append(list(range(n))[::-1])
    if top:
        faces.append([(len(rings) - 1) * n + i for i in range(n)])
    return Piece(layer, corners, faces)


def box(layer: str, low: Sequence[float], high: Sequence[float], *, bottom: bool = True, top: bool = True) -> Piece:
    """A box from its lowest to its highest corner: 12 triangles, 10 without an end."""
    return loft(layer, [rectangle(low, high, z) for z in (low[2], high[2])], bottom=bottom, top=top)


def rectangle(low: Sequence[float], high: Sequence[float], z: float, inset: float = 0.0) -> list[list[float]]:
    """A rectangle at height z, counter-clockwise."""
    x0, y0, x1, y1 = low[0] + inset, low[1] + inset, high[0] - inset, high[1] - inset
    return [[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]]


def bevelled(layer: str, low: Sequence[float], high: Sequence[float], bevel: float) -> Piece:
    """A box whose twelve edges are cut off at `bevel`: 44 triangles."""
    rings = []
    for z, inset in ((low[2], bevel), (low[2] + bevel, 0.0), (high[2] - bevel, 0.0), (high[2], bevel)):
        x0, y0, x1, y1 = low[0], low[1], high[0], high[1]
        b = bevel
        i = inset
        rings.append(
            [
                [x0 + b, y0 + i, z],
                [x1 - b, y0 + i, z],
                [x1 - i, y0 + b, z],
                [x1 - i, y1 - b, z],
                [x1 - b, y1 - i, z],
                [x0 + b, y1 - i, z],
                [x0 + i, y1 - b, z],
                [x0 + i, y0 + b, z],
            ]
        )
    # At the two ends the ring's short sides have no length: only its corners count.
    piece = loft(layer, rings)
    return _without_slivers(piece)


def rounded(width: float, depth: float, radius: float, steps: int) -> list[tuple[float, float]]:
    """The outline of a rectangle about the origin with rounded corners of `steps` + 1 points each."""
    out = []
    for corner, (sx, sy) in enumerate(((1, -1), (1, 1), (-1, 1), (-1, -1))):
        cx, cy = sx * (width / 2 - radius), sy * (depth / 2 - radius)
        for i in range(steps + 1):
            a = np.pi / 2 * (corner - 1 + i / steps)
            out.append((cx + radius * np.cos(a), cy + radius * np.sin(a)))
    return out


def slab(layer: str, outline: Sequence[tuple[float, float]], levels: Sequence[tuple[float, float]]) -> Piece:
    """A convex outline lifted through `levels` of (z, inset towards the middle along the corner's own direction)."""
    points = np.array(outline)
    ahead = np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)
    outward = np.stack([ahead[:, 1], -ahead[:, 0]], axis=1) / np.linalg.norm(ahead, axis=1, keepdims=True)
    rings = [[[*(p - inset * o), z] for p, o in zip(points, outward, strict=True)] for z, inset in levels]
    return loft(layer, rings)


def lathe(layer: str, profile: Sequence[tuple[float, float]], segments: int) -> Piece:
    """A profile of (radius, z) turned about z, from the middle of the bottom over the outside; radius 0 closes it."""
    corners: list[list[float]] = []
    rings: list[list[int]] = []
    for r, z in profile:
        if r == 0.0:
            rings.append([len(corners)] * segments)
            corners.append([0.0, 0.0, z])
        else:
            rings.append([len(corners) + i for i in range(segments)])
            turns = 2.0 * np.pi * np.arange(segments) / segments
            corners += [[r * np.cos(a), r * np.sin(a), z] for a in turns]
    faces = []
    for low, high in itertools.pairwise(rings):
        for i in range(segments):
            j = (i + 1) % segments
            face = list(dict.fromkeys((low[i], low[j], high[j], high[i])))
            if len(face) > 2:
                faces.append(face)
    return Piece(layer, np.array(corners), faces)


def tube(layer: str, path: Points, radius: float | Sequence[float], segments: int) -> Piece:
    """A round bar along a path of points, with flat ends."""
    points = np.array(path, float)
    radii = np.broadcast_to(np.asarray(radius, float), len(points))
    along = np.gradient(points, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    side = np.cross(along[0], [0.0, 0.0, 1.0] if abs(along[0][2]) < 0.9 else [1.0, 0.0, 0.0])
    rings = []
    for p, t, r in zip(points, along, radii, strict=True):
        side = side - t * (side @ t)
        side /= np.linalg.norm(side)
        up = np.cross(t, side)
        turns = 2.0 * np.pi * np.arange(segments) / segments
        rings.append([p + r * (np.cos(a) * side + np.sin(a) * up) for a in turns])
    return loft(layer, rings)


def _without_slivers(piece: Piece) -> Piece:
    """Faces with corners at one place lose the doubles; what is left with two corners goes."""
    _, first, number = np.unique(np.round(piece.corners, 6), axis=0, return_index=True, return_inverse=True)
    number = number.reshape(-1)
    faces = []
    for face in piece.faces:
        kept = list(dict.fromkeys(int(number[i]) for i in face))
        if len(kept) > 2:
            faces.append(kept)
    return Piece(piece.layer, piece.corners[first], faces)
