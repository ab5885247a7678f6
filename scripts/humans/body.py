"""All parts of one human joined into one closed surface, painted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from manifold3d import CrossSection, Manifold
from numpy.typing import NDArray

from ahmss.body.array import Array
from humans.distance import Field

__all__ = ["Body", "Painting", "Stencil", "prism"]

Faces = NDArray[np.int64]


@dataclass(frozen=True)
class Stencil:
    """A solid inside which faces change colour: `recolour` says which colours become which."""

    solid: Manifold
    recolour: dict[str, str]


@dataclass(frozen=True)
class Body:
    """One surface: points (n, 3); of each face its corners (m, 3), the part it came from and its colour's name."""

    points: Array
    faces: Faces
    part: NDArray[np.intp]
    colour: Sequence[str]


def prism(outline: Array, near: float, far: float) -> Manifold:
    """A polygon (n, 2) in y, z drawn along x from `near` to `far`, metres."""
    section = CrossSection([np.asarray(outline, float)])
    solid = Manifold.extrude(section, far - near)
    # The extrusion has the outline in x, y and goes along z: cycle the axes.
    return solid.transform(np.array([[0.0, 0.0, 1.0, near], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]]))


class Painting:
    """A solid of several coloured parts that stencils cut; only faces of named parts are kept in the end."""

    def __init__(self) -> None:
        self._parts: dict[int, int] = {}
        self._colours: list[str] = []
        self.fields: list[Field | None] = []
        self._pieces: list[tuple[Manifold, dict[str, str]]] = []

    def part(self, solid: Manifold, colour: str, field: Field | None) -> Manifold:
        """Register a solid: its faces keep their part through unions and cuts."""
        own = solid.as_original()
        self._parts[own.original_id()] = len(self._colours)
        self._colours.append(colour)
        self.fields.append(field)
        return own

    def lay(self, solid: Manifold) -> None:
        """Begin with the joined body."""
        self._pieces = [(solid, {})]

    def paint(self, stencil: Stencil) -> None:
        """Cut the body along a stencil and recolour what lies inside."""
        pieces: list[tuple[Manifold, dict[str, str]]] = []
        for solid, colours in self._pieces:
            inside, outside = solid.split(stencil.solid)
            if inside.num_tri() == 0:
                pieces.append((solid, colours))
                continue
            changed = {name: stencil.recolour.get(colours.get(name, name), colours.get(name, name))
                       for name in self._colours}  # fmt: skip
            pieces.append((outside, colours))
            pieces.append((inside, changed))
        self._pieces = pieces

    def body(self) -> Body:
        """The faces that belong to parts, welded where pieces meet."""
        points: list[Array] = []
        faces: list[Faces] = []
        part: list[NDArray[np.intp]] = []
        colour: list[str] = []
        count = 0
        for solid, colours in self._pieces:
            found = solid.to_mesh64()
            corners = np.asarray(found.tri_verts, np.int64).reshape(-1, 3)
            bounds = np.asarray(found.run_index) // 3
            for run, original in enumerate(found.run_original_id):
                index = self._parts.get(int(original))
                rows = corners[int(bounds[run]) : int(bounds[run + 1])]
                if index is None or len(rows) == 0:
                    continue
                faces.append(rows + count)
                part.append(np.full(len(rows), index))
                name = self._colours[index]
                colour.extend([colours.get(name, name)] * len(rows))
            points.append(np.asarray(found.vert_properties)[:, :3])
            count += len(points[-1])
        return _weld(np.concatenate(points), np.concatenate(faces), np.concatenate(part), colour)


def _weld(points: Array, faces: Faces, part: NDArray[np.intp], colour: list[str]) -> Body:
    """Corners closer than 20 micrometres become one; faces without area go."""
    key = np.round(points / 2e-5).astype(np.int64)
    _, first, again = np.unique(key, axis=0, return_index=True, return_inverse=True)
    faces = again.reshape(-1)[faces]
    a, b, c = faces.T
    good = (a != b) & (b != c) & (c != a)
    used, packed = np.unique(faces[good], return_inverse=True)
    names = [name for name, keep in zip(colour, good, strict=True) if keep]
    return Body(points[first][used], packed.reshape(-1, 3), part[good], names)
