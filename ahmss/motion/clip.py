"""The motion clip: poses over frames with their importance, contacts and targets, in one `.npz` without pickles.

The format is described in docs/conventions.md. What a file holds is checked here, at the border, and trusted after.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import msgspec
import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import LINKS
from ahmss.body.quaternion import norm, normalize
from ahmss.errors import DataError
from ahmss.motion import archive

__all__ = ["VERSION", "Clip", "ClipHeader", "load", "save"]

VERSION = 1

_LINKS = len(LINKS)
_SHAPES: dict[str, tuple[int, ...]] = {  # without the leading frames
    "rotations": (_LINKS, 4),
    "root": (3,),
    "importance": (_LINKS + 1,),
    "contacts": (2,),
    "targets": (5, 8),
}
_OPTIONAL = ("targets",)
_DECIMALS = 6
_UNIT = 1e-3  # how far from 1 the squared length of a quaternion in a file may be; it is normalised when read


class ClipHeader(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What a clip says of itself.

    origin: where the motion comes from. human: whose proportions it was made for ("" = nobody's).
    frame: what the poses are relative to, the human's floor frame at frame 0 or the object's frame.
    targets: what the targets are relative to; "face" is the head link's axes at the eyes.
    times: (0, 1] of each keyframe, only for keyframe clips.
    """

    version: int = VERSION
    origin: str = ""
    human: str = ""
    frame: Literal["human", "object"] = "human"
    targets: Literal["site", "human", "object", "face"] = "site"
    times: tuple[float, ...] | None = None


@dataclass(frozen=True)
class Clip:
    """A motion of F frames.

    rotations (F, 43, 4) parent <- child; root (F, 3) metres; importance (F, 44), the root's last; contacts (F, 2) in
    0..1, right and left foot; targets (F, 5, 8) or None; rate in frames a second.
    """

    rotations: Array
    root: Array
    importance: Array
    contacts: Array
    rate: float
    targets: Array | None = None
    header: ClipHeader = field(default_factory=ClipHeader)

    @property
    def frames(self) -> int:
        """How many frames there are."""
        return int(self.rotations.shape[0])

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        return (self.frames - 1) / self.rate


def load(path: Path) -> Clip:
    """The clip in a file, checked.

    Raises:
        DataError: the file is missing or broken; names the array and says what is allowed.
    """
    arrays = archive.read(path, "motion clip")
    _check_names(path, arrays)
    header = _header(path, arrays.pop("header"))
    rate = _rate(path, arrays.pop("rate"))
    frames = _check_shapes(path, arrays)
    numbers = {name: _numbers(path, name, array) for name, array in arrays.items()}
    _check_values(path, numbers)
    if header.times is not None:
        _check_times(path, header.times, frames)
    numbers["rotations"] = normalize(numbers["rotations"])
    return Clip(rate=rate, header=header, **numbers)


def save(clip: Clip, path: Path) -> None:
    """Write the clip; the same clip gives the same bytes (values rounded to 1e-6, fixed dates).

    Raises:
        DataError: the clip is not one that `load` would accept.
    """
    arrays: dict[str, Array] = {"rotations": clip.rotations, "root": clip.root, "importance": clip.importance}
    arrays["contacts"] = clip.contacts
    if clip.targets is not None:
        arrays["targets"] = clip.targets
    frames = _check_shapes(path, arrays)
    _check_values(path, arrays)
    if clip.header.times is not None:
        _check_times(path, clip.header.times, frames)
    header = msgspec.json.encode(clip.header).decode()
    content: dict[str, Any] = {name: _rounded(array) for name, array in arrays.items()}
    content |= {"rate": np.float64(clip.rate), "header": np.array(header)}
    archive.write(path, content)


def _rounded(array: Array) -> Any:
    """Single precision of values rounded to 1e-6, without negative zeros."""
    return (np.round(array, _DECIMALS) + 0.0).astype("<f4")


def _check_names(path: Path, arrays: dict[str, Any]) -> None:
    allowed = [*_SHAPES, "rate", "header"]
    for name in arrays:
        if name not in allowed:
            raise DataError(path, name, f"unknown array; a clip holds: {', '.join(allowed)}")
    for name in allowed:
        if name not in arrays and name not in _OPTIONAL:
            raise DataError(path, name, f"missing; a clip holds: {', '.join(allowed)} (targets may be left out)")


def _header(path: Path, value: Any) -> ClipHeader:
    try:
        header = msgspec.json.decode(str(value[()]), type=ClipHeader)
    except (msgspec.MsgspecError, TypeError, ValueError) as error:
        raise DataError(path, "header", f"{error}; it must be JSON with {_header_keys()}") from error
    if header.version != VERSION:
        raise DataError(path, "header", f"version {header.version}; this program reads version {VERSION}")
    return header


def _header_keys() -> str:
    return ", ".join(ClipHeader.__struct_fields__)


def _rate(path: Path, value: Any) -> float:
    if value.shape != () or value.dtype.kind not in "fiu" or not np.isfinite(value) or value <= 0:
        raise DataError(path, "rate", f"{value}; it must be one number > 0, frames a second")
    return float(value)


def _check_shapes(path: Path, arrays: dict[str, Any]) -> int:
    """How many frames all the arrays have."""
    frames = int(arrays["rotations"].shape[0]) if arrays["rotations"].ndim else 0
    for name, array in arrays.items():
        expected = (frames, *_SHAPES[name])
        if array.shape != expected or frames < 1:
            shape = ", ".join(("frames", *map(str, _SHAPES[name])))
            raise DataError(path, name, f"shape {array.shape}; it must be ({shape}), {max(frames, 1)} frames here")
    return frames


def _numbers(path: Path, name: str, array: Any) -> Array:
    if array.dtype.kind not in "fiu":
        raise DataError(path, name, f"type {array.dtype}; it must be numbers")
    return array.astype(np.float64)


def _check_values(path: Path, arrays: dict[str, Array]) -> None:
    for name, array in arrays.items():
        if not np.isfinite(array).all():
            raise DataError(path, name, f"frame {_first(~np.isfinite(array))}: not a finite number")
    _require(path, arrays["rotations"], "rotations", _off_unit(arrays["rotations"]), "unit quaternions")
    _require(path, arrays["importance"], "importance", arrays["importance"] < 0, "not negative")
    _require(path, arrays["contacts"], "contacts", _outside(arrays["contacts"]), "from 0 to 1")
    if "targets" in arrays:
        targets = arrays["targets"]
        rotation = targets[..., 3:7]
        wrong = _off_unit(rotation) & (norm(rotation) > 0.0)
        _require(path, rotation, "targets", wrong, "unit quaternions, or all 0 where the rotation is free")
        _require(path, targets[..., 7], "targets", _outside(targets[..., 7]), "weights from 0 to 1")


def _off_unit(rotations: Array) -> Any:
    return np.abs(norm(rotations) - 1.0) > _UNIT


def _outside(shares: Array) -> Any:
    return (shares < 0.0) | (shares > 1.0)


def _require(path: Path, array: Array, name: str, wrong: Any, allowed: str) -> None:
    if wrong.any():
        index = tuple(int(i) for i in np.argwhere(wrong)[0])
        raise DataError(path, name, f"frame {index[0]}, row {index[1]}: {array[index]}; they must be {allowed}")


def _first(wrong: Any) -> int:
    return int(np.argwhere(wrong)[0][0])


def _check_times(path: Path, times: tuple[float, ...], frames: int) -> None:
    if len(times) != frames:
        raise DataError(path, "header.times", f"{len(times)} times for {frames} frames; each keyframe has one")
    if any(b <= a for a, b in zip((0.0, *times), times, strict=False)) or times[-1] > 1.0:
        raise DataError(path, "header.times", f"{times}; they must rise, above 0 and up to 1")
