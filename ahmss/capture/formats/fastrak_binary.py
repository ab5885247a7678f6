"""FASTRAK's binary records: the printed head, then little-endian float32; the quaternion is w, x, y, z."""

from __future__ import annotations

import re
import struct

import numpy as np

from ahmss.body.euler import to_euler
from ahmss.capture.formats.decode import Raw, doubles, readings
from ahmss.capture.formats.fastrak import CR_LF, EULER, HEAD, POSITION, QUATERNION, SPACE, STATIONS, columns, head
from ahmss.capture.formats.layout import METRES, Layout
from ahmss.capture.formats.losses import Losses
from ahmss.capture.formats.parser import PatternParser
from ahmss.capture.stations import Reading

__all__ = ["encode", "length", "parser"]

_LENGTHS = {SPACE: 1, CR_LF: 2, POSITION: 12, EULER: 12, QUATERNION: 16}
_FIELDS = {SPACE: rb" ", CR_LF: rb"\r\n", POSITION: rb"(.{12})", EULER: rb"(.{12})", QUATERNION: rb"(.{16})"}


def length(layout: Layout) -> int:
    """The bytes of a record."""
    return 3 + sum(_LENGTHS[item] for item in layout.items)


def encode(reading: Reading, layout: Layout) -> bytes:
    """A record as the device sends it.

    Raises:
        CommandError: the output list has an item that is not known.
    """
    columns(layout)
    parts = [head(reading.station, reading.status)]
    for item in layout.items:
        if item == POSITION:
            parts.append(struct.pack("<3f", *(value / METRES[layout.units] for value in reading.position)))
        elif item == EULER:
            parts.append(struct.pack("<3f", *np.degrees(to_euler(np.array(reading.rotation)))))
        elif item == QUATERNION:
            parts.append(struct.pack("<4f", *reading.rotation))
        else:
            parts.append(b" " if item == SPACE else b"\r\n")
    return b"".join(parts)


def parser(layout: Layout) -> PatternParser:
    """A parser of records of this layout.

    Raises:
        CommandError: the output list has no position or no orientation, or an item that is not known.
    """
    where = columns(layout)
    metres = METRES[layout.units]
    pattern = HEAD % STATIONS[: layout.stations].encode() + b"".join(_FIELDS[item] for item in layout.items)

    def decode(matches: list[re.Match[bytes]], losses: Losses, arrival: float) -> list[Reading]:
        fields = [match.groups() for match in matches]
        numbers = np.frombuffer(b"".join(b"".join(field[2:]) for field in fields), "<f4")
        raw = Raw(
            [STATIONS.index(chr(field[0][0])) + 1 for field in fields],
            [field[1].decode().strip() for field in fields],
            doubles(numbers).reshape(len(fields), -1),
        )
        return readings(raw, where, metres, losses, arrival)

    return PatternParser(re.compile(pattern, re.DOTALL), length(layout), decode)
