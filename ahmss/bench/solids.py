"""The things of a scene as solids: how deep points are in the parts of their shapes, exactly, as their states are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull

from ahmss.bench.pieces import Piece, pieces
from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, rotate
from ahmss.database.workspace import Workspace
from ahmss.motion.glbfile import GlbReader
from ahmss.states.look import Look, looks

__all__ = ["Solid", "Solids"]

_THIN = 1e-3  # metres: what is flatter (a wall seen from inside, a floor) has no inside
_FLUID = ("water",)  # parts that hands may be in
_AS_IT_IS = Look()
_PART = "part/"  # what the name of a mesh begins with whose look depends on states


@dataclass(frozen=True)
class Solid:
    """A piece of a shape, in the object's frame, and the name of its part ("": all without a look of its own)."""

    part: str
    piece: Piece

    @property
    def bounds(self) -> tuple[Array, Array]:
        """The lowest and the highest corner."""
        return self.piece.bounds


@dataclass(frozen=True)
class _Hull:
    """The planes (m, 4) of a convex hull, outward normals and offsets, and how far its corners are from the origin."""

    planes: Array
    far: float

    @classmethod
    def of(cls, corners: Array) -> _Hull:
        return cls(np.asarray(ConvexHull(corners).equations), float(np.linalg.norm(corners, axis=1).max()))


class Solids:
    """The kinds of a workspace as solids, read when somebody comes near."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace = workspace
        self._parts: dict[str, list[Solid]] = {}
        self._hulls: dict[str, _Hull | None] = {}

    def depth(self, kind: str, pose: Array, states: Mapping[str, object], points: Array) -> Array:
        """How deep points (n, 3) of the world are in an object (7,) of a kind, metres, 0 outside."""
        deep = np.zeros(len(points))
        parts = self.parts(kind)
        if not parts:
            return deep
        inner = rotate(conjugate(pose[3:]), points - pose[:3])
        seen = looks(self._workspace.objects.get(kind).behaviour, states)
        as_modelled, spans = {"": inner}, dict[str, tuple[Array, Array]]()
        for solid in parts:
            look = seen.get(solid.part, _AS_IT_IS)
            if solid.part not in as_modelled:
                as_modelled[solid.part] = inner if look.matrix is None else _moved_back(inner, look.matrix)
            if solid.part not in spans:
                columns = np.ascontiguousarray(as_modelled[solid.part].T)  # far faster than row by row
                spans[solid.part] = columns.min(axis=1), columns.max(axis=1)
            (low, high), (lowest, highest) = spans[solid.part], solid.bounds
            if look.shown and (low < highest).all() and (high > lowest).all():
                deep = np.maximum(deep, solid.piece.depth(as_modelled[solid.part]))
        return deep

    def filled(self, kind: str, pose: Array, points: Array) -> Array:
        """How deep points (n, 3) of the world are in a round thing (7,) taken as filled, its convex hull; 0 outside.

        A cup is thin: what is through its wall, or within, is never deep in that. Of what is not round, which hands
        may be in (a basin, a shelf), 0.
        """
        deep, hull = np.zeros(len(points)), self._hull(kind)
        if hull is None:
            return deep
        near = np.flatnonzero(np.linalg.norm(points - pose[:3], axis=1) < hull.far)
        inner = rotate(conjugate(pose[3:]), points[near] - pose[:3])
        deep[near] = np.maximum(-(inner @ hull.planes[:, :3].T + hull.planes[:, 3]).max(axis=-1), 0.0)
        return deep

    def _hull(self, kind: str) -> _Hull | None:
        """The convex hull of a round thing; None for other things."""
        if kind not in self._hulls:
            parts = self.parts(kind) if "diameter" in self._workspace.objects.get(kind).properties else []
            corners = np.concatenate([solid.piece.triangles.reshape(-1, 3) for solid in parts]) if parts else None
            self._hulls[kind] = None if corners is None else _Hull.of(corners)
        return self._hulls[kind]

    def parts(self, kind: str) -> list[Solid]:
        """The parts of a kind that have an inside."""
        if kind not in self._parts:
            shape = self._workspace.objects.shape(kind)
            self._parts[kind] = [] if shape is None else _parts(shape.glb)
        return self._parts[kind]


def _moved_back(points: Array, moved: Array) -> Array:
    """Points (n, 3) of an object as its file has a part that its states move by (4, 4)."""
    return (points - moved[:3, 3]) @ moved[:3, :3]


def _parts(glb: bytes) -> list[Solid]:
    reader = GlbReader(glb)
    found: dict[str, list[Array]] = {}
    for mesh in reader.tree["meshes"]:
        name = str(mesh.get("name", ""))
        part = name.removeprefix(_PART) if name.startswith(_PART) else ""
        for primitive in mesh["primitives"]:
            corners = reader.array(primitive["attributes"]["POSITION"])[reader.array(primitive["indices"])[:, 0]]
            found.setdefault(part, []).append(corners.astype(np.float64).reshape(-1, 3, 3))
    solids = [
        Solid(part, piece)
        for part, corners in found.items()
        if part not in _FLUID
        for piece in pieces(np.concatenate(corners))
    ]
    return [solid for solid in solids if (solid.bounds[1] - solid.bounds[0]).min() > _THIN]
