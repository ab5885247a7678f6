"""The things of a scene as solids: signed distances to the parts of their shapes, made when somebody comes near."""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, rotate
from ahmss.database import store
from ahmss.database.workspace import Workspace
from ahmss.errors import DataError
from ahmss.grasping.distance import build
from ahmss.grasping.field import Field
from ahmss.motion.glbfile import GlbReader
from ahmss.states.behaviour import Behaviour
from ahmss.states.look import looks

__all__ = ["Solid", "Solids"]

_THIN = 1e-3  # metres: what is flatter (a wall seen from inside, a floor) has no inside
_FLUID = ("water",)  # parts that hands may be in
_PART = "part/"  # what the name of a mesh begins with whose look depends on states
_VERSION = 1


@dataclass(frozen=True)
class Solid:
    """A part of a shape: its name ("": all without a look of its own) and its corners (T, 3, 3), the object's frame."""

    part: str
    triangles: Array

    @property
    def bounds(self) -> tuple[Array, Array]:
        """The lowest and the highest corner."""
        return self.triangles.min(axis=(0, 1)), self.triangles.max(axis=(0, 1))


class Solids:
    """The kinds of a workspace as solids; distances are kept on disk once they are made."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace = workspace
        self._parts: dict[str, list[Solid]] = {}
        self._fields: dict[tuple[str, str], Field] = {}
        self._hulls: dict[str, Array | None] = {}

    def depth(self, kind: str, pose: Array, states: Mapping[str, object], points: Array) -> Array:
        """How deep points (n, 3) of the world are in an object (7,) of a kind, metres, 0 outside."""
        deep = np.zeros(len(points))
        parts = self.parts(kind)
        if not parts:
            return deep
        inner = rotate(conjugate(pose[3:]), points - pose[:3])
        behaviour = self._workspace.objects.get(kind).behaviour
        for solid in parts:
            at = _as_modelled(inner, behaviour, solid.part, states)
            low, high = solid.bounds
            near = np.flatnonzero(((at > low) & (at < high)).all(axis=-1))
            if len(near):
                deep[near] = np.maximum(deep[near], -self._field(kind, solid).clearance(at[near]))
        return np.maximum(deep, 0.0)

    def filled(self, kind: str, pose: Array, points: Array) -> Array:
        """How deep points (n, 3) of the world are in a round thing (7,) taken as filled, its convex hull; 0 outside.

        A cup is thin: what is through its wall, or within, is never deep in that. Of what is not round, which hands
        may be in (a basin, a shelf), 0.
        """
        hull = self._hull(kind)
        if hull is None:
            return np.zeros(len(points))
        inner = rotate(conjugate(pose[3:]), points - pose[:3])
        return np.maximum(-(inner @ hull[:, :3].T + hull[:, 3]).max(axis=-1), 0.0)

    def _hull(self, kind: str) -> Array | None:
        """The planes (m, 4) of a round thing's convex hull, outward normals and offsets; None for other things."""
        if kind not in self._hulls:
            parts = self.parts(kind) if "diameter" in self._workspace.objects.get(kind).properties else []
            corners = np.concatenate([solid.triangles.reshape(-1, 3) for solid in parts]) if parts else None
            self._hulls[kind] = None if corners is None else np.asarray(ConvexHull(corners).equations)
        return self._hulls[kind]

    def parts(self, kind: str) -> list[Solid]:
        """The parts of a kind that have an inside."""
        if kind not in self._parts:
            shape = self._workspace.objects.shape(kind)
            self._parts[kind] = [] if shape is None else _parts(shape.glb)
        return self._parts[kind]

    def _field(self, kind: str, solid: Solid) -> Field:
        known = self._fields.get((kind, solid.part))
        if known is None:
            known = self._fields[kind, solid.part] = _kept(solid)
        return known


def _as_modelled(points: Array, behaviour: Behaviour, part: str, states: Mapping[str, object]) -> Array:
    """Points (n, 3) of an object as its file has a part that its states move."""
    look = looks(behaviour, states).get(part)
    if look is None or look.matrix is None:
        return points
    return (points - look.matrix[:3, 3]) @ look.matrix[:3, :3]


def _parts(glb: bytes) -> list[Solid]:
    reader = GlbReader(glb)
    found: dict[str, list[Array]] = {}
    for mesh in reader.tree["meshes"]:
        name = str(mesh.get("name", ""))
        part = name.removeprefix(_PART) if name.startswith(_PART) else ""
        for primitive in mesh["primitives"]:
            corners = reader.array(primitive["attributes"]["POSITION"])[reader.array(primitive["indices"])[:, 0]]
            found.setdefault(part, []).append(corners.astype(np.float64).reshape(-1, 3, 3))
    solids = [Solid(part, np.concatenate(pieces)) for part, pieces in found.items() if part not in _FLUID]
    return [solid for solid in solids if (solid.bounds[1] - solid.bounds[0]).min() > _THIN]


def _kept(solid: Solid) -> Field:
    """The field of a part, from the disk's store where it has it."""
    digest = hashlib.sha256(np.ascontiguousarray(solid.triangles).tobytes()).hexdigest()
    place = store.place("fields", f"{digest}_all_{_VERSION}")
    data = store.take(place)
    if data is not None:
        with contextlib.suppress(DataError):  # what was kept is broken: it is made anew
            return Field.from_bytes(data)
    low, high = solid.bounds
    made = build(solid.triangles.reshape(-1, 3), np.arange(3 * len(solid.triangles)).reshape(-1, 3), low, high)
    store.keep(place, made.to_bytes())
    return made
