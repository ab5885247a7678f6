"""One unit on its line: what the other side writes reaches the machine, and its records go out as the line can carry.

In real time the line is as slow as its baud rate. When the other side does not read, bytes get lost, as they do behind
every serial port. With the clock "poll" nothing is lost and nothing waits but for the reader.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from ahmss.capture.simulator.faults import Damage
from ahmss.capture.simulator.machine import Machine
from ahmss.capture.simulator.options import SimulatorOptions
from ahmss.capture.simulator.port import Port
from ahmss.capture.simulator.stage import Stage
from ahmss.capture.simulator.uart import Uart

__all__ = ["Line"]

_AT_ONCE = 64  # frames without looking at anything else


class Line:
    """A machine, its serial transmitter and its port; `serve` is called again and again."""

    def __init__(self, options: SimulatorOptions, unit: int, stage: Stage, say: Callable[[str], None]) -> None:
        """Args: the tracker's options; which unit, from 0; the subject; where a sentence for the user goes."""
        self._options, self._faults, self._say = options, options.faults, say
        self.number = unit + 1
        self.machine = Machine(options, unit, stage)
        self.port = Port(options.names[unit] if options.names else None, options.baud)
        self._uart = Uart(options.baud)
        self._damage = Damage(options.faults, options.seed + self.number)
        self._waiting = b""  # with the clock "poll": sent, but the other side has no room yet
        self._other_baud = options.baud
        self._garbage = 0.0  # bytes that the other side makes of these, and has not had yet
        self._served = -math.inf
        self._bytes = 0
        self.lost = 0
        """Bytes for which the other side had no room."""

    def open(self) -> None:
        """Make the port, unless its cable is out from the start.

        Raises:
            CommandError: there is something else at the name's place.
        """
        self._plug()

    def close(self) -> None:
        """Take the port away."""
        self.port.unplug()

    def fileno(self) -> int:
        """For a selector; -1 while the cable is out."""
        return self.port.fileno()

    @property
    def address(self) -> str:
        """What a driver opens."""
        return self.port.name

    @property
    def place(self) -> str:
        """Where it can be read, for the user."""
        unit = self._options.units()[self.number - 1]
        stations = f"station {unit[0]}" if len(unit) == 1 else f"stations {unit[0]} to {unit[-1]}"
        return f"line {self.number}: {self.port.name or 'unplugged'} ({stations}, {self._options.baud} baud)"

    @property
    def report(self) -> str:
        """What went over it, for the user."""
        return (
            f"line {self.number}: {self.machine.frames} frames, {self._bytes} bytes, {self.lost} of them lost because "
            f"nobody read{'' if self.port.plugged else '; unplugged'}"
        )

    @property
    def waits(self) -> bool:
        """Whether it waits for the other side to read."""
        return bool(self._waiting)

    def serve(self, now: float) -> None:
        """All that is due by now: plug in or out, hear, measure, send."""
        self._plug()
        if not self.port.plugged:
            self._uart.clear()
            return
        same_baud = self._compare_baud()
        heard = self.port.read()
        if heard and same_baud:
            self.machine.hear(heard, now)
            self._served = now
        if self._options.clock == "poll":
            self._send_freely(now)
        else:
            self._send_paced(now, same_baud=same_baud)
        self._served = now

    def next_time(self, now: float) -> float | None:
        """When there is something to do again, unless the other side writes or reads first."""
        if not self.port.plugged or self.waits:
            return None
        times = [time for time in (self._uart.next_time(), self.machine.next_time(now)) if time is not None]
        return min(times) if times else None

    def _plug(self) -> None:
        if self.number in self._faults.unplugged:
            self.port.unplug()
        else:
            self.port.plug()

    def _compare_baud(self) -> bool:
        """Whether the other side listens at the device's rate; says so when that changes."""
        other = self.port.baud()
        if other != self._other_baud:
            self._other_baud = other
            if other == self._options.baud:
                self._say(f"line {self.number}: the other side is at {other} baud now, as this tracker is")
            else:
                self._say(
                    f"line {self.number}: the other side is at {other} baud, this tracker at {self._options.baud}: "
                    "it gets garbage and is not understood"
                )
        return other == self._options.baud

    def _send_paced(self, now: float, *, same_baud: bool) -> None:
        """Hand the machine's words to the line whenever that is free, up to now; pass on what has left."""
        at = max(self._uart.free, self._served)
        while at <= now:
            words = self.machine.speak(at)
            if words:
                self._uart.load(words, at)
                at = self._uart.free
                continue
            following = self.machine.next_time(at)
            if following is None or following <= at:
                break
            at = following
        gone = self._damage(self._uart.gone(now))
        if gone and not same_baud:
            self._garbage += len(gone) * self._other_baud / self._options.baud
            gone = self._damage.noise(int(self._garbage))
            self._garbage %= 1.0
        if gone:
            self._bytes += len(gone)
            self.lost += len(gone) - self.port.write(gone)

    def _send_freely(self, now: float) -> None:
        """Send what the machine has to say, as long as the other side has room."""
        for _ in range(_AT_ONCE):
            if not self._waiting:
                self._waiting = self._damage(self.machine.speak(now))
            sent = self.port.write(self._waiting) if self._waiting else 0
            self._bytes += sent
            self._waiting = self._waiting[sent:]
            if self._waiting:
                break
