"""One serial line and its thread, which opens it, sets the device up, reads, and opens it again after an unplugging."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from contextlib import suppress

import serial

from ahmss.capture import setup
from ahmss.capture.assembly import Assembler, Numbering, Sweep
from ahmss.capture.config import LineConfig, TrackerConfig
from ahmss.capture.formats import fastrak_ascii, fastrak_binary, liberty
from ahmss.capture.formats.losses import Losses
from ahmss.capture.formats.parser import Parser
from ahmss.capture.trouble import Heard, of_error, of_silence

__all__ = ["Port", "numbering_of", "open_port", "parser_of"]

_READ_TIMEOUT = 0.02
_GATHER = 0.001  # seconds to let the bytes of a frame gather: a read for each of them would cost a core
_RETRY = 0.5
_SILENT = 2.0  # seconds after which a device is set up again: it may have been off, and have forgotten all
_PARITY = {"none": serial.PARITY_NONE, "even": serial.PARITY_EVEN, "odd": serial.PARITY_ODD}


def open_port(line: LineConfig, baud: int | None = None) -> serial.Serial:
    """Open a line for this program alone.

    Raises:
        OSError: (pyserial's SerialException is one) missing, forbidden, in use, or no serial port.
    """
    return serial.Serial(
        line.port,
        baud or line.baud,
        parity=_PARITY[line.parity],
        timeout=_READ_TIMEOUT,
        write_timeout=1.0,
        exclusive=True,
    )


def parser_of(config: TrackerConfig, line: LineConfig) -> Parser:
    """The parser of what this line will send."""
    layout = config.layout(line)
    if config.kind == "fastrak":
        return (fastrak_binary if config.format == "binary" else fastrak_ascii).parser(layout)
    return liberty.parser(layout)


def numbering_of(config: TrackerConfig) -> Numbering:
    """Polls are numbered by themselves (a Liberty counts on between them); lines without a count by the time."""
    if config.mode == "poll":
        return "order"
    if 9 in config.layout().items:
        return "count"
    return "clock" if len(config.line) == 1 else "time"


class Port:
    """A line's thread. Whatever goes wrong stays in it: `trouble` says what, and `give` gets the sweeps."""

    def __init__(
        self, config: TrackerConfig, line: LineConfig, give: Callable[[Sweep], None], together: threading.Barrier
    ) -> None:
        """Args: the tracker; its line; who takes the sweeps; where all lines wait to begin at one time."""
        self.losses = Losses()
        self.heard = Heard()
        self._config, self._line, self._give, self._together = config, line, give, together
        self._error = ""
        self._began = False
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"tracker {line.port}", daemon=True)

    def start(self) -> None:
        """Begin; returns at once."""
        self._thread.start()

    def end(self) -> None:
        """Ask the thread to end; returns at once."""
        self._stopping.set()
        self._together.abort()

    def stop(self) -> None:
        """End the thread; the device is told to stop sending. Returns when the port is closed."""
        self.end()
        if self._thread.ident is not None:
            self._thread.join(5.0)

    def trouble(self, now: float) -> str:
        """Why no record came for the last second; "" while they come, or while the line is still being set up."""
        if self._error:
            return self._error
        heard = self.heard
        if not heard.opened or now - max(heard.opened, heard.last_record) < 1.0:
            return ""
        return of_silence(self._config, self._line, heard, now)

    def _run(self) -> None:
        while not self._stopping.is_set():
            try:
                with open_port(self._line) as port:
                    self._error = ""
                    self._serve(port)
            except (OSError, TypeError) as error:  # a closed descriptor gives pyserial a TypeError
                self._error = of_error(self._line.port, error if isinstance(error, OSError) else OSError(str(error)))
                if self.heard.opened:
                    self.losses.reopened += 1
                    self.heard = Heard()
                self._stopping.wait(_RETRY)

    def _serve(self, port: serial.Serial) -> None:
        """Set the device up and read it until the end.

        Raises:
            OSError: the port went away.
        """
        parser = parser_of(self._config, self._line)
        parser.losses = self.losses
        assembler = Assembler(self._line.stations, self._config.rate, self.losses, numbering=numbering_of(self._config))
        heard = Heard()
        self._set_up(port, assembler, heard)
        self._wait_for_others()
        heard.opened = time.monotonic()
        self.heard = heard
        port.reset_input_buffer()
        (self._poll if self._config.mode == "poll" else self._listen)(port, parser, assembler)
        port.write(setup.stop(self._config))
        port.flush()

    def _set_up(self, port: serial.Serial, assembler: Assembler, heard: Heard) -> None:
        """Tell the device what to send, and note what it answers."""
        answers = setup.ask(port, self._config, self._line)
        if answers.stations:
            assembler.expect(answers.stations)
        heard.bytes += answers.heard
        heard.set_up = time.monotonic()
        heard.answered |= answers.status is not None
        if answers.status is not None:
            heard.stations = answers.stations

    def _revived(self, port: serial.Serial, assembler: Assembler) -> bool:
        """Set a device that has been silent for long up again; returns whether that was done."""
        heard = self.heard
        if time.monotonic() - max(heard.opened, heard.set_up, heard.last_record) < _SILENT:
            return False
        self._set_up(port, assembler, heard)
        return True

    def _wait_for_others(self) -> None:
        """So that all devices begin with the same frame; one that is late, or opened again, begins alone."""
        if not self._began:
            self._began = True
            with suppress(threading.BrokenBarrierError):
                self._together.wait(timeout=4.0)

    def _listen(self, port: serial.Serial, parser: Parser, assembler: Assembler) -> None:
        port.write(setup.begin(self._config))
        while not self._stopping.is_set():
            self._take(port, parser, assembler)
            if self._revived(port, assembler):
                port.write(setup.begin(self._config))

    def _poll(self, port: serial.Serial, parser: Parser, assembler: Assembler) -> None:
        """Ask for a frame at each tick; a frame whose answer was lost is given up after a quarter of a second."""
        period = 1.0 / self._config.rate
        due = time.monotonic()
        while not self._stopping.is_set():
            self._hand_on(assembler.poll())
            port.write(setup.begin(self._config))
            end = time.monotonic() + max(0.25, 2.0 * period)
            while not self._take(port, parser, assembler) and time.monotonic() < end and not self._stopping.is_set():
                pass
            self._revived(port, assembler)
            due = max(due + period, time.monotonic() - period)
            self._stopping.wait(max(0.0, due - time.monotonic()))

    def _take(self, port: serial.Serial, parser: Parser, assembler: Assembler) -> int:
        """Read what is there, waiting shortly where there is nothing; returns how many sweeps that made."""
        data = port.read(1)
        now = time.monotonic()
        if data:
            if port.in_waiting < 16:
                time.sleep(_GATHER)
            data += port.read(port.in_waiting)
            now = time.monotonic()
        heard, damaged = self.heard, self.losses.damaged
        readings = parser.feed(data, now) if data else []
        if self.losses.damaged > damaged:
            heard.last_damaged = now
        heard.bytes += len(data)
        if readings:
            heard.records += len(readings)
            heard.last_record = now
        sweeps = assembler.feed(readings) + assembler.flush(now)
        self._hand_on(sweeps)
        return len(sweeps)

    def _hand_on(self, sweeps: list[Sweep]) -> None:
        for sweep in sweeps:
            self._give(sweep)
