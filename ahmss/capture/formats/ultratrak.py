"""ULTRATRAK PRO's datagrams, a whole frame each: a printed header of 56 bytes, then 33 bytes for each station.

The header names four numbers: frame number, bytes of the frame, of the header, of a record. A record has a pad, the
board (`0` to `7`), the update flag, the station on its board (`1` or `2`), a pad, float32 position (3) and quaternion
(4, w first) in the byte order of the sender, a PC: little-endian. The station's number is 2 (board - `0`) +
(station - `0`), 1 to 16 (the facts after OpenTracker's reader, whose numbers begin at 0).

Nothing tells what the update flag means. Here `0` and NUL say that nothing new was measured; such a record is left out.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ahmss.capture.formats.decode import Columns, Raw, doubles, readings
from ahmss.capture.formats.layout import METRES, Units
from ahmss.capture.formats.losses import Losses
from ahmss.capture.stations import Reading

__all__ = ["Datagram", "decode", "encode"]

_HEADER = 56
_HEAD = re.compile(rb"\s*\S+\s+(\d{1,10})\s+\S+\s+(\d{1,5})\s+\S+\s+(\d{1,3})\s+\S+\s+(\d{1,3})\b")
_RECORD = np.dtype([
    ("pad", "u1"), ("board", "u1"), ("update", "u1"), ("station", "u1"), ("end", "u1"),
    ("position", "<f4", 3), ("quaternion", "<f4", 4),
])  # fmt: skip
_COLUMNS = Columns(0, 3, euler=False)


@dataclass(frozen=True)
class Datagram:
    """One frame: its number and its readings."""

    number: int
    readings: list[Reading]


def encode(number: int, frame: Sequence[Reading], units: Units = "cm") -> bytes:
    """The datagram of a frame of at most 16 readings."""
    size = _HEADER + _RECORD.itemsize * len(frame)
    head = f"Frame {number} Size {size} Header {_HEADER} Record {_RECORD.itemsize}\n".encode("ascii")
    parts = [head.ljust(_HEADER, b" ")]
    for reading in frame:
        board, station = divmod(reading.station - 1, 2)
        parts.append(struct.pack("<BBBBB", 0, ord("0") + board, ord("1"), ord("1") + station, 0))
        parts.append(struct.pack("<7f", *(value / METRES[units] for value in reading.position), *reading.rotation))
    return b"".join(parts)


def decode(data: bytes, units: Units, losses: Losses, arrival: float = 0.0) -> Datagram | None:
    """The frame of a datagram, or None (counted as foreign) where it is not a tracker's; never raises.

    Args:
        data: one datagram.
        units: of its positions.
        losses: counts `foreign`, `records`, `damaged`.
        arrival: monotonic seconds; the readings carry it.
    """
    head = _HEAD.match(data[:_HEADER])
    if head is None:
        losses.foreign += 1
        return None
    number, size, header, record = (int(part) for part in head.groups())
    count, rest = divmod(size - _HEADER, _RECORD.itemsize)
    if size != len(data) or header != _HEADER or record != _RECORD.itemsize or rest or not 0 < count <= 16:
        losses.foreign += 1
        return None
    rows = np.frombuffer(data, _RECORD, count, _HEADER)
    known = (rows["board"] >= ord("0")) & (rows["board"] <= ord("7"))
    known &= (rows["station"] == ord("1")) | (rows["station"] == ord("2"))
    losses.damaged += int(count - known.sum())
    rows = rows[known & (rows["update"] != 0) & (rows["update"] != ord("0"))]
    stations = 2 * (rows["board"].astype(int) - ord("0")) + rows["station"] - ord("0")
    values = doubles(np.hstack([rows["position"], rows["quaternion"]]))
    raw = Raw(stations.tolist(), [""] * len(rows), values, [number] * len(rows))
    return Datagram(number, readings(raw, _COLUMNS, METRES[units], losses, arrival))
