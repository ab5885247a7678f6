"""GLB as a container (glTF 2.0, chapters 3.6 and 4): a tree of JSON and a block of bytes with the arrays it names."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ahmss.errors import ProtocolError

__all__ = ["ARRAY_BUFFER", "ELEMENT_BUFFER", "GlbReader", "GlbWriter"]

ARRAY_BUFFER, ELEMENT_BUFFER = 34962, 34963
_COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_NUMBERS = {np.dtype(kind): number for number, kind in _COMPONENTS.items()}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_KINDS = {width: kind for kind, width in _WIDTHS.items()}
_HEAD = struct.Struct("<4sII")
_CHUNK = struct.Struct("<I4s")

Json = dict[str, Any]


class GlbReader:
    """A GLB's tree and its arrays.

    Raises:
        ProtocolError: the bytes are no GLB of version 2.
    """

    def __init__(self, data: bytes) -> None:
        if len(data) < _HEAD.size or _HEAD.unpack_from(data)[:2] != (b"glTF", 2):
            raise ProtocolError("these bytes are no GLB of version 2")
        chunks: dict[bytes, bytes] = {}
        at = _HEAD.size
        while at + _CHUNK.size <= len(data):
            length, kind = _CHUNK.unpack_from(data, at)
            at += _CHUNK.size
            chunks.setdefault(kind, data[at : at + length])
            at += length
        try:
            self.tree: Json = json.loads(chunks[b"JSON"])
        except (KeyError, ValueError) as error:
            raise ProtocolError(f"this GLB has no readable JSON ({error})") from error
        self._binary = chunks.get(b"BIN\0", b"")

    def array(self, index: int) -> NDArray[Any]:
        """An accessor's rows (count, width), as they are stored.

        Raises:
            ProtocolError: it is sparse, or not within the file.
        """
        accessor: Json = self.tree["accessors"][index]
        if "bufferView" not in accessor or "sparse" in accessor:
            raise ProtocolError(f"accessor {index} of this GLB is sparse or empty; export its mesh plainly")
        dtype, width = np.dtype(_COMPONENTS[accessor["componentType"]]), _WIDTHS[accessor["type"]]
        view: Json = self.tree["bufferViews"][accessor["bufferView"]]
        row = dtype.itemsize * width
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        rows = np.ndarray((accessor["count"], row), np.uint8, self._binary, start, (view.get("byteStride", row), 1))
        return np.ascontiguousarray(rows).view(dtype)

    def view(self, index: int) -> bytes:
        """A buffer view's bytes: an image."""
        view: Json = self.tree["bufferViews"][index]
        start = view.get("byteOffset", 0)
        return self._binary[start : start + view["byteLength"]]


class GlbWriter:
    """A GLB put together: `tree` is free to be filled, accessors and views are added here."""

    def __init__(self, generator: str) -> None:
        self.tree: Json = {"asset": {"version": "2.0", "generator": generator}}
        self._accessors: list[Json] = []
        self._views: list[Json] = []
        self._binary = bytearray()

    def add(self, rows: NDArray[Any], *, target: int = 0, normalized: bool = False, bounds: bool = False) -> int:
        """Add rows (count, width) as an accessor; its number.

        Args:
            rows: of the component type that is to be stored.
            target: `ARRAY_BUFFER` for vertices, `ELEMENT_BUFFER` for indices, 0 for what is neither.
            normalized: integers stand for 0 to 1.
            bounds: the least and greatest are told, as places and times need.
        """
        accessor: Json = {
            "bufferView": self.add_view(np.ascontiguousarray(rows).tobytes(), target=target),
            "componentType": _NUMBERS[rows.dtype], "count": len(rows), "type": _KINDS[rows.shape[1]],
        }  # fmt: skip
        if normalized:
            accessor["normalized"] = True
        if bounds:
            accessor |= {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
        self._accessors.append(accessor)
        return len(self._accessors) - 1

    def add_view(self, data: bytes, *, target: int = 0) -> int:
        """Add bytes as a buffer view; its number."""
        view: Json = {"buffer": 0, "byteOffset": len(self._binary), "byteLength": len(data)}
        self._views.append(view | ({"target": target} if target else {}))
        self._binary += data + bytes(-len(data) % 4)
        return len(self._views) - 1

    def bytes(self) -> bytes:
        """The whole file."""
        arrays: Json = {
            "accessors": self._accessors, "bufferViews": self._views, "buffers": [{"byteLength": len(self._binary)}],
        }  # fmt: skip
        text = json.dumps(self.tree | arrays, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        body = b"".join(_CHUNK.pack(len(d), kind) + d for kind, d in ((b"JSON", text), (b"BIN\0", bytes(self._binary))))
        return _HEAD.pack(b"glTF", 2, _HEAD.size + len(body)) + body
