"""The one message that is not msgpack: a human's frame and the objects that it moves, 60 times a second.

Little-endian: kind u8 ("F"), version u8, objects u16, human id u32, frame number u64; root 3 and rotations 172 float64;
then for each object id, place 3, rotation 4 as float64. No msgpack struct begins with the byte "F".
"""

from __future__ import annotations

import struct

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.world.schema import POSE_WIDTH

__all__ = ["HEADER", "KIND", "POSE_BYTES", "ROW_BYTES", "ROW_WIDTH", "faulty", "pack"]

KIND = 0x46
FRAME_VERSION = 1
HEADER = struct.Struct("<BBHIQ")
POSE_BYTES = POSE_WIDTH * 8
ROW_WIDTH = 8
ROW_BYTES = ROW_WIDTH * 8

_UNIT_SLACK = 1e-3
_FARTHEST = 1e5
"""Metres from the origin; farther is taken for a fault."""


def pack(human: int, frame: int, root: Array, rotations: Array, moved: Array | None = None) -> bytes:
    """One update: root (3,), rotations (43, 4), moved (m, 8) rows of object id, place, rotation."""
    count = 0 if moved is None else len(moved)
    head = HEADER.pack(KIND, FRAME_VERSION, count, human, frame)
    body = root.astype("<f8", copy=False).tobytes() + rotations.astype("<f8", copy=False).tobytes()
    return head + body if moved is None else head + body + moved.astype("<f8", copy=False).tobytes()


def faulty(places: Array, rotations: Array) -> NDArray[np.bool_]:
    """Which of n poses are none: not finite, too far, or a rotation that is not a unit quaternion; (n,) bool.

    places: (n, 3). rotations: (n, links, 4).
    """
    with np.errstate(invalid="ignore", over="ignore"):
        norms = np.einsum("nij,nij->ni", rotations, rotations)
        fine = np.abs(norms - 1.0).max(axis=1) <= _UNIT_SLACK  # false for NaN too
        fine &= np.abs(places).max(axis=1) <= _FARTHEST
    return ~fine
