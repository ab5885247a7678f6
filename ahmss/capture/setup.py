"""What a tracker is told before a capture, and the questions that it must answer first."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeVar

import serial

from ahmss.capture.commands import ALL_STATIONS, Command, encode
from ahmss.capture.config import LineConfig, TrackerConfig
from ahmss.capture.formats.answers import StatusRecord, find_stations, find_status

__all__ = ["Answers", "ask", "begin", "commands", "quiet", "stop"]

T = TypeVar("T")
_PAUSE = 0.03  # seconds that a device takes to obey
_RATES = {120.0: 3, 240.0: 4}  # Liberty's numbers for them


@dataclass(frozen=True)
class Answers:
    """What the device said: None where it did not answer. `heard` counts all bytes that came meanwhile."""

    status: StatusRecord | None
    stations: tuple[int, ...] | None
    heard: int


def commands(config: TrackerConfig, line: LineConfig) -> Iterator[Command]:
    """Format, units, output lists and hemispheres, in the order in which they are sent."""
    fastrak = config.kind == "fastrak"
    yield Command("binary" if config.format == "binary" else "ascii")
    yield Command("centimetres" if config.units == "cm" else "inches")
    items = tuple(float(item) for item in config.layout(line).items)
    for station in range(1, len(line.stations) + 1) if fastrak else (ALL_STATIONS,):
        yield Command("output", station, items)
        yield Command("hemisphere", station, config.hemisphere)
    if not fastrak:
        if config.rate in _RATES:
            yield Command("rate", None, (float(_RATES[config.rate]),))
        yield Command("counters")


def stop(config: TrackerConfig) -> bytes:
    """What ends continuous output (Liberty's ends at a poll)."""
    return encode(config.kind, Command("stop" if config.kind == "fastrak" else "poll"))


def begin(config: TrackerConfig) -> bytes:
    """What asks for one frame in poll mode, for all in continuous mode."""
    return encode(config.kind, Command("poll" if config.mode == "poll" else "continuous"))


def ask(port: serial.Serial, config: TrackerConfig, line: LineConfig, patience: float = 1.0) -> Answers:
    """Stop the device, set it up, and ask for its status and its stations.

    Args:
        port: open; its read timeout is short.
        config: of the tracker.
        line: the one that this port is.
        patience: seconds to wait for an answer.

    Raises:
        OSError: the port went away.
    """
    heard = quiet(port, stop(config))
    status, count = _status(port, config, patience)
    _tell(port, config, line)
    heard += count
    if status is None:
        status, count = _status(port, config, patience)
        heard += count
        if status is not None:  # it woke up meanwhile, and may have heard the half of it
            _tell(port, config, line)
    stations: tuple[int, ...] | None = None
    if status is not None and not (config.kind == "fastrak" and len(line.stations) > 4):  # it tells of four only
        question = encode(config.kind, Command("station", 1))
        stations, count = _answer(port, question, lambda data: find_stations(config.kind, data), patience)
        heard += count
    return Answers(status, stations, heard)


def _tell(port: serial.Serial, config: TrackerConfig, line: LineConfig) -> None:
    for command in commands(config, line):
        port.write(encode(config.kind, command))
        time.sleep(_PAUSE)


def _status(port: serial.Serial, config: TrackerConfig, patience: float) -> tuple[StatusRecord | None, int]:
    question = encode(config.kind, Command("status"))
    return _answer(port, question, lambda data: find_status(config.kind, data), patience)


def quiet(port: serial.Serial, word: bytes) -> int:
    """Say `word` until nothing has come for a tenth of a second, at most for one; returns how many bytes came."""
    heard, end = 0, time.monotonic() + 1.0
    port.write(b"\r" + word)
    last = time.monotonic()
    while time.monotonic() < end and time.monotonic() - last < 0.1:
        data = port.read(4096)
        if data:
            heard, last = heard + len(data), time.monotonic()
    return heard


def _answer(
    port: serial.Serial, question: bytes, find: Callable[[bytes], T | None], patience: float
) -> tuple[T | None, int]:
    """The answer found in what came, and how many bytes that was; asks twice, as a line may damage an answer."""
    heard = 0
    for _ in range(2):
        port.write(question)
        came, end = b"", time.monotonic() + 0.5 * patience
        while time.monotonic() < end and len(came) < 65536:
            came += port.read(max(1, port.in_waiting))
            found = find(came)
            if found is not None:
                return found, heard + len(came)
        heard += len(came)
    return None, heard
