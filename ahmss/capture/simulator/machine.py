"""A tracker's electronics unit: it obeys commands, measures in its own rhythm, and makes records.

It knows no port and no clock: bytes come in with the time at which they came, bytes go out when the line is free. A
line that is too slow gets the newest frame each time it is free, so the frames between are never sent.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import replace

import numpy as np

from ahmss.capture.commands import ALL_STATIONS, Command, CommandDecoder
from ahmss.capture.formats import fastrak_ascii, fastrak_binary, liberty
from ahmss.capture.formats.answers import StatusRecord, encode_stations, encode_status
from ahmss.capture.formats.layout import Layout
from ahmss.capture.simulator.options import MODELS, SimulatorOptions
from ahmss.capture.simulator.settings import Settings, StationSettings
from ahmss.capture.simulator.stage import Stage
from ahmss.capture.stations import Reading
from ahmss.errors import CommandError

__all__ = ["Machine"]

_SLACK = 1e-9  # seconds: what a sum of frame times is off by at most


class Machine:
    """One unit with its stations, which it numbers from 1 whatever the whole tracker calls them."""

    def __init__(self, options: SimulatorOptions, unit: int, stage: Stage) -> None:
        """Args: the tracker's options; which of its units this is, from 0; the subject that all units measure."""
        self._options, self._unit, self._stage, self._faults = options, unit, stage, options.faults
        self._stations = options.units()[unit]
        self._saved = Settings.factory(len(self._stations))
        self.settings = self._saved
        self.continuous = False
        self.frames = 0
        """Frames handed to the line."""
        self._ear = CommandDecoder(options.kind)
        self._out: deque[bytes] = deque()
        self._sent = -1  # the newest frame that was sent
        self._zero: float | None = None  # when the device's own counters were 0
        self._asleep = -math.inf  # until then it reinitialises

    # -- what goes in

    def hear(self, data: bytes, now: float) -> None:
        """Obey the commands that these bytes complete; a device that is off or reinitialising is deaf."""
        if self._zero is None:
            self._zero = now
        if self._faults.off or now < self._asleep:
            return
        for command in self._ear.feed(data):
            if now < self._asleep:
                break
            try:
                self._obey(command, now)
            except (CommandError, ValueError, IndexError):
                self._refuse(command)

    def _obey(self, command: Command, now: float) -> None:
        """Do what one command says."""
        name = command.name
        if name in ("continuous", "stop", "poll"):
            self._send(name, now)
        elif name in ("binary", "ascii"):
            self.settings = replace(self.settings, binary=name == "binary")
        elif name in ("inches", "centimetres"):
            self.settings = replace(self.settings, units="inch" if name == "inches" else "cm")
        elif name in ("status", "station") and not command.arguments:
            self._out.append(self._state(name))
        elif name == "defaults":
            self.settings = Settings.factory(len(self._stations))
        elif name == "save":
            self._saved = self.settings
        elif name == "reinitialise":
            self._reinitialise(now)
        elif name == "counters":
            self._reset_counters(now)
        elif name == "unknown":
            self._refuse(command)
        else:
            self._set(command, now)

    def _send(self, name: str, now: float) -> None:
        """Begin, end, or send one frame."""
        liberty_poll = name == "poll" and self._options.kind != "fastrak"  # a poll ends its continuous output
        if name == "continuous" and not self.continuous:
            self.continuous, self._sent = True, -1
            self._stage.start(self._unit, now)
        elif name == "stop" or liberty_poll:
            self.continuous = False
            self._stage.stop(self._unit)
        if name == "poll":
            self._stage.asked(now)
            self._sent = self._sent + 1 if self._options.clock == "poll" else self._newest(now)
            self._out.append(self._frame(self._sent))

    def _set(self, command: Command, now: float) -> None:
        """Change the settings of one station, or of all."""
        everyone = command.station in (None, ALL_STATIONS)
        for index in range(len(self._stations)) if everyone else [(command.station or 0) - 1]:
            if not 0 <= index < len(self._stations):
                raise IndexError(index)
            changed = self._changed(self.settings.stations[index], index, command, now)
            self.settings = self.settings.with_station(index, changed)

    def _changed(self, station: StationSettings, index: int, command: Command, now: float) -> StationSettings:
        """A station's settings after a command."""
        values = command.arguments
        match command.name:
            case "output":
                items = tuple(int(value) for value in values) or StationSettings().items
                self._encode(Reading(index + 1, "", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)), Layout(items))
                return replace(station, items=items)
            case "station":
                return replace(station, active=bool(values[0]))
            case "hemisphere":
                return replace(station, hemisphere=np.array(values[:3]).reshape(3))
            case "boresight":
                self._stage.asked(now)
                sensed = self._stage.sense(self._stations[index], *self._moment(index, max(self._newest(now), 0)))
                return station.boresighted(sensed.rotation)
            case "unboresight":
                return replace(station, boresight=StationSettings().boresight)
            case "alignment":
                return station.aligned(self.settings.metres(np.array(values).reshape(3, 3)))
            case "reset_alignment":
                return replace(station, origin=StationSettings().origin, frame=StationSettings().frame)
            case _:  # filters and the like, which change nothing here
                return station

    def _reinitialise(self, now: float) -> None:
        """As if switched off and on: saved settings, and deaf and dumb for a while."""
        self.settings, self.continuous = self._saved, False
        self._stage.stop(self._unit)
        self._out.clear()
        self._ear = CommandDecoder(self._options.kind)
        self._zero = self._asleep = now + (0.0 if self._options.clock == "poll" else self._options.boot)

    def _reset_counters(self, now: float) -> None:
        """A recorder is about to begin: frames count from here, and a subject that nobody watches begins anew."""
        self._zero = now
        if not self.continuous:
            self._sent = -1
            self._stage.rest()

    def _refuse(self, command: Command) -> None:
        """FASTRAK answers what it does not understand with an error record; the others are silent here."""
        if self._options.kind == "fastrak":
            text = (command.text or command.name).encode("latin-1", "replace")
            self._out.append(b"2 E*ERROR*" + text + b"*ERROR* EC-99*PS0*FL0*ST0\r\n")

    # -- what goes out

    def speak(self, now: float) -> bytes:
        """What the unit hands to its free line now: an answer, or the newest frame not sent; empty if there is none."""
        if self._faults.off or now < self._asleep:
            return b""
        if self._out:
            return self._out.popleft()
        if not self.continuous:
            return b""
        newest = self._sent + 1 if self._options.clock == "poll" else self._newest(now)
        if newest <= self._sent or self._stage.over(newest / self.frames_a_second):
            return b""
        self._sent = newest
        return self._frame(newest)

    def next_time(self, now: float) -> float | None:
        """When it will next have something to say, if nothing is heard meanwhile; None: never."""
        if self._faults.off or not (self.continuous or self._out):
            return None
        if self._out or self._options.clock == "poll":
            return max(now, self._asleep)
        frame = max(self._newest(now), self._sent) + 1
        if self._stage.over(frame / self.frames_a_second):
            return None
        return (self._stage.epoch or 0.0) + frame / self.frames_a_second

    @property
    def frames_a_second(self) -> float:
        """Of the stations that are active now."""
        return self._options.unit_frames_a_second(sum(station.active for station in self.settings.stations))

    def _newest(self, now: float) -> int:
        """The number of the last frame that is measured by now; -1 before the first."""
        if self._options.clock == "poll":
            return self._sent
        return (
            -1 if self._stage.epoch is None else math.floor((now - self._stage.epoch + _SLACK) * self.frames_a_second)
        )

    def _moment(self, index: int, frame: int) -> tuple[float, int]:
        """When in the performance a station is measured in a frame, and the frame.

        Stations that share a FASTRAK's measurements are measured one after another.
        """
        seconds = frame / self.frames_a_second
        shared = self._options.measurements or MODELS[self._options.kind].measurements
        if self._options.clock == "real" and shared < math.inf:
            seconds += sum(station.active for station in self.settings.stations[:index]) / shared
        return seconds, frame

    def _frame(self, frame: int) -> bytes:
        """The records of all active stations."""
        self.frames += 1
        records: list[bytes] = []
        for index, station in enumerate(self._stations):
            settings = self.settings.stations[index]
            if not settings.active or station in self._faults.silent:
                continue
            sensed = self._stage.sense(station, *self._moment(index, frame))
            rotation, position = settings.applied(sensed.rotation, sensed.position)
            status = self._faults.status(station, far=sensed.far)
            count = self._count(frame)
            stamp = count / self.frames_a_second
            reading = Reading(index + 1, status, tuple(position.tolist()), tuple(rotation.tolist()), count, stamp)
            records.append(self._encode(reading, self.settings.layout(index, self._options.kind)))
        return b"".join(records)

    def _count(self, frame: int) -> int:
        """The device's own number of a frame: since it was switched on, or since its counters were reset."""
        if self._options.clock == "poll" or self._stage.epoch is None or self._zero is None:
            return frame
        return max(math.floor((self._stage.epoch - self._zero) * self.frames_a_second) + frame, 0)

    def _encode(self, reading: Reading, layout: Layout) -> bytes:
        """One record, as this kind of device writes it; a Liberty's printed records are not simulated."""
        kind = self._options.kind
        if kind == "fastrak":
            return (fastrak_binary if self.settings.binary else fastrak_ascii).encode(reading, layout)
        record = liberty.encode(reading, layout, "patriot" if kind == "patriot" else "liberty")
        return record if self.settings.binary else b""

    def _state(self, name: str) -> bytes:
        """The answer to a question about the device."""
        kind = self._options.kind
        there = [i + 1 for i, station in enumerate(self._stations) if station not in self._faults.silent]
        if name == "station":
            active = [i + 1 for i, station in enumerate(self.settings.stations) if station.active]
            return encode_stations(kind, there, active)
        status = StatusRecord(
            binary=self.settings.binary, units=self.settings.units, continuous=self.continuous,
            firmware="1.0.00", text=f"AHMSS simulated {kind}",
        )  # fmt: skip
        return encode_status(kind, status, sensors=there)
