"""A take: what a tracker sent while a person moved, as it came, kept in one `.npz` without pickles.

Nothing is corrected here. Rotations and places are those of the sensors in the transmitter's frame (x forward, y
right, z down); what they mean for the body is the calibration's to say.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.links import LINKS
from ahmss.body.quaternion import IDENTITY, multiply, norm, normalize, rotate
from ahmss.capture.stations import TRACKED, Status
from ahmss.errors import DataError
from ahmss.motion import archive

if TYPE_CHECKING:
    from ahmss.capture.stations import TrackerFrame

__all__ = ["VERSION", "Take", "TakeHeader", "from_frames", "load", "save"]

VERSION = 1
_SENSORS = len(TRACKED)
_SHAPES: dict[str, tuple[int, ...]] = {
    "times": (), "rotations": (_SENSORS, 4), "positions": (_SENSORS, 3), "status": (_SENSORS,)
}  # fmt: skip
_UNIT = 1e-3  # how far from 1 the squared length of a quaternion in a file may be; it is normalised when read


class TakeHeader(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What a take says of itself.

    origin: the device and the day. transmitter_rotation (wxyz) and transmitter_place (metres): world <- transmitter.
    """

    version: int = VERSION
    origin: str = ""
    transmitter_rotation: tuple[float, float, float, float] = (0.0, 1.0, 0.0, 0.0)
    transmitter_place: tuple[float, float, float] = (0.0, 0.0, 0.7)


@dataclass(frozen=True, eq=False)
class Take:
    """F frames of 15 sensors, in the order of the first 15 links.

    times (F,) seconds from the start; rotations (F, 15, 4) unit, transmitter <- sensor; positions (F, 15, 3) metres,
    transmitter's frame; status (F, 15) GOOD, WEAK, MISSING or IMPLAUSIBLE; rate in frames a second. Where status is
    MISSING, rotation and place are the last known ones and mean nothing.
    """

    times: Array
    rotations: Array
    positions: Array
    status: NDArray[np.uint8]
    rate: float
    header: TakeHeader = field(default_factory=TakeHeader)

    @property
    def frames(self) -> int:
        """How many frames there are."""
        return len(self.times)

    @property
    def missing(self) -> NDArray[np.bool_]:
        """(F, 15) where nothing was measured, or nothing that can be."""
        return self.status >= Status.MISSING

    def world_rotations(self) -> Array:
        """The sensors' rotations (F, 15, 4), world <- sensor."""
        return multiply(np.array(self.header.transmitter_rotation), self.rotations)

    def world_places(self) -> Array:
        """The sensors' places (F, 15, 3) in the world, metres."""
        turn = np.array(self.header.transmitter_rotation)
        return np.array(self.header.transmitter_place) + rotate(turn, self.positions)


def from_frames(frames: Sequence[TrackerFrame], rate: float, header: TakeHeader | None = None) -> Take:
    """The take of frames as they came.

    A frame's place is its number, so that frames lost on the line leave a gap of MISSING and time keeps its pace.

    Raises:
        DataError: no frames came.
    """
    if not frames:
        raise DataError("take", "", "no frame came from the tracker; `ahmss capture doctor` says why")
    first = frames[0].number
    rows = np.array([frame.number - first for frame in frames])
    count = int(rows[-1]) + 1
    status = np.full((count, _SENSORS), int(Status.MISSING), np.uint8)
    rotations, positions = np.tile(IDENTITY, (count, _SENSORS, 1)), np.zeros((count, _SENSORS, 3))
    status[rows] = [frame.status for frame in frames]
    rotations[rows], positions[rows] = [frame.rotations for frame in frames], [frame.positions for frame in frames]
    return Take(np.arange(count) / rate, rotations, positions, status, rate, header or TakeHeader())


def load(path: Path) -> Take:
    """The take in a file, checked.

    Raises:
        DataError: the file is missing or broken; names the array and says what is allowed.
    """
    arrays = archive.read(path, "take")
    for name in (*_SHAPES, "rate", "header"):
        if name not in arrays:
            raise DataError(path, name, f"missing; a take holds: {', '.join(_SHAPES)}, rate, header")
    try:
        header = msgspec.json.decode(str(arrays["header"][()]), type=TakeHeader)
        rate = float(arrays["rate"])
    except (msgspec.MsgspecError, TypeError, ValueError) as error:
        raise DataError(path, "header", f"{error}; it must be a take's, written by `ahmss capture record`") from error
    if header.version != VERSION or not rate > 0.0:
        raise DataError(path, "header", f"version {header.version}, rate {rate:g}; it must be {VERSION} and above 0")
    _check(path, arrays)
    numbers = {name: np.asarray(arrays[name], float) for name in ("times", "rotations", "positions")}
    numbers["rotations"] = normalize(numbers["rotations"])
    return Take(status=np.asarray(arrays["status"], np.uint8), rate=rate, header=header, **numbers)


def save(take: Take, path: Path) -> None:
    """Write the take; the same take gives the same bytes, in single precision, far finer than any tracker."""
    content: dict[str, Any] = {
        "times": take.times,
        "rotations": take.rotations.astype("<f4"),
        "positions": take.positions.astype("<f4"),
        "status": take.status,
        "rate": np.float64(take.rate),
        "header": np.array(msgspec.json.encode(take.header).decode()),
    }
    archive.write(path, content)


def _check(path: Path, arrays: dict[str, Any]) -> None:
    frames = len(arrays["times"]) if arrays["times"].ndim else 0
    for name, shape in _SHAPES.items():
        array = arrays[name]
        if array.shape != (frames, *shape) or frames < 1:
            raise DataError(path, name, f"shape {array.shape}; it must be {(max(frames, 1), *shape)}")
        if array.dtype.kind not in "fiu" or not np.isfinite(array).all():
            raise DataError(path, name, "not finite numbers only")
    off = np.abs(norm(arrays["rotations"].astype(float)) - 1.0) > _UNIT
    if off.any():
        frame, sensor = map(int, np.argwhere(off)[0])
        raise DataError(path, "rotations", f"frame {frame}, {LINKS[sensor]}: not a unit quaternion")
    if (arrays["status"] > max(Status)).any() or (arrays["status"] < min(Status)).any():
        raise DataError(path, "status", f"they must be {min(Status)} to {max(Status)}")
