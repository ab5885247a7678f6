"""Faces out of DXF: 3DFACE, POLYLINE (polyface and polygon mesh), MESH, and INSERTs of blocks of them.

An INSERT scales, turns, mirrors and repeats its block, at any depth. What a block has on layer 0 takes the layer of its
INSERT, and what is coloured BYBLOCK its colour, as every CAD program shows it.
"""

from __future__ import annotations

import logging
import warnings
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import ezdxf
import ezdxf.colors
import ezdxf.filemanagement
import ezdxf.recover
import numpy as np
from ezdxf.lldxf.const import DXFError
from ezdxf.render.mesh import MeshBuilder

from ahmss.body.array import Array
from ahmss.database.soup import Soup
from ahmss.errors import DataError

__all__ = ["read_dxf"]

_METRES = {1: 0.0254, 2: 0.3048, 4: 0.001, 5: 0.01, 6: 1.0, 7: 1000.0, 8: 2.54e-8, 9: 2.54e-5, 10: 0.9144, 14: 0.1}
_DEEPEST = 32
_HEADER = 1_000_000  # bytes, generously
_BYBLOCK, _BYLAYER = 0, 256
_TAKEN = "3DFACE, POLYLINE (polyface or polygon mesh), MESH, and INSERT of blocks of them"
Color = tuple[int, int, int]
logging.getLogger("ezdxf").setLevel(logging.CRITICAL)  # what is wrong is said once, by us


@dataclass(frozen=True)
class _Context:
    """What an INSERT hands down: the place, and the layer and colour for what has none of its own."""

    matrix: Array
    layer: str | None
    color: Color


@dataclass
class _Gathered:
    """Triangles so far, with a colour and a layer each."""

    triangles: list[Array] = field(default_factory=list[Array])
    styles: list[tuple[Color, int, int]] = field(default_factory=list[tuple[Color, int, int]])
    layers: dict[str, int] = field(default_factory=dict[str, int])
    faces: int = 0


def read_dxf(path: Path, label: str, most: int) -> tuple[Soup, float | None]:
    """The faces of a DXF file in its own units, and metres per unit where its header says ($INSUNITS).

    Raises:
        DataError: it is no DXF, has no faces (says what it has), more than `most`, or blocks in a circle.
    """
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")  # what is not finite is refused later, with a count
            reader = _Reader(_open(path), label, most)
            soup = reader.read()
    except (DataError, MemoryError, RecursionError):
        raise
    except Exception as error:  # noqa: BLE001 - ezdxf fails in its own many ways on what is no DXF
        said = (str(error).splitlines() or [type(error).__name__])[0][:120]
        raise DataError(label, "", f"no DXF file that can be read ({said})") from None
    with path.open("rb") as file:
        says = b"$INSUNITS" in file.read(_HEADER)  # ezdxf answers metres for a file that says nothing
    return soup, _METRES.get(int(reader.document.header.get("$INSUNITS", 0))) if says else None


def _open(path: Path) -> Any:
    try:
        return ezdxf.filemanagement.readfile(path)
    except (DXFError, ArithmeticError, OSError, LookupError, ValueError, AttributeError, TypeError):
        return ezdxf.recover.readfile(path)[0]  # what is not quite DXF may yet be read


class _Reader:
    """Walks the model space of one document."""

    def __init__(self, document: Any, label: str, most: int) -> None:
        self.document, self.label, self.most = document, label, most
        self.out = _Gathered()
        self.seen: Counter[str] = Counter()
        self.counts: dict[str, int] = {}

    def read(self) -> Soup:
        faces = self._count(self.document.modelspace(), ())
        if faces > 2 * self.most:  # the count is rough; what is near the limit is counted as it is gathered
            raise DataError(self.label, "", f"more than {self.most:,} faces; make the shape simpler")
        self._walk(self.document.modelspace(), _Context(np.eye(4), None, (200, 200, 200)))
        if not self.out.triangles:
            found = ", ".join(f"{n} {name}" for name, n in sorted(self.seen.items())) or "nothing at all"
            raise DataError(self.label, "", f"no faces: it has {found}; AHMSS takes {_TAKEN}")
        counts = [n for _, _, n in self.out.styles]
        return Soup(
            np.concatenate(self.out.triangles),
            np.repeat(np.array([c for c, _, _ in self.out.styles], np.uint8), counts, axis=0),
            np.repeat(np.array([layer for _, layer, _ in self.out.styles], np.intp), counts),
            tuple(self.out.layers),
        )

    def _count(self, entities: Any, chain: tuple[str, ...]) -> int:
        """About how many faces there are, each block counted once however often it is inserted."""
        total = 0
        for entity in entities:
            kind = entity.dxftype()
            if kind == "3DFACE":
                total += 1
            elif kind == "POLYLINE" and (entity.is_poly_face_mesh or entity.is_polygon_mesh):
                total += max(len(entity.vertices) // 2, 1)
            elif kind == "MESH":
                total += max(len(entity.faces), 1)
            elif kind == "INSERT":
                total += self._count_block(entity.dxf.name, chain) * max(int(entity.mcount), 1)
        return total

    def _count_block(self, name: str, chain: tuple[str, ...]) -> int:
        if name in chain or len(chain) >= _DEEPEST:
            circle = " in ".join(reversed((*chain, name)))
            raise DataError(self.label, "", f"blocks stand in a circle or deeper than {_DEEPEST}: {circle}")
        if name not in self.counts:
            block = self.document.blocks.get(name)
            self.counts[name] = 0 if block is None else self._count(block, (*chain, name))
        return self.counts[name]

    def _walk(self, entities: Any, context: _Context) -> None:
        for entity in entities:
            kind = entity.dxftype()
            self.seen[kind] += 1
            if kind == "3DFACE":
                corners = np.array([entity.dxf.vtx0, entity.dxf.vtx1, entity.dxf.vtx2, entity.dxf.vtx3], float)
                faces = [[0, 1, 2]] if (corners[2] == corners[3]).all() else [[0, 1, 2], [0, 2, 3]]
                self._add(entity, corners[faces], context)
            elif kind == "POLYLINE" and entity.is_polygon_mesh:
                self._add(entity, _grid(entity, self.label), context)
            elif kind == "POLYLINE" and entity.is_poly_face_mesh:
                self._add(entity, _triangles(MeshBuilder.from_polyface(entity)), context)
            elif kind == "MESH":
                self._add(entity, _triangles(MeshBuilder.from_mesh(entity)), context)
            elif kind == "INSERT":
                self._insert(entity, context)

    def _insert(self, entity: Any, context: _Context) -> None:
        name = entity.dxf.name
        if not self.counts[name]:
            return
        layer, color = self._style(entity, context)
        for single in entity.multi_insert() if entity.mcount > 1 else (entity,):
            matrix = np.array(list(single.matrix44()), float).reshape(4, 4).T  # ezdxf's are rows
            self._walk(self.document.blocks.get(name), _Context(context.matrix @ matrix, layer, color))

    def _style(self, entity: Any, context: _Context) -> tuple[str, Color]:
        """The layer and colour that an entity has where it stands."""
        layer = str(entity.dxf.layer)
        if layer == "0" and context.layer is not None:
            layer = context.layer
        rgb = entity.rgb
        if rgb is not None:
            return layer, (int(rgb[0]), int(rgb[1]), int(rgb[2]))
        index = int(entity.dxf.color)
        if index == _BYBLOCK:
            return layer, context.color
        return layer, self._layer_color(layer) if index == _BYLAYER else _indexed(index)

    def _layer_color(self, name: str) -> Color:
        if name not in self.document.layers:
            return (200, 200, 200)
        layer = self.document.layers.get(name)
        rgb = layer.rgb
        if rgb is not None:
            return (int(rgb[0]), int(rgb[1]), int(rgb[2]))
        return _indexed(abs(int(layer.dxf.color)))

    def _add(self, entity: Any, triangles: Array, context: _Context) -> None:
        self.out.faces += len(triangles)
        if self.out.faces > self.most:
            raise DataError(self.label, "", f"more than {self.most:,} faces; make the shape simpler")
        if not len(triangles):
            return
        layer, color = self._style(entity, context)
        placed = triangles @ context.matrix[:3, :3].T + context.matrix[:3, 3]
        if np.linalg.det(context.matrix[:3, :3]) < 0.0:
            placed = placed[:, ::-1]
        number = self.out.layers.setdefault(layer, len(self.out.layers))
        self.out.triangles.append(placed)
        self.out.styles.append((color, number, len(placed)))


def _indexed(index: int) -> Color:
    """The colour of the DXF palette; 7, black on white paper, is a light grey here."""
    if index == 7 or not 1 <= index <= 255:
        return (200, 200, 200)
    rgb = ezdxf.colors.aci2rgb(index)
    return (int(rgb[0]), int(rgb[1]), int(rgb[2]))


def _triangles(mesh: MeshBuilder) -> Array:
    """The faces of a mesh as triangles (n, 3, 3), fans from each face's first corner."""
    if not mesh.faces:
        return np.empty((0, 3, 3))
    corners = np.array([tuple(v) for v in mesh.vertices], float)
    fans = [(f[0], f[i], f[i + 1]) for f in mesh.faces for i in range(1, len(f) - 1)]
    if not fans:
        return np.empty((0, 3, 3))
    return corners[np.array(fans)]


def _grid(mesh: Any, label: str) -> Array:
    """The squares of an M x N polygon mesh as triangles (n, 3, 3), its closed directions closed.

    A smoothed mesh is as CAD shows it: its control points, which have flag 16, do not count.
    """
    smooth = bool(mesh.dxf.smooth_type)
    m, n = (mesh.dxf.m_smooth_density, mesh.dxf.n_smooth_density) if smooth else (mesh.dxf.m_count, mesh.dxf.n_count)
    corners = np.array([tuple(v.dxf.location) for v in mesh.vertices if not v.dxf.flags & 16], float)
    if m < 2 or n < 2 or len(corners) != m * n:
        raise DataError(label, "", f"a polygon mesh of {m} x {n} has {len(corners)} vertices; export it anew")
    number = np.arange(m * n).reshape(m, n)
    if mesh.is_m_closed:
        number = np.concatenate([number, number[:1]])
    if mesh.is_n_closed:
        number = np.concatenate([number, number[:, :1]], axis=1)
    a, b, c, d = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
    faces = np.stack([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)], axis=2)
    return corners[faces.reshape(-1, 3)]
