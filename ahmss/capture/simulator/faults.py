"""What can be wrong with a tracker: bytes that get lost, sensors out of reach, a cable that is out."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

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
    """Damage to the bytes of one line, the same at each run with the same seed."""

    def __init__(self, faults: Faults, seed: int) -> None:
        self._faults = faults
        self._random = np.random.default_rng(seed)

    def __call__(self, data: bytes) -> bytes:
        """The bytes as they arrive."""
        faults = self._faults
        if not data or not (faults.drop or faults.double or faults.flip):
            return data
        values = self._flipped(np.frombuffer(data, np.uint8))
        lost, again = self._random.random((2, len(values)))
        times = np.where(lost < faults.drop, 0, np.where(again < faults.double, 2, 1))
        return np.repeat(values, times).tobytes()

    def _flipped(self, values: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """One bit turned in as many bytes as the faults say."""
        bits = np.left_shift(1, self._random.integers(0, 8, len(values))).astype(np.uint8)
        return values ^ np.where(self._random.random(len(values)) < self._faults.flip, bits, 0).astype(np.uint8)

    def whole(self, datagram: bytes) -> bytes:
        """A datagram as it arrives: empty where it got lost, else whole, its bits as they may be."""
        if self._faults.drop and self._random.random() < self._faults.drop:
            return b""
        return self._flipped(np.frombuffer(datagram, np.uint8)).tobytes() if self._faults.flip else datagram

    def noise(self, count: int) -> bytes:
        """Bytes that mean nothing, as at a wrong baud rate."""
        return self._random.integers(0, 256, count, np.uint8).tobytes()
