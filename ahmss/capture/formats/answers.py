"""What a tracker answers when it is asked: its status record, and which of its stations are there.

FASTRAK's status record has 55 bytes (manual rev. G, `S`): `2`, station, `S`, three hexadecimal digits of flags, three
of the last error, a blank, `F3` and the map of sensors, two blanks, six of the firmware, 32 of identification, CR LF.
Its answer to `l1` is `2`, station, `l`, a 0 or 1 for each of four stations, CR LF. Liberty answers `^V` with text,
and `^U0` with two 16 bit maps, of the sensors that it sees and of those that it sends; in binary mode behind its
usual header, whose command byte names the question.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterable
from dataclasses import dataclass

from ahmss.capture.formats.fastrak import STATIONS
from ahmss.capture.formats.layout import Kind, Units

__all__ = ["StatusRecord", "encode_stations", "encode_status", "find_stations", "find_status"]

_BINARY, _CENTIMETRES, _CONTINUOUS = 1, 2, 8
_ALWAYS = 0x3F0  # configuration and reserved bits, as every device sends them
_WHO, _ACTIVE = 0x16, 0x15
_STATUS = re.compile(
    rb"2([1-9A-G])S([0-9A-F]{3})(.{3}) ..(.)..(.{6})(.{32})\r\n", re.DOTALL
)  # fmt: skip
_PRINTED = re.compile(rb"00v(.*?)\r\n", re.DOTALL)
_STATES = re.compile(rb"2.l([01]{4,16})\r\n")


@dataclass(frozen=True)
class StatusRecord:
    """What the device says of itself.

    error: "" or the number of the last error of its own tests.
    text: the identification that its owner or maker wrote.
    """

    binary: bool = False
    units: Units = "inch"
    continuous: bool = False
    error: str = ""
    firmware: str = ""
    text: str = ""


def encode_status(kind: Kind, status: StatusRecord, station: int = 1, sensors: Iterable[int] = ()) -> bytes:
    """The answer to FASTRAK's `S` or Liberty's `^V`; FASTRAK's also tells of one station and of the sensors there."""
    if kind != "fastrak":
        text = f"{status.text} {status.firmware}".encode("ascii", "replace")
        if not status.binary:
            return b"00v " + text + b"\r\n"
        return struct.pack("<2sBBBBH", _preamble(kind), 0, _WHO, 0x20, 0, len(text)) + text
    flags = _ALWAYS | _BINARY * status.binary | _CENTIMETRES * (status.units == "cm") | _CONTINUOUS * status.continuous
    there = sum(1 << number - 1 for number in sensors if number <= 4)
    text = f"2{STATIONS[station - 1]}S{flags:03X}{status.error:>3.3} F3{there:X}  "
    text += f"{status.firmware:<6.6}{status.text:<32.32}\r\n"
    return text.encode("ascii", "replace")


def find_status(kind: Kind, data: bytes) -> StatusRecord | None:
    """The status in what came after it was asked for; None while it is not there whole."""
    if kind != "fastrak":
        printed = _PRINTED.search(data)
        body = printed[1] if printed else _body(kind, _WHO, data)
        return (
            None if body is None else StatusRecord(not printed, text=" ".join(body.decode("ascii", "replace").split()))
        )
    found = _STATUS.search(data)
    if found is None:
        return None
    flags = int(found[2], 16)
    error, firmware, text = (found[group].decode("ascii", "replace").strip() for group in (3, 5, 6))
    units: Units = "cm" if flags & _CENTIMETRES else "inch"
    return StatusRecord(bool(flags & _BINARY), units, bool(flags & _CONTINUOUS), error, firmware, text)


def encode_stations(kind: Kind, there: Iterable[int], active: Iterable[int] | None = None) -> bytes:
    """The answer to "which stations": those that have a sensor, and those that are switched on (all, if left out)."""
    plugged = set(there)
    on = plugged if active is None else set(active) & plugged
    if kind == "fastrak":
        return b"21l" + b"".join(b"1" if number in on else b"0" for number in range(1, 5)) + b"\r\n"
    maps = [sum(1 << number - 1 for number in numbers) for numbers in (plugged, on)]
    return struct.pack("<2sBBBBHHH", _preamble(kind), 0, _ACTIVE, 0x20, 0, 4, *maps)


def find_stations(kind: Kind, data: bytes) -> tuple[int, ...] | None:
    """The active stations in what came after they were asked for; None while the answer is not there whole."""
    if kind == "fastrak":
        states = _STATES.search(data)
        return None if states is None else tuple(at + 1 for at, state in enumerate(states[1]) if state == ord("1"))
    body = _body(kind, _ACTIVE, data)
    if body is None or len(body) < 4:
        return None
    active = struct.unpack_from("<HH", body)[1]
    return tuple(number for number in range(1, 17) if active & 1 << number - 1)


def _preamble(kind: Kind) -> bytes:
    return b"PA" if kind == "patriot" else b"LY"


def _body(kind: Kind, command: int, data: bytes) -> bytes | None:
    """What stands behind the header of the answer to this command."""
    head = re.search(_preamble(kind) + rb"." + re.escape(bytes([command])) + rb"..(..)", data, re.DOTALL)
    if head is None:
        return None
    size = struct.unpack("<H", head[1])[0]
    body = data[head.end() : head.end() + size]
    return body if len(body) == size else None
