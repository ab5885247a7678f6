"""When a snapshot goes out, and to where: the subscribers, and the recording."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import msgspec
import zmq

from ahmss.world.recording import Writer
from ahmss.world.schema import Snapshot, encode
from ahmss.world.space import Space

__all__ = ["Publisher"]

_GATHER_S = 0.001
_FAN_OUT_S = 40e-6  # that a snapshot costs for each listener; ten mains, each in its own time, made hundreds a second
_SHARE = 0.05  # of a processor that may go into that
_BYTES_A_SECOND = 40e6
_FLUSH_S = 1.0


class Publisher:
    """Publishes the world: at each tick, and between ticks soon after something came in.

    A frame is not kept back for the tick: it goes out at once when every human has delivered, else 1 ms after the first
    one came, so that a viewer sees it early whatever the phase of its main. Large worlds are sent less often, so that
    a subscriber gets no more than 40 MB/s, and so they are to many listeners; but once a tick.
    """

    def __init__(self, space: Space, socket: zmq.Socket[bytes], log: Callable[[str], None]) -> None:
        self._space, self._socket, self._log = space, socket, log
        self._writer: Writer | None = None
        self._flushed_at = 0.0
        self._sequence = 0
        self._first_at = 0.0
        self._gap_s = 0.0
        self._sent_at = 0.0

    def record(self, path: Path) -> None:
        """Write every tick from now on to a file. DataError: it can't be begun."""
        self._writer = Writer(path, self._space.assets.get)

    def note(self, now: float) -> None:
        """Something came in."""
        if self._first_at == 0.0:
            self._first_at = now

    def due(self, *, everybody: bool) -> float:
        """When to publish between ticks, on the monotonic clock; infinite while there is nothing new."""
        if self._first_at == 0.0:
            return float("inf")
        return max(self._first_at + (0.0 if everybody else _GATHER_S), self._sent_at + self._gap_s)

    def publish(self, tick: int, now: float, tick_s: float, listeners: int) -> None:
        """Send the world as it is now, settled, to so many."""
        self._sequence += 1
        snapshot = msgspec.structs.replace(self._space.snapshot(tick, time.time()), sequence=self._sequence)
        self.send(snapshot, now, tick_s, listeners)

    def send(self, snapshot: Snapshot, now: float, tick_s: float, listeners: int) -> None:
        """Send a snapshot to all subscribers, who are so many at the most."""
        data = encode(snapshot)
        self._socket.send(data, zmq.NOBLOCK)
        self._first_at, self._sent_at = 0.0, now
        self._gap_s = min(max(len(data) / _BYTES_A_SECOND, listeners * _FAN_OUT_S / _SHARE), tick_s)

    def write(self, snapshot: Snapshot, now: float) -> None:
        """Add a tick to the recording, if there is one. A full disk is said once and ends the recording only."""
        if self._writer is None:
            return
        try:
            self._writer.write(snapshot, self._space.scene)
            if now - self._flushed_at > _FLUSH_S:
                self._flushed_at = now
                self._writer.flush()
        except OSError as error:
            self._give_up(error)

    @property
    def is_recording(self) -> bool:
        """Whether ticks are written to a file."""
        return self._writer is not None

    def close(self) -> None:
        """Finish the recording."""
        if self._writer is None:
            return
        try:
            self._writer.close()
        except OSError as error:
            self._give_up(error)

    def _give_up(self, error: OSError) -> None:
        writer, self._writer = self._writer, None
        if writer is None:
            return
        self._log(f"{writer.path}: the recording stops here ({error.strerror}); what was written can be viewed; "
                  "the world goes on")  # fmt: skip
        try:
            writer.close()
        except OSError:  # said already
            return
