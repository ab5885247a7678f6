"""Writing GLB (glTF 2.0 binary), the same bytes for the same shape. Axes stay the object's own: z is up."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array

__all__ = ["Part", "write_glb"]

_FLOAT, _UBYTE, _UINT = 5126, 5121, 5125


@dataclass(frozen=True)
class Part:
    """One primitive: corners with their normals, and either a colour each or picture coordinates (from lower left)."""

    name: str
    places: Array
    normals: Array
    colors: NDArray[np.uint8]
    uv: Array | None
    two_sided: bool


def write_glb(parts: list[Part]) -> bytes:
    """A GLB of one node and mesh a part; equal corners are stored once."""
    writer = _Writer()
    for part in parts:
        writer.add(part)
    return writer.bytes()


class _Writer:
    def __init__(self) -> None:
        self.binary = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self.meshes: list[dict[str, Any]] = []
        self.materials: list[dict[str, Any]] = []

    def add(self, part: Part) -> None:
        columns = [part.places, part.normals] + ([] if part.uv is None else [part.uv])
        floats = np.concatenate([c.reshape(len(part.places), -1) for c in columns], axis=1).astype("<f4") + 0.0
        colors = part.colors if part.uv is None else np.full_like(part.colors, 255)
        rgba = np.concatenate([colors, np.full((len(colors), 1), 255, np.uint8)], axis=1)
        rows = np.ascontiguousarray(np.concatenate([floats.view("<u4"), rgba.view("<u4")], axis=1))
        _, first, index = np.unique(rows, axis=0, return_index=True, return_inverse=True)
        rank = np.argsort(np.argsort(first))  # keep the order of the file
        order = np.sort(first)
        floats, rgba = floats[order], rgba[order]
        attributes = {
            "POSITION": self._accessor(floats[:, :3], "VEC3", _FLOAT, bounds=True),
            "NORMAL": self._accessor(floats[:, 3:6], "VEC3", _FLOAT),
        }
        if part.uv is None:
            attributes["COLOR_0"] = self._accessor(rgba, "VEC4", _UBYTE, normalized=True)
        else:  # glTF counts a picture from its upper left corner
            uv = np.stack([floats[:, 6], 1.0 - floats[:, 7]], axis=1).astype("<f4")
            attributes["TEXCOORD_0"] = self._accessor(uv, "VEC2", _FLOAT)
        indices = self._accessor(rank[index.reshape(-1)].astype("<u4"), "SCALAR", _UINT)
        material = {
            "name": "textured" if part.uv is not None else "coloured",
            "doubleSided": part.two_sided,
            "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.8},
        }
        primitive = {"attributes": attributes, "indices": indices, "material": len(self.materials)}
        self.materials.append(material)
        self.meshes.append({"name": part.name, "primitives": [primitive]})

    def _accessor(
        self, data: NDArray[Any], kind: str, component: int, *, bounds: bool = False, normalized: bool = False
    ) -> int:
        raw = np.ascontiguousarray(data).tobytes()
        self.views.append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(raw)})
        self.binary += raw + bytes(-len(raw) % 4)
        accessor: dict[str, Any] = {
            "bufferView": len(self.views) - 1,
            "componentType": component,
            "count": len(data),
            "type": kind,
        }
        if normalized:
            accessor["normalized"] = True
        if bounds:
            accessor |= {"min": data.min(axis=0).tolist(), "max": data.max(axis=0).tolist()}
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def bytes(self) -> bytes:
        nodes = [{"name": mesh["name"], "mesh": i} for i, mesh in enumerate(self.meshes)]
        header = {
            "asset": {"version": "2.0", "generator": "AHMSS"},
            "scene": 0,
            "scenes": [{"nodes": list(range(len(nodes)))}],
            "nodes": nodes,
            "meshes": self.meshes,
            "materials": self.materials,
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": len(self.binary)}],
        }
        text = json.dumps(header, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunks = [(len(text), b"JSON", text), (len(self.binary), b"BIN\0", bytes(self.binary))]
        body = b"".join(length.to_bytes(4, "little") + kind + data for length, kind, data in chunks)
        return b"glTF" + (2).to_bytes(4, "little") + (12 + len(body)).to_bytes(4, "little") + body
