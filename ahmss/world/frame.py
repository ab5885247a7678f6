"""The one message that is not msgpack: a human's frame and the objects that it moves, 60 times a second.

Little-endian: kind u8 ("F"), version u8, objects u16, human id u32, frame number u64; root 3 and rotations 172 float64;
in version 2 the human's way, 12 float64; then for each object id, place 3, rotation 4 as float64.
No msgpack struct begins with the byte "F".
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.errors import ProtocolError
from ahmss.world.schema import POSE_WIDTH, WAY_WIDTH

__all__ = [
    "BUNDLE", "HEADER", "KIND", "PLAIN", "POSE_BYTES", "ROW_BYTES", "ROW_WIDTH", "WAY_BYTES", "WITH_WAY",
    "bundle", "faulty", "faulty_ways", "is_faulty_pose", "is_faulty_row", "is_faulty_way", "pack", "unbundle",
]  # fmt: skip

KIND = 0x46
PLAIN, WITH_WAY = 1, 2
"""Versions: a frame without a way, as it was before there were any, and one with a way."""

HEADER = struct.Struct("<BBHIQ")
POSE_BYTES = POSE_WIDTH * 8
WAY_BYTES = WAY_WIDTH * 8
ROW_WIDTH = 8
ROW_BYTES = ROW_WIDTH * 8

BUNDLE = 0x42
_LENGTH = struct.Struct("<I")

_SHORTEST, _LONGEST = 0.999, 1.001
"""Squared norms that pass for 1: float32 and a few products are no fault."""

_FARTHEST = 1e5
"""Metres from the origin; farther is taken for a fault."""


def pack(
    human: int, frame: int, root: Array, rotations: Array, moved: Array | None = None, way: Array | None = None
) -> bytes:
    """One update: root (3,), rotations (43, 4), moved (m, 8) rows of object id, place, rotation; the way (6, 2).

    A way that is not known is left out.
    """
    count = 0 if moved is None else len(moved)
    told = None if way is None or math.isnan(way[0, 0]) else way
    head = HEADER.pack(KIND, PLAIN if told is None else WITH_WAY, count, human, frame)
    body = root.astype("<f8", copy=False).tobytes() + rotations.astype("<f8", copy=False).tobytes()
    if told is not None:
        body += told.astype("<f8", copy=False).tobytes()
    return head + body if moved is None else head + body + moved.astype("<f8", copy=False).tobytes()


def bundle(frames: Iterable[bytes]) -> bytes:
    """Several frames in one message ("B", then each with its length before it, u32): for a main alone in lockstep."""
    parts = [bytes([BUNDLE])]
    for frame in frames:
        parts += (_LENGTH.pack(len(frame)), frame)
    return b"".join(parts)


def unbundle(data: bytes) -> list[bytes]:
    """The frames of such a message. ProtocolError: it is cut off."""
    frames: list[bytes] = []
    at = 1
    while at + _LENGTH.size <= len(data):
        start = at + _LENGTH.size
        at = start + _LENGTH.unpack_from(data, at)[0]
        frames.append(data[start:at])
    if at != len(data):
        raise ProtocolError("world protocol: these frames are cut off")
    return frames


def faulty(places: Array, rotations: Array) -> NDArray[np.bool_]:
    """Which of n poses are none: not finite, too far, or a rotation that is not a unit quaternion; (n,) bool.

    places: (n, 3). rotations: (n, links, 4).
    """
    norms = np.einsum("nij,nij->ni", rotations, rotations)
    fine = (norms.min(axis=1) > _SHORTEST) & (norms.max(axis=1) < _LONGEST)  # false for NaN too
    fine &= (places.min(axis=1) > -_FARTHEST) & (places.max(axis=1) < _FARTHEST)
    return ~fine


def faulty_ways(ways: Array) -> NDArray[np.bool_]:
    """Which of n ways (n, 12) are none: not finite or too far, and not NaN as a whole; (n,) bool."""
    fine: NDArray[np.bool_] = np.all(np.abs(ways) < _FARTHEST, axis=1)
    fine |= np.all(np.isnan(ways), axis=1)
    return ~fine


def is_faulty_way(way: Array) -> bool:
    """The same for one human's way (12,), several times faster where it is a way."""
    return not math.hypot(*way.tolist()) < _FARTHEST and bool(faulty_ways(way[None])[0])


def is_faulty_pose(pose: Array) -> bool:
    """The same for one human's pose (175,), several times faster."""
    rotations = pose[3:].reshape(-1, 4)
    norms = np.einsum("ij,ij->i", rotations, rotations)
    x, y, z = pose[:3].tolist()
    is_near = abs(x) < _FARTHEST and abs(y) < _FARTHEST and abs(z) < _FARTHEST
    return not (is_near and norms.min() > _SHORTEST and norms.max() < _LONGEST)


def is_faulty_row(row: list[float]) -> bool:
    """The same for one object: id, place, rotation."""
    _, x, y, z, a, b, c, d = row
    is_near = abs(x) < _FARTHEST and abs(y) < _FARTHEST and abs(z) < _FARTHEST
    return not (is_near and _SHORTEST < a * a + b * b + c * c + d * d < _LONGEST)
