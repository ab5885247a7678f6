"""Liberty's and Patriot's binary records: an eight-byte header, then little-endian float32 and uint32.

Header: `LY` or `PA`, station u8, the command that asked (`P` or `C`), error u8 (0 or a space when all is well), a byte
in reserve, size of what follows u16. The driver asks for time stamp and frame count: with them it sees which frames
were lost.
"""

from __future__ import annotations

import re
import struct
from typing import Literal

import numpy as np

from ahmss.body.euler import to_euler
from ahmss.capture.formats.decode import Columns, Raw, doubles, readings
from ahmss.capture.formats.layout import METRES, Layout
from ahmss.capture.formats.losses import Losses
from ahmss.capture.formats.parser import PatternParser
from ahmss.capture.stations import Reading
from ahmss.errors import CommandError

__all__ = ["ITEMS", "encode", "length", "parser"]

_SPACE, _CR_LF, _POSITION, _EULER, _EULER_LONG, _QUATERNION, _STAMP, _COUNT = 0, 1, 2, 4, 5, 7, 8, 9
ITEMS = {
    _SPACE: "space",
    _CR_LF: "CR LF",
    _POSITION: "position",
    _EULER: "Euler angles",
    _EULER_LONG: "Euler angles",
    _QUATERNION: "quaternion",
    _STAMP: "time stamp",
    _COUNT: "frame count",
}
_TYPES = {
    _SPACE: ("blank", "S1"),
    _CR_LF: ("end", "S2"),
    _POSITION: ("position", "<3f4"),
    _EULER: ("euler", "<3f4"),
    _EULER_LONG: ("euler", "<3f4"),
    _QUATERNION: ("quaternion", "<4f4"),
    _STAMP: ("stamp", "<u4"),
    _COUNT: ("count", "<u4"),
}
_FIXED = {_SPACE: rb" ", _CR_LF: rb"\r\n"}


def _body(layout: Layout) -> np.dtype[np.void]:
    """What follows the header, as a numpy type.

    Raises:
        CommandError: the output list has no position or no orientation, an item twice, or one that is not known.
    """
    layout.check(ITEMS, "Liberty")
    names = [_TYPES[item][0] for item in layout.items]
    if "position" not in names or not {"euler", "quaternion"} & set(names) or len(set(names)) < len(names):
        raise CommandError(
            f"output list {layout.items}: needs 2 (position) and one of 4, 5 (Euler angles), 7 (quaternion), each once"
        )
    return np.dtype([_TYPES[item] for item in layout.items])


def length(layout: Layout) -> int:
    """The bytes of a record."""
    return 8 + _body(layout).itemsize


def encode(reading: Reading, layout: Layout, device: Literal["liberty", "patriot"] = "liberty") -> bytes:
    """A record as the device sends it; an absent count or stamp is 0.

    Raises:
        CommandError: the output list has an item that is not known.
    """
    parts: list[bytes] = []
    for item in layout.items:
        if item == _POSITION:
            parts.append(struct.pack("<3f", *(value / METRES[layout.units] for value in reading.position)))
        elif item in (_EULER, _EULER_LONG):
            parts.append(struct.pack("<3f", *np.degrees(to_euler(np.array(reading.rotation)))))
        elif item == _QUATERNION:
            parts.append(struct.pack("<4f", *reading.rotation))
        elif item == _STAMP:
            parts.append(struct.pack("<I", round(1000 * (reading.stamp or 0.0)) & 0xFFFFFFFF))
        elif item == _COUNT:
            parts.append(struct.pack("<I", (reading.count or 0) & 0xFFFFFFFF))
        else:
            parts.append(b" " if item == _SPACE else b"\r\n")
    body = b"".join(parts)
    preamble = b"LY" if device == "liberty" else b"PA"
    return struct.pack("<2sBcBBH", preamble, reading.station, b"C", ord(reading.status or " "), 0, len(body)) + body


def parser(layout: Layout) -> PatternParser:
    """A parser of records of this layout.

    Raises:
        CommandError: the output list has no position or no orientation, an item twice, or one that is not known.
    """
    body = _body(layout)
    euler = "quaternion" not in (body.names or ())
    where = Columns(0, 3, euler)
    orientation = "euler" if euler else "quaternion"
    metres = METRES[layout.units]

    def decode(matches: list[re.Match[bytes]], losses: Losses, arrival: float) -> list[Reading]:
        heads = [match.group(1) for match in matches]
        values = np.frombuffer(b"".join([match.group(2) for match in matches]), body)
        raw = Raw(
            [head[0] for head in heads],
            ["" if head[2] in b"\0 " else chr(head[2]) for head in heads],
            doubles(np.hstack([values["position"], values[orientation]])),
            values["count"].tolist() if "count" in (body.names or ()) else None,
            values["stamp"].tolist() if "stamp" in (body.names or ()) else None,
        )
        return readings(raw, where, metres, losses, arrival)

    return PatternParser(re.compile(_pattern(layout, body), re.DOTALL), 8 + body.itemsize, decode)


def _pattern(layout: Layout, body: np.dtype[np.void]) -> bytes:
    """A whole record; group 1 is station, command and error, group 2 the body."""
    station = b"[\\x01-\\x%02x]" % layout.stations
    fields = b"".join(
        _FIXED.get(item, b".{%d}" % np.dtype(_TYPES[item][1]).itemsize) for item in layout.items
    )  # fmt: skip
    size = re.escape(struct.pack("<H", body.itemsize))
    return rb"(?:LY|PA)(" + station + rb"[CP][\0 -~])." + size + rb"(" + fields + rb")"
