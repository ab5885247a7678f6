"""Reads GLB (binary glTF 2.0) into surfaces: meshes, materials' colours and textures, skins.

Only what the world's assets hold: triangles, embedded buffers. Axes are taken as they are: objects and humans are
stored in their own frames, z up.
"""

from __future__ import annotations

import json
import struct
from dataclasses import replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ahmss.errors import ProtocolError
from ahmss.states.behaviour import PART
from ahmss_viewer.surface import Skin, Surface, corner_normals, facing_out

__all__ = ["read_glb"]

_KINDS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT3": 9, "MAT4": 16}
_TRIANGLES = 4
_GREY = (200, 196, 188, 255)
_Json = dict[str, Any]


def read_glb(data: bytes, name: str = "shape") -> tuple[Surface, ...]:
    """All surfaces of a GLB, in its scene's frame.

    Raises:
        ProtocolError: the bytes are no GLB, or one that lacks what it refers to; says which shape.
    """
    try:
        return _File(data).surfaces()
    except ProtocolError:
        raise
    except (KeyError, IndexError, ValueError, TypeError, struct.error) as error:
        raise ProtocolError(f"{name}: not a readable GLB file ({type(error).__name__}: {error})") from error


class _File:
    """One parsed GLB."""

    def __init__(self, data: bytes) -> None:
        magic, version, _ = struct.unpack_from("<4sII", data)
        if magic != b"glTF" or version != 2:
            raise ValueError("no glTF 2 header")
        at, chunks = 12, {}
        while at + 8 <= len(data):
            length, kind = struct.unpack_from("<I4s", data, at)
            chunks[kind] = data[at + 8 : at + 8 + length]
            at += 8 + length
        self.tree = cast(_Json, json.loads(chunks[b"JSON"]))
        self.binary = chunks.get(b"BIN\0", b"")

    def surfaces(self) -> tuple[Surface, ...]:
        """Every triangle primitive under the scene's nodes."""
        nodes: list[_Json] = self.tree.get("nodes", [])
        children = {child for node in nodes for child in node.get("children", ())}
        roots = [i for i in range(len(nodes)) if i not in children]
        if "scenes" in self.tree:
            roots = self.tree["scenes"][self.tree.get("scene", 0)].get("nodes", [])
        found: list[Surface] = []
        waiting = [(root, np.eye(4)) for root in roots]
        while waiting:
            index, T_world_parent = waiting.pop()
            node = nodes[index]
            T_world_node = T_world_parent @ _local(node)
            waiting += [(child, T_world_node) for child in node.get("children", ())]
            if "mesh" in node:
                skin = node.get("skin")
                for primitive in self.tree["meshes"][node["mesh"]]["primitives"]:
                    if primitive.get("mode", _TRIANGLES) == _TRIANGLES:
                        surface = self._surface(primitive, T_world_node, skin)
                        found.append(replace(surface, part=_part(self.tree["meshes"][node["mesh"]])))
        return tuple(found)

    def _surface(self, primitive: _Json, T_world_node: NDArray[Any], skin: int | None) -> Surface:
        """One primitive; a skinned one ignores its node's place, as the format says."""
        attributes: _Json = primitive["attributes"]
        positions = self._array(attributes["POSITION"]).astype(np.float32)
        count = len(positions)
        faces = np.arange(count) if "indices" not in primitive else self._array(primitive["indices"])
        faces = faces.reshape(-1, 3).astype(np.uint32)
        if faces.size and int(faces.max()) >= count:
            raise ValueError(f"a face names vertex {int(faces.max())} of {count}")
        normals = self._array(attributes["NORMAL"]).astype(np.float32) if "NORMAL" in attributes else None
        texcoords = self._scaled(attributes["TEXCOORD_0"])[:, :2] if "TEXCOORD_0" in attributes else None
        factor, image, two_sided = self._material(primitive.get("material"))
        colours = np.broadcast_to(factor, (count, 4))
        if "COLOR_0" in attributes:
            own = self._scaled(attributes["COLOR_0"])
            colours = colours * (own if own.shape[1] == 4 else np.hstack([own, np.ones((count, 1))]))
        elif primitive.get("material") is None:
            colours = np.broadcast_to(np.array(_GREY) / 255.0, (count, 4))
        colours = np.round(np.clip(colours, 0.0, 1.0) * 255.0).astype(np.uint8)
        if skin is not None:
            held = self._skin(skin, attributes)
            shown = normals if normals is not None else _smooth(positions, faces)
            return Surface(positions, shown, colours, faces, texcoords, image, held, two_sided)
        positions = positions @ T_world_node[:3, :3].T.astype(np.float32) + T_world_node[:3, 3].astype(np.float32)
        if normals is not None:
            turned = normals @ np.linalg.inv(T_world_node[:3, :3]).astype(np.float32)
            turned /= np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), 1e-12)
            return Surface(positions, turned, colours, faces, texcoords, image, None, two_sided)
        return _creased(Surface(positions, positions, colours, faces, texcoords, image, None, two_sided))

    def _skin(self, index: int, attributes: _Json) -> Skin:
        """The four joints and weights of each vertex, and the inverse bind matrices."""
        skin: _Json = self.tree["skins"][index]
        inverse_binds = self._array(skin["inverseBindMatrices"]).reshape(-1, 4, 4).swapaxes(1, 2).astype(float)
        joints = self._array(attributes["JOINTS_0"])
        if int(joints.max()) >= len(inverse_binds):
            raise ValueError(f"a vertex names joint {int(joints.max())} of {len(inverse_binds)}")
        weights = self._scaled(attributes["WEIGHTS_0"])
        weights = weights / np.maximum(weights.sum(axis=1, keepdims=True), 1e-12)
        rounded = np.floor(weights * 255.0).astype(int)
        rounded[np.arange(len(rounded)), weights.argmax(axis=1)] += 255 - rounded.sum(axis=1)
        return Skin(joints.astype(np.uint8), rounded.astype(np.uint8), inverse_binds)

    def _material(self, index: int | None) -> tuple[NDArray[Any], bytes | None, bool]:
        """Base colour (4,), sRGB 0..1, the texture's bytes, and whether both sides are seen."""
        if index is None:
            return np.ones(4), None, False
        material: _Json = self.tree["materials"][index]
        two_sided = bool(material.get("doubleSided", False))
        surface: _Json = material.get("pbrMetallicRoughness", {})
        factor = np.array(surface.get("baseColorFactor", (1.0, 1.0, 1.0, 1.0)), float)
        texture = surface.get("baseColorTexture")
        if texture is None:
            return factor, None, two_sided
        source: _Json = self.tree["images"][self.tree["textures"][texture["index"]]["source"]]
        if "bufferView" not in source:
            raise ValueError("its texture lies outside the file")
        view: _Json = self.tree["bufferViews"][source["bufferView"]]
        start = int(view.get("byteOffset", 0))
        return factor, self.binary[start : start + int(view["byteLength"])], two_sided

    def _array(self, index: int) -> NDArray[Any]:
        """The numbers of an accessor, (count, width)."""
        accessor: _Json = self.tree["accessors"][index]
        view: _Json = self.tree["bufferViews"][accessor["bufferView"]]
        width, kind = _WIDTHS[accessor["type"]], np.dtype(_KINDS[accessor["componentType"]])
        start = int(view.get("byteOffset", 0)) + int(accessor.get("byteOffset", 0))
        stride = int(view.get("byteStride", 0)) or width * kind.itemsize
        count = int(accessor["count"])
        if count < 1 or start + (count - 1) * stride + width * kind.itemsize > len(self.binary):
            raise ValueError(f"accessor {index} leads out of the file")
        return np.ndarray((count, width), kind, self.binary, start, (stride, kind.itemsize)).copy()

    def _scaled(self, index: int) -> NDArray[Any]:
        """An accessor as floats: integers stand for 0..1."""
        values = self._array(index)
        if values.dtype.kind == "f":
            return values.astype(np.float32)
        return (values / float(np.iinfo(values.dtype).max)).astype(np.float32)


def _part(mesh: _Json) -> str:
    """The part of an object that a mesh is, where the look of that depends on states."""
    name = mesh.get("name", "")
    return name.removeprefix(PART) if isinstance(name, str) and name.startswith(PART) else ""


def _local(node: _Json) -> NDArray[Any]:
    """A node's own transform (4, 4)."""
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0.0, 0.0, 0.0, 1.0))
    turn = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip
    T = np.eye(4)
    T[:3, :3] = turn * np.array(node.get("scale", (1.0, 1.0, 1.0)))
    T[:3, 3] = node.get("translation", (0.0, 0.0, 0.0))
    return T


def _smooth(positions: NDArray[Any], faces: NDArray[Any]) -> NDArray[np.float32]:
    """Vertex normals (n, 3) for a skin that brings none."""
    corners = positions[faces].astype(float)
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    total = np.zeros((len(positions), 3))
    for corner in range(3):
        np.add.at(total, faces[:, corner], area)
    return (total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-20)).astype(np.float32)


def _creased(surface: Surface) -> Surface:
    """A surface without normals gets them, its vertices split where an edge is sharp and joined where it is soft."""
    faces = facing_out(surface.positions, surface.faces)
    normals = corner_normals(surface.positions, faces).reshape(-1, 3)
    corner = faces.reshape(-1)
    columns = [surface.positions[corner], np.round(normals, 2), surface.colours[corner].astype(np.float32)]
    if surface.texcoords is not None:
        columns.append(surface.texcoords[corner])
    _, first, again = np.unique(np.hstack(columns), axis=0, return_index=True, return_inverse=True)
    kept = corner[first]
    return replace(
        surface,
        positions=surface.positions[kept],
        normals=normals[first],
        colours=surface.colours[kept],
        texcoords=None if surface.texcoords is None else surface.texcoords[kept],
        faces=again.reshape(-1, 3).astype(np.uint32),
    )
