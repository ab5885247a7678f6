"""What can be wrong with a tracker: bytes that get lost, sensors out of reach, a cable that is out."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

__all__ = ["Damage", "Faults"]

_WEAK = "A"


@dataclass
class Faults:
    """All that is wrong now; it changes while the simulator runs.

    drop, double, flip: the share of bytes that are lost, sent twice, or have one bit turned, 0 to 1.
    weak: stations whose signal the device calls weak. silent: stations that send nothing, as with their sensor's plug
    out. off: the whole device sends nothing and hears nothing. unplugged: lines (from 1) whose cable is out, so that
    the port is gone.
    """

    drop: float = 0.0
    double: float = 0.0
    flip: float = 0.0
    weak: set[int] = field(default_factory=set[int])
    silent: set[int] = field(default_factory=set[int])
    off: bool = False
    unplugged: set[int] = field(default_factory=set[int])

    def status(self, station: int, *, far: bool) -> str:
        """What the device says of a station: "" or the letter of a weak signal."""
        return _WEAK if far or station in self.weak else ""

    def mend(self) -> None:
        """Everything works again."""
        self.drop = self.double = self.flip = 0.0
        self.weak.clear()
        self.silent.clear()
        self.unplugged.clear()
        self.off = False


class Damage:
    """Damage to the bytes of one line: the same bytes at each run with the same seed, however they are cut up."""

    def __init__(self, faults: Faults, seed: int) -> None:
        """Args: what is wrong now; the seed of one line."""
        self._faults = faults
        self._random = np.random.default_rng([seed, 4])
        self._babble = np.random.default_rng([seed, 5])

    def __call__(self, data: bytes) -> bytes:
        """The bytes as they arrive."""
        faults = self._faults
        if not data or not (faults.drop or faults.double or faults.flip):
            return data
        lost, again, turned, which = self._random.random((len(data), 4)).T
        values = np.frombuffer(data, np.uint8)
        bits = np.left_shift(1, (8.0 * which).astype(np.uint8))
        values = values ^ np.where(turned < faults.flip, bits, 0).astype(np.uint8)
        return np.repeat(values, np.where(lost < faults.drop, 0, np.where(again < faults.double, 2, 1))).tobytes()

    def whole(self, datagram: bytes) -> bytes:
        """A datagram as it arrives: empty where it got lost, else whole, its bits as they may be."""
        faults = self._faults
        if faults.drop and self._random.random() < faults.drop:
            return b""
        return Damage(Faults(flip=faults.flip), int(self._random.integers(2**31)))(datagram)

    def noise(self, count: int) -> bytes:
        """Bytes that mean nothing, as at a wrong baud rate."""
        return self._babble.integers(0, 256, count, np.uint8).tobytes()
