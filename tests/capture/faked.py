"""A tracker on a pseudo-terminal, simpler than the simulator and independent of it: for tests of the driver."""

from __future__ import annotations

import os
import pty
import select
import threading
import time
import tty
from dataclasses import dataclass, field

import msgspec
import numpy as np

from ahmss.capture.commands import CommandDecoder
from ahmss.capture.config import LineConfig, TrackerConfig
from ahmss.capture.formats import fastrak_ascii, fastrak_binary, liberty
from ahmss.capture.formats.answers import StatusRecord, encode_stations, encode_status
from ahmss.capture.stations import Reading


def truth(station: int, count: int) -> Reading:
    """What a station shows at a frame: it swings slowly."""
    x = 0.1 * station + 0.2 * np.sin(count / 20.0)
    half = 0.3 * np.sin(count / 30.0 + station)
    rotation = (float(np.cos(half)), 0.0, float(np.sin(half)), 0.0)
    return Reading(station, "", (float(x), 0.0, -0.5), rotation, count, count / 60.0)


@dataclass
class Fake:
    """A device of one line.

    Set `mute`, `off`, `noise` (in the stream), `weak`, `away` (metres) as it runs; `heard` are the commands.
    """

    kind: str
    stations: int
    rate: float = 60.0
    form: str = "binary"
    mute: bool = False
    off: bool = False
    noise: bytes = b""
    weak: int = 0
    away: float = 0.0
    heard: list[str] = field(default_factory=list)

    def __post_init__(self):
        self.master, self.slave = pty.openpty()
        tty.setraw(self.slave)
        self.path = os.ttyname(self.slave)
        self.count = 0
        self.continuous = False
        self.metric = True  # lost when it is switched off, and with it all that was set
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._serve)

    def config(self, mode: str = "continuous") -> TrackerConfig:
        line = LineConfig(self.path, 115_200, tuple(range(1, self.stations + 1)))
        return TrackerConfig(kind=self.kind, format=self.form, mode=mode, rate=self.rate, line=(line,))

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._ending.set()
        self._thread.join()
        self.unplug()

    def unplug(self):
        self._ending.set()
        if self._thread.is_alive():
            self._thread.join()
        for file in (self.master, self.slave):
            if file >= 0:
                os.close(file)
        self.master = self.slave = -1

    def _serve(self):
        decoder = CommandDecoder(self.kind)
        due = time.monotonic()
        while not self._ending.is_set():
            if select.select([self.master], [], [], 0.003)[0]:
                commands = decoder.feed(os.read(self.master, 4096))
                for command in [] if self.off else commands:
                    self._obey(command)
            if self.off:
                self.continuous, self.metric, self.count = False, False, 0
            if self.continuous and time.monotonic() >= due:
                due = max(due + 1.0 / self.rate, time.monotonic() - 1.0)
                self._frame()

    def _obey(self, command):
        self.heard.append(command.name)
        if command.name == "status":
            self._write(encode_status(self.kind, StatusRecord(self.form == "binary", text="a fake")))
        elif command.name == "station" and not command.arguments:
            self._write(encode_stations(self.kind, range(1, self.stations + 1)))
        elif command.name == "centimetres":
            self.metric = True
        elif command.name == "continuous":
            self.continuous = True
        elif command.name == "stop":
            self.continuous = False
        elif command.name == "poll":
            self.continuous = False
            self._frame()

    def _frame(self):
        encode = {"liberty": liberty.encode, "patriot": liberty.encode}.get(self.kind, fastrak_binary.encode)
        encode = fastrak_ascii.encode if self.form == "ascii" else encode
        layout = self.config().layout(self.config().line[0])
        records = [truth(station, self.count) for station in range(1, self.stations + 1)]
        if self.weak:
            records[self.weak - 1] = Reading(self.weak, "C", *_pose(records[self.weak - 1]))
        if self.away:
            records = [msgspec.structs.replace(record, position=(self.away, 0.0, 0.0)) for record in records]
        data = b"".join(encode(record, layout) for record in records)
        data = data[: len(data) // 2] + self.noise + data[len(data) // 2 :]
        self._write(data if self.metric else b"0 1  what nobody asked for\r\n")
        self.count += 1

    def _write(self, data: bytes):
        if not self.mute:
            os.write(self.master, data)


def _pose(reading):
    return reading.position, reading.rotation, reading.count, reading.stamp
