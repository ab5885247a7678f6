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
from ahmss.capture.simulator.options import SimulatorOptions
from ahmss.capture.simulator.rhythm import Rhythm
from ahmss.capture.simulator.settings import Settings, StationSettings
from ahmss.capture.simulator.stage import Sensed, Stage
from ahmss.capture.stations import Reading
from ahmss.errors import CommandError

__all__ = ["Machine"]


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
        self._rhythm = Rhythm(options, stage, len(self._stations))
        self._awake = False  # whether it was ever switched on
        self._asleep = -math.inf  # until then it reinitialises
        self._dark = False  # whether it was off when last looked at

    # -- what goes in

    def hear(self, data: bytes, now: float) -> None:
        """Obey the commands that these bytes complete; a device that is off or reinitialising is deaf."""
        if not self._awake:
            self._awake = True
            self._rhythm.count_from(now)
        if self._deaf(now):
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
            self._change(Settings.factory(len(self._stations)), now)
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
            self.continuous = True
            self._rhythm.begin()
            self._stage.start(self._unit, now)
        elif name == "stop" or liberty_poll:
            self.continuous = False
            self._stage.stop(self._unit)
        if name == "poll":
            self._stage.asked(now)
            self._rhythm.last = self._rhythm.newest(now)
            self._out.append(self._frame(self._rhythm.last))

    def _set(self, command: Command, now: float) -> None:
        """Change the settings of one station, or of all."""
        everyone = command.station in (None, ALL_STATIONS)
        for index in range(len(self._stations)) if everyone else [(command.station or 0) - 1]:
            if not 0 <= index < len(self._stations):
                raise IndexError(index)
            changed = self._changed(self.settings.stations[index], index, command, now)
            self._change(self.settings.with_station(index, changed), now)

    def _change(self, settings: Settings, now: float) -> None:
        """From now on these settings."""
        self.settings = settings
        self._rhythm.share_among(settings.active, now)

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
                x, y, z = values
                return replace(station, hemisphere=(x, y, z))
            case "boresight":
                self._stage.asked(now)
                sensed = self._sense(index, max(self._rhythm.newest(now), 0))
                return station.boresighted(sensed.rotation, sensed.position)
            case "unboresight":
                return replace(station, boresight=None)
            case "alignment":
                return station.aligned(self.settings.metres(np.array(values).reshape(3, 3)))
            case "reset_alignment":
                return replace(station, alignment=None)
            case _:  # filters and the like, which change nothing here
                return station

    def _deaf(self, now: float) -> bool:
        """Whether it is off or reinitialising; who was off begins as it was saved."""
        if self._dark and not self._faults.off:
            self._reinitialise(now)
        self._dark = self._faults.off
        return self._dark or now < self._asleep

    def _reinitialise(self, now: float) -> None:
        """As if switched off and on: saved settings, and deaf and dumb for a while."""
        self.continuous = False
        self._stage.stop(self._unit)
        self._change(self._saved, now)
        self._out.clear()
        self._ear = CommandDecoder(self._options.kind)
        self._asleep = now + (0.0 if self._options.clock == "poll" else self._options.boot)
        self._rhythm.count_from(self._asleep)

    def _reset_counters(self, now: float) -> None:
        """A recorder is about to begin: frames count from here, and a subject that nobody watches begins anew."""
        self._rhythm.count_from(now)
        if not self.continuous:
            self._rhythm.begin()
            self._stage.rest()

    def _refuse(self, command: Command) -> None:
        """FASTRAK answers what it does not understand with an error record; the others are silent here."""
        if self._options.kind == "fastrak":
            text = (command.text or command.name).encode("latin-1", "replace")
            self._out.append(b"2 E*ERROR*" + text + b"*ERROR* EC-99*PS0*FL0*ST0\r\n")

    # -- what goes out

    def speak(self, now: float) -> bytes:
        """What the unit hands to its free line now: an answer, or the newest frame not sent; empty if there is none."""
        if self._deaf(now):
            return b""
        if self._out:
            return self._out.popleft()
        frame = self._rhythm.due(now) if self.continuous else None
        if frame is None:
            return b""
        self._rhythm.last = frame
        return self._frame(frame)

    def next_time(self, now: float) -> float | None:
        """When it will next have something to say, if nothing is heard meanwhile; None: never."""
        if self._faults.off or not (self.continuous or self._out):
            return None
        return max(now, self._asleep) if self._out else self._rhythm.next_time(now)

    @property
    def frames_a_second(self) -> float:
        """Of the stations that are active now."""
        return self._rhythm.rate

    def _frame(self, frame: int) -> bytes:
        """The records of all active stations."""
        self.frames += 1
        count = self._rhythm.count(frame)
        stamp = count / self._rhythm.rate
        records: list[bytes] = []
        for index, station in enumerate(self._stations):
            settings = self.settings.stations[index]
            if not settings.active or station in self._faults.silent:
                continue
            sensed = self._sense(index, frame)
            rotation, position = settings.applied(sensed.rotation, sensed.position)
            status = self._faults.status(station, far=sensed.far)
            reading = Reading(index + 1, status, tuple(position.tolist()), tuple(rotation.tolist()), count, stamp)
            records.append(self._encode(reading, self.settings.layout(index, self._options.kind)))
        return b"".join(records)

    def _sense(self, index: int, frame: int) -> Sensed:
        """What the station at an index measures in a frame."""
        before = sum(station.active for station in self.settings.stations[:index])
        return self._stage.sense(self._stations[index], self._rhythm.seconds(frame, before), frame)

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
