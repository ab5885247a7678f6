"""The clips of a walk in one file: what an object's file names as the motion data of walking.

A clip of a walk holds the 15 links of the body, 60 frames a second, and which points of the soles bear. It lies along
the way: where it begins standing, its origin is the human's floor frame at its first frame, and the way leaves the
origin in the key's direction; a straight step and an end begin with the hips over x = 0 and the way along +x, the line
y = 0 being what the hips sway about.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.links import LINKS
from ahmss.body.quaternion import align, normalize
from ahmss.errors import DataError
from ahmss.motion import archive
from ahmss.walking.catalogue import MIXED, TABLE, Key

__all__ = ["BODY", "RATE", "Library", "WalkClip", "is_library", "load", "save"]

VERSION = 1
RATE = 60.0
BODY = LINKS.index("left_foot") + 1  # the links without the fingers
_ROTATION, _LENGTH = 1.0 / 32767.0, 1e-5  # quanta: of a quaternion's component, of metres
_ARRAYS = ("rotations", "root", "bearing", "header")


@dataclass(frozen=True)
class WalkClip:
    """One clip: frames 0 to N.

    rotations (N + 1, 15, 4) parent <- child, root (N + 1, 3) metres; bearing (N + 1, 2, 3): whether heel, ball and toe
    of the right and the left foot bear. source: where it comes from, for reports.
    """

    key: Key
    rotations: Array
    root: Array
    bearing: NDArray[np.bool_]
    source: str = "subject"

    @property
    def frames(self) -> int:
        """N: the intervals, not the poses."""
        return len(self.root) - 1


class _Entry(msgspec.Struct, frozen=True):
    kind: str
    direction: int
    facing: int
    stride: str
    last: str
    poses: int
    source: str


class _Header(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    version: int
    human: str
    hip_height: float
    clips: list[_Entry]


@dataclass(frozen=True)
class Library:
    """The clips by their keys. human: whose they are; hip_height: of that human standing, metres."""

    human: str
    hip_height: float
    clips: Mapping[Key, WalkClip] = field(default_factory=dict[Key, WalkClip])

    @property
    def missing(self) -> tuple[Key, ...]:
        """Which keys of table A.1 and of the mixed signs have no clip."""
        return tuple(key for key in (*TABLE, *MIXED) if key not in self.clips)


def save(library: Library, path: Path) -> None:
    """Write a library; the same library gives the same bytes.

    Smooth motion has small second differences, so these are kept, as whole numbers of a quantum.
    """
    clips = [library.clips[key] for key in sorted(library.clips)]
    entries = [
        _Entry(c.key.kind, c.key.direction, c.key.facing, c.key.stride, c.key.last, len(c.root), c.source)
        for c in clips
    ]
    header = msgspec.json.encode(_Header(VERSION, library.human, round(library.hip_height, 6), entries)).decode()
    archive.write(path, {
        "rotations": np.concatenate([_packed(_rows(c), _ROTATION) for c in clips]),
        "root": np.concatenate([_packed(c.root, _LENGTH) for c in clips]),
        "bearing": np.concatenate([np.packbits(c.bearing.reshape(-1, 6), axis=1) for c in clips]),
        "header": np.array(header),
    })  # fmt: skip


def load(path: Path) -> Library:
    """The library in a file, checked.

    Raises:
        DataError: the file is missing or broken; says what is allowed.
    """
    arrays = archive.read(path, "walk library")
    if set(arrays) != set(_ARRAYS):
        raise DataError(path, "", f"no walk library: it holds {', '.join(arrays)}, and must hold {', '.join(_ARRAYS)}")
    try:
        header = msgspec.json.decode(str(arrays["header"][()]), type=_Header)
        keys = [Key(e.kind, e.direction, e.facing, e.stride, e.last) for e in header.clips]  # pyright: ignore[reportArgumentType]
    except (msgspec.MsgspecError, TypeError, ValueError) as error:
        raise DataError(path, "header", f"{error}; make the library again with `ahmss walk build`") from error
    if header.version != VERSION:
        raise DataError(path, "header", f"version {header.version}; this program reads version {VERSION}")
    known = {*TABLE, *MIXED}
    for key in keys:
        if key not in known:
            raise DataError(path, "header", f"{key.name}: no clip of a walk is called so")
    poses = [entry.poses for entry in header.clips]
    _check_shapes(path, arrays, sum(poses), poses)
    clips: dict[Key, WalkClip] = {}
    first = 0
    for key, entry in zip(keys, header.clips, strict=True):
        part = slice(first, first + entry.poses)
        rotations = _unpacked(arrays["rotations"][part], _ROTATION).reshape(-1, BODY, 4)
        if not (np.abs(np.linalg.norm(rotations, axis=-1) - 1.0) < 0.01).all():
            raise DataError(path, "rotations", f"{key.name}: not unit quaternions")
        bearing = np.unpackbits(arrays["bearing"][part], axis=1)[:, :6].astype(bool).reshape(-1, 2, 3)
        clips[key] = WalkClip(
            key, normalize(rotations), _unpacked(arrays["root"][part], _LENGTH), bearing, entry.source
        )
        first += entry.poses
    return Library(header.human, header.hip_height, clips)


def is_library(path: Path) -> bool:
    """Whether a file holds a walk library rather than one clip; a file that can't be read holds none."""
    try:
        return archive.names(path, "walk library") == set(_ARRAYS)
    except DataError:
        return False


def _check_shapes(path: Path, arrays: Mapping[str, Any], total: int, poses: Iterable[int]) -> None:
    shapes = {"rotations": (total, BODY * 4), "root": (total, 3), "bearing": (total, 1)}
    for name, shape in shapes.items():
        kind = "u" if name == "bearing" else "i"
        if arrays[name].shape != shape or arrays[name].dtype.kind != kind:
            raise DataError(path, name, f"shape {arrays[name].shape} of {arrays[name].dtype}; it must be {shape}")
    if any(count < 3 for count in poses):
        raise DataError(path, "header", "a clip of fewer than 3 poses")


def _rows(clip: WalkClip) -> Array:
    """Rotations as rows (F, links * 4) without a change of sign from frame to frame, the first with w >= 0."""
    out = clip.rotations.copy()
    out[0] = np.where(out[0, :, :1] < 0.0, -out[0], out[0])
    for frame in range(1, len(out)):
        out[frame] = align(out[frame], out[frame - 1])
    return out.reshape(len(out), -1)


def _packed(values: Array, quantum: float) -> NDArray[np.int32]:
    """Rows (F, n) as second differences of whole quanta, the first two as they are."""
    whole = np.round(values / quantum).astype(np.int64)
    return np.diff(whole, n=2, axis=0, prepend=np.zeros((2, whole.shape[1]), np.int64)).astype(np.int32)


def _unpacked(packed: NDArray[np.int32], quantum: float) -> Array:
    return packed.astype(np.int64).cumsum(axis=0).cumsum(axis=0) * quantum
