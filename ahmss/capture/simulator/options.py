"""What a simulated tracker is: its kind, its lines, its subject, and all that can be wrong with it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from ahmss.capture.config import TransmitterConfig
from ahmss.capture.formats.layout import Kind
from ahmss.capture.performance import Performance
from ahmss.capture.simulator.faults import Faults
from ahmss.capture.simulator.noise import NoiseLevel
from ahmss.capture.stations import TRACKED
from ahmss.errors import CommandError

_LARGEST = 16  # stations that any format can number

__all__ = ["MODELS", "Ending", "Model", "SimulatorOptions"]

Ending = Literal["hold", "loop", "stop"]
Clock = Literal["real", "poll"]


@dataclass(frozen=True)
class Model:
    """What one unit of a kind can do at most.

    stations: sensors that fit. frames: a second, whatever the number of sensors. measurements: a second, shared by
    the active stations.
    """

    stations: int
    frames: float
    measurements: float = math.inf


MODELS: dict[Kind, Model] = {
    "fastrak": Model(stations=4, frames=120.0, measurements=120.0),
    "liberty": Model(stations=16, frames=240.0),
    "patriot": Model(stations=2, frames=60.0),
    "ultratrak": Model(stations=16, frames=60.0),
}
"""From the makers' data sheets; the ULTRATRAK's 60 frames/s also in Ichiguchi 2000, table 5.2."""


def _behind() -> TransmitterConfig:
    return TransmitterConfig(position=(-1.0, 0.0, 0.0))


@dataclass(frozen=True)
class SimulatorOptions:
    """One simulated tracker.

    performance: what the subject does. It begins when the device is told to send (or at the first poll).
    kind: fastrak, liberty, patriot (on pseudo-terminals) or ultratrak (over UDP).
    lines: units, each on a line of its own; 0: as many as the stations need.
    stations: how many of the 15 links bear a sensor, in the order of `TRACKED`.
    rate: frames a second that the device is set to; its model and its line may carry fewer.
    measurements: a second, shared by a unit's active stations; left out: the model's, 120 for a FASTRAK. Given, a unit
        has room for 16 stations: a larger machine that speaks the same language.
    synchronised: several units measure at the same moments, as through their sync connectors: all as often as the
        slowest of them; False lets a unit of fewer stations run ahead.
    baud: of every line; what a line can't carry is not sent. A reader at another baud rate gets garbage.
    names: paths at which the lines can be opened, one a line; left out: the system's own names, /dev/pts/N.
    address: HOST:PORT that an ULTRATRAK sends to.
    clock: "real", or "poll": each poll, or each frame that is read, is one frame later, however long it takes.
    after: the subject's last pose is held, or the performance begins again, or nothing more is sent.
    seed: of the mounting and of all noise and faults.
    mounted: sensors sit askew on the links, as they do; False puts them on the links' own frames.
    noise: "none", "resolution", or "full": table 5.2.
    faults: what is wrong from the start; commands typed at the running simulator change it.
    boot: seconds that a reinitialisation takes (none with the clock "poll").
    transmitter: where it stands; by default on the floor, a metre behind the world's origin.
    config_out: a configuration for the driver is written here. truth: the mounting and the motion are written here.
    """

    performance: Performance
    kind: Kind = "fastrak"
    lines: int = 0
    stations: int = len(TRACKED)
    rate: float = 60.0
    measurements: float | None = None
    synchronised: bool = True
    baud: int = 115200
    names: tuple[Path, ...] = ()
    address: str = "127.0.0.1:12345"
    clock: Clock = "real"
    after: Ending = "hold"
    seed: int = 0
    mounted: bool = True
    noise: NoiseLevel = "none"
    faults: Faults = field(default_factory=Faults)
    boot: float = 10.0
    transmitter: TransmitterConfig = field(default_factory=_behind)
    config_out: Path | None = None
    truth: Path | None = None

    def check(self) -> None:
        """Look whether all of it can be.

        Raises:
            CommandError: says what can't, and what can.
        """
        self.units()
        numbers = {"rate": self.rate, "measurements": self.measurements or 1.0, "baud": self.baud}
        for name, value in numbers.items():
            if not 0.0 < value < math.inf:
                raise CommandError(f"{name} {value:g}; it must be above 0")
        if not self.boot >= 0.0:
            raise CommandError(f"boot {self.boot:g}; it must be 0 seconds or more")
        for name in ("drop", "double", "flip"):
            share = getattr(self.faults, name)
            if not 0.0 <= share <= 1.0:
                raise CommandError(f"{name} {share:g}; it is a share of all bytes, 0 to 1")
        strangers = (self.faults.weak | self.faults.silent) - set(range(1, self.stations + 1))
        if strangers:
            raise CommandError(f"no station {min(strangers)}; there are 1 to {self.stations}")

    @property
    def frames_a_second(self) -> float:
        """Of the slowest unit, when all of its stations are active: as set, and as its model and measurements allow."""
        return self._rate_of(max(len(unit) for unit in self.units()))

    def unit_frames_a_second(self, active: int) -> float:
        """Of a unit with so many active stations now."""
        alone = self._rate_of(active)
        together = self.synchronised and len(self.units()) > 1
        return min(alone, self.frames_a_second) if together else alone

    def _rate_of(self, active: int) -> float:
        model = MODELS[self.kind]
        return min(self.rate, model.frames, (self.measurements or model.measurements) / max(active, 1))

    def units(self) -> tuple[tuple[int, ...], ...]:
        """The stations of each unit, numbered through all units from 1.

        Raises:
            CommandError: they do not fit.
        """
        if not 1 <= self.stations <= len(TRACKED):
            raise CommandError(f"{self.stations} stations; a person bears 1 to {len(TRACKED)}")
        room = MODELS[self.kind].stations if self.measurements is None else _LARGEST
        needed = math.ceil(self.stations / room)
        lines = self.lines or needed
        if lines < needed or lines > self.stations:
            allowed = f"{needed} to {self.stations}" if needed < self.stations else str(needed)
            raise CommandError(
                f"{lines} lines for {self.stations} stations of a {self.kind}, which has at most {room}; use {allowed}"
            )
        if self.names and len(self.names) != lines:
            raise CommandError(f"{len(self.names)} names for {lines} lines; give one a line, or none")
        share = math.ceil(self.stations / lines)
        numbers = tuple(range(1, self.stations + 1))
        return tuple(numbers[first : first + share] for first in range(0, self.stations, share))
