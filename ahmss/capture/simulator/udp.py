"""The ULTRATRAK's way: it takes no commands, but sends a datagram a frame to one address, heard or not."""

from __future__ import annotations

import math
import socket

from ahmss.capture.formats import ultratrak
from ahmss.capture.simulator.faults import Damage
from ahmss.capture.simulator.options import SimulatorOptions
from ahmss.capture.simulator.stage import Stage
from ahmss.capture.stations import Reading
from ahmss.errors import CommandError

__all__ = ["Broadcast"]

_SETTLED = 3  # datagrams that nobody refused: somebody listens, or nobody can say


class Broadcast:
    """All stations on one UDP address.

    The subject waits, and the first frame is sent over and over, until the address no longer answers that nobody is
    there: so a recorder on this machine misses nothing, whichever is started first. A datagram comes whole or not at
    all: the fault `drop` is a share of datagrams, and `double` is none. Its records have no place for a weak signal: a
    weak station is left out.
    """

    waits = False
    lost = 0

    def __init__(self, options: SimulatorOptions, stage: Stage) -> None:
        """Args: the tracker's options; the subject.

        Raises:
            CommandError: the address is none.
        """
        self._options, self._stage, self._faults = options, stage, options.faults
        host, _, port = options.address.rpartition(":")
        if not host or not port.isdecimal():
            raise CommandError(f'"{options.address}" is no address to send to; write it as 127.0.0.1:12345')
        self.address = options.address
        self._to = (host, int(port))
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._damage = Damage(options.faults, options.seed)
        self._accepted = 0
        self._next = -math.inf
        self._sent = 0

    def open(self) -> None:
        """Reach for the address.

        Raises:
            CommandError: there is no such host.
        """
        self._socket.setblocking(False)
        try:
            self._socket.connect(self._to)
        except OSError as error:
            raise CommandError(f"{self.address}: {error.strerror}; give the recorder's machine") from error

    def close(self) -> None:
        """Send no more."""
        self._socket.close()

    def fileno(self) -> int:
        """Nothing is ever heard."""
        return -1

    @property
    def place(self) -> str:
        """Where it sends to, for the user."""
        return f"datagrams to {self.address} (stations 1 to {self._options.stations})"

    @property
    def report(self) -> str:
        """What went out, for the user."""
        return f"{self.address}: {self._sent} datagrams"

    def serve(self, now: float) -> None:
        """Send what is due."""
        if now < self._next:
            return
        rate = self._options.frames_a_second
        if self._stage.epoch is None and self._accepted < _SETTLED:
            self._next = now + 1.0 / rate
            self._send(0)
            return
        if self._stage.epoch is None:
            self._stage.start(0, now)
        epoch = self._stage.epoch or now
        frame = math.floor((now - epoch) * rate + 1e-6)
        self._next = epoch + (frame + 1) / rate
        if not self._stage.over(frame / rate):
            self._send(frame)

    def next_time(self, now: float) -> float | None:
        """When the next datagram is due."""
        return max(self._next, now)

    def _send(self, frame: int) -> None:
        """One frame of all stations that are heard."""
        if self._faults.off or 1 in self._faults.unplugged:
            return
        readings: list[Reading] = []
        for station in range(1, self._options.stations + 1):
            sensed = self._stage.sense(station, frame / self._options.frames_a_second, frame)
            if station in self._faults.silent or self._faults.status(station, far=sensed.far):
                continue
            readings.append(Reading(station, "", tuple(sensed.position.tolist()), tuple(sensed.rotation.tolist())))
        datagram = self._damage.whole(ultratrak.encode(frame, readings))
        if not datagram:
            return
        try:
            self._socket.send(datagram)
        except (ConnectionRefusedError, BlockingIOError):
            self._accepted = 0
            return
        self._accepted += 1
        self._sent += 1
