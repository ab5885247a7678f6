"""FASTRAK's printed records: fixed fields, `Sxxx.xx` for lengths and angles, `Sx.xxxx` for a quaternion's four."""

from __future__ import annotations

import re

import numpy as np

from ahmss.body.euler import to_euler
from ahmss.capture.formats.decode import PRINTED, Raw, readings
from ahmss.capture.formats.fastrak import CR_LF, EULER, HEAD, POSITION, QUATERNION, SPACE, STATIONS, columns, head
from ahmss.capture.formats.layout import METRES, Layout
from ahmss.capture.formats.losses import Losses
from ahmss.capture.formats.parser import PatternParser
from ahmss.capture.stations import Reading

__all__ = ["encode", "length", "parser"]

# Seven characters, the sign before the digits or before their padding.
_LONG = rb"([ +-]\d{3}\.\d\d| [ +-]\d\d\.\d\d|  [ +-]\d\.\d\d|[+-] \d\d\.\d\d|[+-]  \d\.\d\d)"
_SHORT = rb"([ +-]\d\.\d{4})"
_FIELDS = {SPACE: rb" ", CR_LF: rb"\r\n", POSITION: _LONG * 3, EULER: _LONG * 3, QUATERNION: _SHORT * 4}
_LENGTHS = {SPACE: 1, CR_LF: 2, POSITION: 21, EULER: 21, QUATERNION: 28}


def length(layout: Layout) -> int:
    """The bytes of a record."""
    return 3 + sum(_LENGTHS[item] for item in layout.items)


def encode(reading: Reading, layout: Layout) -> bytes:
    """A record as the device prints it.

    Raises:
        CommandError: the output list has an item that is not known.
    """
    columns(layout)
    parts = [head(reading.station, reading.status)]
    for item in layout.items:
        parts.append(_item(item, reading, layout).encode("ascii"))
    return b"".join(parts)


def _item(item: int, reading: Reading, layout: Layout) -> str:
    if item == POSITION:
        return "".join(f"{value / METRES[layout.units]:7.2f}" for value in reading.position)
    if item == EULER:
        return "".join(f"{value:7.2f}" for value in np.degrees(to_euler(np.array(reading.rotation))))
    if item == QUATERNION:
        return "".join(f"{value:7.4f}" for value in reading.rotation)
    return " " if item == SPACE else "\r\n"


def parser(layout: Layout) -> PatternParser:
    """A parser of records of this layout.

    Raises:
        CommandError: the output list has no position or no orientation, or an item that is not known.
    """
    where = columns(layout, PRINTED)
    metres = METRES[layout.units]
    pattern = HEAD % STATIONS[: layout.stations].encode() + b"".join(_FIELDS[item] for item in layout.items)

    def decode(matches: list[re.Match[bytes]], losses: Losses, arrival: float) -> list[Reading]:
        fields = [match.groups() for match in matches]
        raw = Raw(
            [STATIONS.index(chr(field[0][0])) + 1 for field in fields],
            [field[1].decode().strip() for field in fields],
            np.array([[float(number.replace(b" ", b"")) for number in field[2:]] for field in fields]),
        )
        return readings(raw, where, metres, losses, arrival)

    return PatternParser(re.compile(pattern), length(layout), decode)
