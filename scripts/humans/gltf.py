"""Writes one skinned, vertex-coloured mesh as GLB (binary glTF 2.0)."""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.links import CHILDREN, LINKS, PARENTS

__all__ = ["Skinned", "write"]

_ARRAY_BUFFER, _ELEMENT_BUFFER = 34962, 34963
_TYPES = {"|u1": 5121, "<u2": 5123, "<f4": 5126}


@dataclass(frozen=True)
class Skinned:
    """A body as it goes into the file.

    positions, normals (n, 3); colours (n, 4) uint8, sRGB; joints, weights (n, 4); faces (m, 3); frames (43, 4, 4): the
    links in the world in the pose in which the mesh is modelled.
    """

    positions: Array
    normals: Array
    colours: NDArray[np.uint8]
    joints: NDArray[np.uint8]
    weights: Array
    faces: NDArray[np.int64]
    frames: Array


def write(body: Skinned, name: str) -> bytes:
    """The file's bytes; the same for the same input."""
    buffer = bytearray()
    views: list[dict[str, Any]] = []
    accessors: list[dict[str, Any]] = []

    def add(values: NDArray[Any], kind: str, target: int | None, **more: Any) -> int:
        data = np.ascontiguousarray(values)
        view: dict[str, Any] = {"buffer": 0, "byteOffset": len(buffer), "byteLength": data.nbytes}
        views.append(view | ({} if target is None else {"target": target}))
        buffer.extend(data.tobytes() + b"\0" * (-data.nbytes % 4))
        accessors.append({"bufferView": len(views) - 1, "componentType": _TYPES[data.dtype.str], "type": kind,
                          "count": data.size if kind == "SCALAR" else len(data)} | more)  # fmt: skip
        return len(accessors) - 1

    positions = body.positions.astype("<f4")
    attributes = {
        "POSITION": add(positions, "VEC3", _ARRAY_BUFFER, min=positions.min(0).tolist(), max=positions.max(0).tolist()),
        "NORMAL": add(body.normals.astype("<f4"), "VEC3", _ARRAY_BUFFER),
        "COLOR_0": add(body.colours, "VEC4", _ARRAY_BUFFER, normalized=True),
        "JOINTS_0": add(body.joints, "VEC4", _ARRAY_BUFFER),
        "WEIGHTS_0": add(np.round(body.weights * 255.0).astype(np.uint8), "VEC4", _ARRAY_BUFFER, normalized=True),
    }
    indices = add(body.faces.astype("<u2").reshape(-1), "SCALAR", _ELEMENT_BUFFER)
    inverse = np.linalg.inv(body.frames).swapaxes(1, 2).astype("<f4").reshape(-1, 16)
    inverse_binds = add(inverse, "MAT4", None)
    tree = {
        "asset": {"version": "2.0", "generator": "AHMSS make_humans"},
        "scene": 0,
        "scenes": [{"nodes": [0, len(LINKS)]}],
        "nodes": [*_nodes(body.frames), {"name": name, "mesh": 0, "skin": 0}],
        "meshes": [{"name": name, "primitives": [{"attributes": attributes, "indices": indices, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.8}}],
        "skins": [{"joints": list(range(len(LINKS))), "inverseBindMatrices": inverse_binds, "skeleton": 0}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(buffer)}],
    }
    text = json.dumps(tree, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(buffer), b"BIN\0") + buffer
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def _nodes(frames: Array) -> list[dict[str, Any]]:
    """One node a link, placed in its parent as in the bind pose."""
    nodes: list[dict[str, Any]] = []
    for link, name in enumerate(LINKS):
        parent = PARENTS[link]
        local = frames[link] if parent < 0 else np.linalg.inv(frames[parent]) @ frames[link]
        node: dict[str, Any] = {"name": name, "matrix": np.round(local.T, 9).reshape(-1).tolist()}
        if CHILDREN[link]:
            node["children"] = list(CHILDREN[link])
        nodes.append(node)
    return nodes
