"""What a unit can be told: its settings, and what they make of a measurement."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import IDENTITY, conjugate, from_matrix, multiply, rotate
from ahmss.capture.formats.layout import METRES, Kind, Layout, Units
from ahmss.capture.stations import Vector

__all__ = ["Alignment", "Settings", "StationSettings"]

_FACTORY_ITEMS = (2, 4, 1)  # position, Euler angles, CR LF
_SHORTEST = 1e-9


@dataclass(frozen=True, eq=False)
class Alignment:
    """A frame in which a station's output is given: origin (3,) metres, rotation (4,), both in the transmitter's."""

    origin: Array
    rotation: Array


@dataclass(frozen=True, eq=False)
class StationSettings:
    """One station's.

    items: the output list. hemisphere: towards the half of space that the sensor is in. alignment: the frame of the
    output, None: the transmitter's. boresight (4,): the rotation, in that frame, that is sent as none.
    """

    active: bool = True
    items: tuple[int, ...] = _FACTORY_ITEMS
    hemisphere: Vector = (1.0, 0.0, 0.0)
    alignment: Alignment | None = None
    boresight: Array | None = None

    def applied(self, rotation: Array, position: Array) -> tuple[Array, Array]:
        """A measurement (4,), (3,) as it is sent: on the right side, in the alignment frame, boresighted.

        A field is the same at a place and at the place opposite, so a sensor that leaves its hemisphere is measured at
        the wrong one.
        """
        if position @ self.hemisphere < 0.0:
            position = -position
        if self.alignment is not None:
            back = conjugate(self.alignment.rotation)
            rotation, position = multiply(back, rotation), rotate(back, position - self.alignment.origin)
        if self.boresight is not None:
            rotation = multiply(rotation, conjugate(self.boresight))
        return rotation, position

    def boresighted(self, rotation: Array, position: Array) -> StationSettings:
        """From now on this measured rotation (4,) is sent as none, and others relative to it."""
        return replace(self, boresight=replace(self, boresight=None).applied(rotation, position)[0])

    def aligned(self, points: Array) -> StationSettings:
        """A new frame by three points (3, 3) in metres, in the frame so far: origin, on the x axis, on the side of y.

        Raises:
            ValueError: the points stand in a line.
        """
        x, y = points[1] - points[0], points[2] - points[0]
        z = np.cross(x, y)
        if min(np.linalg.norm(x), np.linalg.norm(z)) < _SHORTEST:
            raise ValueError("an alignment's three points stand in a line")
        axes = np.stack([x, np.cross(z, x), z], axis=-1)
        turn = from_matrix(axes / np.linalg.norm(axes, axis=0))
        before = self.alignment or Alignment(np.zeros(3), IDENTITY)
        origin = before.origin + rotate(before.rotation, points[0])
        return replace(self, alignment=Alignment(origin, multiply(before.rotation, turn)))


@dataclass(frozen=True, eq=False)
class Settings:
    """A unit's: what it is when it is switched on, unless something else was saved."""

    stations: tuple[StationSettings, ...]
    binary: bool = False
    units: Units = "inch"

    @classmethod
    def factory(cls, stations: int) -> Settings:
        """As it is delivered."""
        return cls((StationSettings(),) * stations)

    @property
    def active(self) -> int:
        """How many stations are switched on."""
        return sum(station.active for station in self.stations)

    def layout(self, index: int, kind: Kind) -> Layout:
        """What a record of the station at an index holds."""
        return Layout(self.stations[index].items, self.units, 4 if kind == "fastrak" else 16)

    def metres(self, values: Array) -> Array:
        """Lengths in the device's units, as metres."""
        return values * METRES[self.units]

    def with_station(self, index: int, station: StationSettings) -> Settings:
        """The same but for one station."""
        return replace(self, stations=(*self.stations[:index], station, *self.stations[index + 1 :]))
