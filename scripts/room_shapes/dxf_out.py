"""Writing DXF by hand, so that a shape is always the same bytes: coloured layers, polyfaces, a polygon mesh."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from room_shapes.solids import Piece

Color = tuple[int, int, int]


def write_dxf(path: Path, pieces: list[Piece], colors: dict[str, Color]) -> None:
    """One polyface a piece."""
    body: list[object] = []
    for piece in pieces:
        body += _polyface(piece)
    _write(path, body, colors)


def write_grid(
    path: Path, layer: str, color: Color, low: tuple[float, float], high: tuple[float, float], n: int
) -> None:
    """A flat polygon mesh of n x n squares facing up."""
    body: list[object] = [0, "POLYLINE", 8, layer, 66, 1, 70, 16, 71, n + 1, 72, n + 1, 10, 0, 20, 0, 30, 0]
    for y in np.linspace(low[1], high[1], n + 1):
        for x in np.linspace(low[0], high[0], n + 1):
            body += [0, "VERTEX", 8, layer, 10, _number(x), 20, _number(y), 30, "0", 70, 64]
    body += [0, "SEQEND"]
    _write(path, body, {layer: color})


def _polyface(piece: Piece) -> list[object]:
    """Corners first, then faces of at most four corners, numbered from 1."""
    faces = [quad for face in piece.faces for quad in _quads(face)]
    out: list[object] = [0, "POLYLINE", 8, piece.layer, 66, 1, 70, 64, 71, len(piece.corners), 72, len(faces)]
    out += [10, 0, 20, 0, 30, 0]
    for x, y, z in piece.corners:
        out += [0, "VERTEX", 8, piece.layer, 10, _number(x), 20, _number(y), 30, _number(z), 70, 192]
    for face in faces:
        out += [0, "VERTEX", 8, piece.layer, 10, 0, 20, 0, 30, 0, 70, 128]
        for code, corner in zip((71, 72, 73, 74), face, strict=False):
            out += [code, corner + 1]
    return [*out, 0, "SEQEND"]


def _quads(face: list[int]) -> list[list[int]]:
    """A convex face as quads and at most one triangle, fans from its first corner."""
    return [[face[0], *face[i : i + 3]] for i in range(1, len(face) - 1, 2)]


def _number(value: float) -> str:
    return f"{round(float(value), 4) + 0.0:.4f}".rstrip("0").rstrip(".")


def _write(path: Path, body: list[object], colors: dict[str, Color]) -> None:
    head: list[object] = [0, "SECTION", 2, "HEADER", 9, "$ACADVER", 1, "AC1009", 0, "ENDSEC"]
    head += [0, "SECTION", 2, "TABLES", 0, "TABLE", 2, "LAYER", 70, len(colors)]
    for layer, (r, g, b) in colors.items():
        head += [0, "LAYER", 2, layer, 70, 0, 62, 8, 6, "CONTINUOUS", 420, r * 65536 + g * 256 + b]
    head += [0, "ENDTAB", 0, "ENDSEC", 0, "SECTION", 2, "ENTITIES"]
    lines = [*head, *body, 0, "ENDSEC", 0, "EOF"]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes("".join(f"{line}\n" for line in lines).encode("ascii"))
