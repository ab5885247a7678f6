"""A tracker's configuration: a TOML file that says what is plugged in where, and which sensor sits on which link."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path
from typing import Literal

import msgspec
import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, multiply
from ahmss.capture.formats.layout import Kind, Layout, Units
from ahmss.capture.stations import TRACKED, Quaternion, Vector
from ahmss.database.document import Document, one_of

__all__ = ["TEMPLATE", "LineConfig", "TrackerConfig", "TransmitterConfig", "UdpConfig", "load", "template"]

_MAX_STATION = 64


class LineConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One serial line, and the stations on it.

    stations: the numbers by which the rest of the file calls the device's own stations 1, 2, 3 ...
    """

    port: str
    baud: int = 115_200
    stations: tuple[int, ...] = tuple(range(1, 16))
    parity: Literal["none", "even", "odd"] = "none"


class UdpConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Where datagrams are awaited.

    address: of this machine; "0.0.0.0" hears others too. sender: the only machine that is believed; "" for any.
    """

    port: int = 12_345
    address: str = "127.0.0.1"
    sender: str = ""


class TransmitterConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How the transmitter stands in the world: by default its x points forward, its y to the right and its z down."""

    position: Vector = (0.0, 0.0, 0.7)
    facing_deg: float = 0.0
    upside_down: bool = False

    @property
    def rotation(self) -> Array:
        """(4,) world <- transmitter, wxyz."""
        turn = from_axis_angle(np.array([0.0, 0.0, 1.0]), np.array(math.radians(self.facing_deg)))
        return turn if self.upside_down else multiply(turn, np.array([0.0, 1.0, 0.0, 0.0]))


class TrackerConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """All of a tracker's file.

    stations: link -> station number; a link that is left out is never seen.
    rate: frames a second that the device sends, or is polled for.
    hemisphere: towards the half of space, in the transmitter's frame, in which the sensors stay.
    transmitter: where it stands in the world.
    """

    kind: Kind = "liberty"
    format: Literal["binary", "ascii"] = "binary"
    orientation: Literal["quaternion", "euler"] = "quaternion"
    units: Units = "cm"
    mode: Literal["continuous", "poll"] = "continuous"
    rate: float = 60.0
    hemisphere: Vector = (1.0, 0.0, 0.0)
    line: tuple[LineConfig, ...] = ()
    udp: UdpConfig = UdpConfig()
    stations: dict[str, int] = msgspec.field(default_factory=lambda: {link: at for at, link in enumerate(TRACKED, 1)})
    transmitter: TransmitterConfig = TransmitterConfig()

    def layout(self, line: LineConfig | None = None) -> Layout:
        """The records that the devices are told to send."""
        count = len(line.stations) if line else 16
        euler = self.orientation == "euler"
        if self.kind in ("liberty", "patriot"):
            return Layout((2, 5 if euler else 7, 8, 9, 1), self.units, count)
        return Layout((2, 4 if euler else 11, 1), self.units, count)

    @property
    def rows(self) -> dict[int, int]:
        """Station number -> row of a frame."""
        return {number: TRACKED.index(link) for link, number in self.stations.items()}

    @property
    def transmitter_rotation(self) -> Quaternion:
        """World <- transmitter, wxyz."""
        w, x, y, z = self.transmitter.rotation.tolist()
        return (w, x, y, z)


def load(path: Path) -> TrackerConfig:
    """Read and check a tracker's file.

    Raises:
        DataError: names the file, the key and what is allowed.
    """
    document = Document(path, str(path))
    for at, line in enumerate(document.data.get("line", ())):  # each by itself, so that a complaint lists its own keys
        document.convert(line, LineConfig, ("line", at))
    for key, part in (("udp", UdpConfig), ("transmitter", TransmitterConfig)):
        document.convert(document.data.get(key, {}), part, (key,))
    config = document.convert(document.data, TrackerConfig)
    _check_links(document, config)
    _check_lines(document, config)
    if not 1.0 <= config.rate <= 1000.0:
        raise document.error(("rate",), f"{config.rate:g} frames a second; give 1 to 1000")
    if not any(config.hemisphere):
        raise document.error(("hemisphere",), "it points nowhere; give a direction such as [1, 0, 0]")
    if config.kind != "fastrak" and config.format == "ascii":
        raise document.error(("format",), f'{config.kind} is read in binary; give format = "binary"')
    if config.kind == "ultratrak" and config.orientation == "euler":
        raise document.error(("orientation",), 'ULTRATRAK sends quaternions; give orientation = "quaternion"')
    return config


def _check_links(document: Document, config: TrackerConfig) -> None:
    for link in config.stations:
        if link not in TRACKED:
            raise document.error(("stations", link), "no such link" + one_of(link, TRACKED))
    numbers = sorted(config.stations.values())
    if not numbers:
        raise document.error(("stations",), "no link has a sensor; give hips = 1 and so on")
    twice = [number for number, after in pairwise(numbers) if number == after]
    if twice:
        links = ", ".join(link for link, number in config.stations.items() if number == twice[0])
        raise document.error(("stations",), f"station {twice[0]} can't be on {links} at once")


def _check_lines(document: Document, config: TrackerConfig) -> None:
    if config.kind == "ultratrak":
        if config.line:
            raise document.error(("line",), "ULTRATRAK sends datagrams; give [udp] port = ... instead of lines")
        carried = set(range(1, 17))
    else:
        if not config.line:
            raise document.error(("line",), 'no serial line; give [[line]] port = "/dev/ttyUSB0"')
        carried: set[int] = set()
        most = {"fastrak": 16, "liberty": 16, "patriot": 2}[config.kind]
        for at, line in enumerate(config.line):
            if not 1 <= len(line.stations) <= most:
                message = f"{len(line.stations)} of them; a {config.kind} has 1 to {most}"
                raise document.error(("line", at, "stations"), message)
            for number in line.stations:
                if number in carried or not 1 <= number <= _MAX_STATION:
                    message = f"{number} is on another line too, or not in 1 to {_MAX_STATION}"
                    raise document.error(("line", at, "stations"), message)
                carried.add(number)
    for link, number in config.stations.items():
        if number not in carried:
            raise document.error(("stations", link), f"no line has station {number}" + one_of(str(number), carried))


TEMPLATE = """\
# What is plugged in, and which sensor sits where. `ahmss capture doctor tracker.toml` checks it.

kind = {kind:<23}# fastrak, liberty, patriot; or ultratrak, which sends datagrams
format = {format:<21}# binary or ascii (fastrak only)
orientation = "quaternion"    # or euler: azimuth, elevation, roll
units = "cm"                  # or inch
mode = "continuous"           # or poll: each frame is asked for
rate = {rate:<23}# frames a second (a FASTRAK 120 / sensors, a Liberty 120 or 240)
hemisphere = [1, 0, 0]        # the sensors stay in this half of space: x forward, y right, z down

{lines}
[stations]                    # the sensor on each link; a line left out is a link without a sensor
{stations}

[transmitter]                 # how it stands in the world: metres, degrees
position = [0.0, 0.0, 0.7]
facing_deg = 0
upside_down = false           # true: hung from above, its z axis up
"""


def template(kind: Kind = "liberty") -> str:
    """A file to start from, with a comment beside every key."""
    stations = "\n".join(f"{link} = {number}" for number, link in enumerate(TRACKED, 1))
    form = "ascii" if kind == "fastrak" else "binary"
    return TEMPLATE.format(
        kind=f'"{kind}"', format=f'"{form}"', rate=_RATES[kind], lines=_LINES[kind], stations=stations
    )


def _lines(baud: int, most: int) -> str:
    groups = [range(first, min(first + most, 16)) for first in range(1, 16, most)]
    return "\n".join(
        f'[[line]]\nport = "/dev/ttyUSB{at}"{" " * 8}# its stations 1, 2 ... are called:\nbaud = {baud}\n'
        f"stations = {list(group)}\n"
        for at, group in enumerate(groups)
    )


_RATES: dict[Kind, int] = {"fastrak": 30, "liberty": 120, "patriot": 60, "ultratrak": 60}
_LINES: dict[Kind, str] = {
    "fastrak": _lines(115_200, 4),
    "liberty": _lines(921_600, 16),
    "patriot": _lines(115_200, 2),
    "ultratrak": '[udp]\nport = 12345\naddress = "0.0.0.0"           # 127.0.0.1: this machine alone\n'
    'sender = ""                   # the address of the tracker\'s machine; "" believes any\n',
}
