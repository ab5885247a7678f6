"""From a shape file to the GLB that travels: read, checked at the border, scaled, given normals and its picture."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.database.glb import Part, write_glb
from ahmss.database.missing import check_files
from ahmss.database.normals import closed, corner_normals, weld
from ahmss.database.objectfile import UNITS
from ahmss.database.precount import precount
from ahmss.database.records import ObjectKind
from ahmss.database.shape import Shape
from ahmss.database.soup import Soup
from ahmss.database.texture import Texture, box_projection, read_texture
from ahmss.database.workspace import Workspace
from ahmss.errors import DataError
from ahmss.states.behaviour import PART

__all__ = ["MOST_FACES", "convert_shape"]

MOST_FACES = 500_000
_MOST_BYTES = 400_000_000
_FORMATS = ("dxf", "glb", "gltf", "obj", "ply", "stl")
_SMALLEST, _LARGEST = 1e-4, 1e4  # metres
_HUGE = 1e30  # of any unit
_Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # glTF's y up to our z up


def convert_shape(workspace: Workspace, kind: ObjectKind) -> Shape:
    """Read, check and convert the shape that `kind` names."""
    assert kind.shape is not None
    check_files(workspace, kind)
    path, label = kind.shape, workspace.label(kind.shape)
    _check_file(path, label)
    soup, metres = _read(workspace, path, label)
    _check_finite(soup, label)
    scale = metres if metres is not None else UNITS[kind.unit]
    gltf = path.suffix.lower() in (".glb", ".gltf")
    up = kind.up or ("y" if gltf else "z")
    soup = soup.transformed(scale * (_Y_UP if up == "y" else np.eye(3)))
    _check_size(soup, label)
    soup = soup.proper()
    if not len(soup.triangles):
        raise DataError(label, "", "no faces with an area: all its triangles are lines or points")
    _check_parts(soup, kind, label)
    if kind.color is not None:
        soup = replace(soup, colors=np.tile(np.array(kind.color, np.uint8), (len(soup.triangles), 1)))
    texture = read_texture(kind.texture, workspace.label(kind.texture)) if kind.texture else None
    if texture is None and soup.picture is not None:
        texture = Texture.of(soup.picture, "image/png")
    glb = write_glb(_parts(soup, kind, _textured(soup, kind, label) if texture else None))
    low, high = soup.triangles.min(axis=(0, 1)), soup.triangles.max(axis=(0, 1))
    bounds = ((float(low[0]), float(low[1]), float(low[2])), (float(high[0]), float(high[1]), float(high[2])))
    return Shape(glb, hashlib.sha256(glb).hexdigest(), len(soup.triangles), bounds, texture)


def _check_file(path: Path, label: str) -> None:
    """Refuse at once what is not there, of no known format, empty, or far too large."""
    if path.suffix[1:].lower() not in _FORMATS:
        raise DataError(label, "", f'no shape file "{path.suffix}"; allowed: {", ".join(_FORMATS)}')
    size = path.stat().st_size
    if size == 0:
        raise DataError(label, "", "the shape file is empty")
    if size > _MOST_BYTES:
        raise DataError(label, "", f"{size // 1_000_000} MB; at most {_MOST_BYTES // 1_000_000} MB, make it simpler")
    faces = precount(path)
    if faces > MOST_FACES:
        raise DataError(label, "", f"{faces:,} faces; at most {MOST_FACES:,}, make the shape simpler")


def _read(workspace: Workspace, path: Path, label: str) -> tuple[Soup, float | None]:
    """The triangles, and metres per unit where the file says so."""
    try:
        if path.suffix.lower() == ".dxf":
            from ahmss.database.dxf import read_dxf  # its library is slow to load and not always needed

            return read_dxf(path, label, MOST_FACES)
        from ahmss.database.meshfile import read_mesh

        soup = read_mesh(workspace, path, label)
    except (MemoryError, RecursionError):
        raise DataError(label, "", "too large or too deeply nested to be read") from None
    if len(soup.triangles) > MOST_FACES:
        raise DataError(label, "", f"{len(soup.triangles):,} faces; at most {MOST_FACES:,}, make the shape simpler")
    return soup, 1.0 if path.suffix.lower() in (".glb", ".gltf") else None


def _check_finite(soup: Soup, label: str) -> None:
    fit = np.abs(soup.triangles) < _HUGE  # false for what is no number, too
    if not fit.all():
        bad = int((~fit).any(axis=(1, 2)).sum())
        raise DataError(label, "", f"{bad} faces have corners that are no finite numbers; export it anew")


def _check_size(soup: Soup, label: str) -> None:
    extent = float(np.ptp(soup.triangles.reshape(-1, 3), axis=0).max())
    away = float(np.abs(soup.triangles).max())
    if extent < _SMALLEST or away > _LARGEST:
        size = f"{extent:.3g} m" if away <= _LARGEST else f"{away:.3g} m from its origin"
        raise DataError(label, "", f'it measures {size}; allowed: {_SMALLEST:g} to {_LARGEST:g} m, is "unit" right?')


def _textured(soup: Soup, kind: ObjectKind, label: str) -> NDArray[np.bool_]:
    """Which triangles wear the picture (n,)."""
    if not kind.texture_layers:
        return np.ones(len(soup.triangles), bool)
    for layer in kind.texture_layers:
        if layer not in soup.layers:
            have = ", ".join(soup.layers)
            raise DataError(label, "", f'no layer "{layer}" for the texture; the shape has: {have}')
    return np.isin(soup.layer, [soup.layers.index(layer) for layer in kind.texture_layers])


def _check_parts(soup: Soup, kind: ObjectKind, label: str) -> None:
    """Refuse an appearance of a part that the shape does not have."""
    for part in kind.behaviour.parts:
        if part not in soup.layers:
            raise DataError(
                label, "", f'no layer "{part}" for the appearances; the shape has: {", ".join(soup.layers)}'
            )


def _parts(soup: Soup, kind: ObjectKind, textured: NDArray[np.bool_] | None) -> list[Part]:
    """The shape in one part of colours and one that wears the picture, but for those parts whose look changes."""
    points = weld(soup.triangles)
    normals = corner_normals(soup.triangles, points)
    two_sided = kind.two_sided if kind.two_sided is not None else not closed(points)
    wears = np.zeros(len(soup.triangles), bool) if textured is None else textured
    own = [soup.layers.index(part) for part in kind.behaviour.parts]
    rest = ~np.isin(soup.layer, own)
    groups = [("coloured", rest & ~wears), ("textured", rest & wears)]
    groups += [(PART + soup.layers[number], soup.layer == number) for number in own]
    return [
        _part(name, chosen, soup, normals, kind, two_sided=two_sided, textured=bool(wears[chosen].any()))
        for name, chosen in groups
        if chosen.any()
    ]


def _part(
    name: str, chosen: NDArray[np.bool_], soup: Soup, normals: Array, kind: ObjectKind, *, two_sided: bool,
    textured: bool,
) -> Part:  # fmt: skip
    """The chosen triangles."""
    uv = None
    if textured:
        own = soup.uv
        uv = box_projection(soup.triangles[chosen], kind.texture_size) if own is None else own[chosen]
        uv = uv.reshape(-1, 2)
    return Part(
        name,
        soup.triangles[chosen].reshape(-1, 3),
        normals[chosen].reshape(-1, 3),
        np.repeat(soup.colors[chosen], 3, axis=0),
        uv,
        two_sided,
    )
