"""The simulator as a process: it opens the lines, says where they are, and serves them until it is told to end."""

from __future__ import annotations

import os
import selectors
import signal
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from types import FrameType

from ahmss.capture.simulator.configuration import write_configuration
from ahmss.capture.simulator.console import HELP, Console
from ahmss.capture.simulator.line import Line
from ahmss.capture.simulator.options import SimulatorOptions
from ahmss.capture.simulator.stage import Stage
from ahmss.capture.simulator.udp import Broadcast
from ahmss.errors import CommandError

__all__ = ["Simulator", "run_simulator"]

_SHORTEST_SLEEP = 0.002  # seconds: USB adaptors hand bytes over no oftener


def run_simulator(options: SimulatorOptions) -> None:
    """Be a tracker until SIGINT, SIGTERM or SIGHUP, or until `quit` is typed.

    Prints one line for each unit, `line 1: /dev/pts/4 (stations 1 to 4, 115200 baud)`, then obeys what is typed at the
    standard input: `help` lists it.

    Raises:
        CommandError: the options do not fit together.
    """
    simulator = Simulator(options, lambda sentence: print(sentence, flush=True))

    def end(_signal: int, _frame: FrameType | None) -> None:
        simulator.end()

    ends = [signal.SIGINT, signal.SIGTERM]
    if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:  # nohup
        ends.append(signal.SIGHUP)
    before = {number: signal.signal(number, end) for number in ends}
    typing_in_background = signal.signal(signal.SIGTTIN, signal.SIG_IGN)  # or a shell's `&` would halt it
    try:
        simulator.open()
        simulator.run(sys.stdin.fileno() if sys.stdin else None)
    finally:
        signal.signal(signal.SIGTTIN, typing_in_background)
        for number, handler in before.items():
            signal.signal(number, handler)


class Simulator:
    """A tracker's units, their lines, and what is typed; one thread, which sleeps until something is due."""

    def __init__(self, options: SimulatorOptions, say: Callable[[str], None]) -> None:
        """Args: what it is; where sentences for the user go.

        Raises:
            CommandError: the options do not fit together.
        """
        options.check()
        self._options, self._say = options, say
        self._console = Console(options)
        stage = Stage(options)
        self._lines: list[Line | Broadcast] = []
        if options.kind == "ultratrak":
            self._lines.append(Broadcast(options, stage))
        else:
            self._lines += [Line(options, unit, stage, say) for unit in range(len(options.units()))]
        self._wake, self._waker = os.pipe()

    def open(self) -> None:
        """Open the lines, say where they are, and write the configuration.

        Raises:
            CommandError: a line's name is taken, or an address is unknown.
        """
        try:
            for line in self._lines:
                line.open()
                self._say(line.place)
            if self._options.config_out is not None:
                addresses = [line.address for line in self._lines]
                write_configuration(self._options.config_out, self._options, addresses)
                self._say(f"wrote {self._options.config_out}")
        except BaseException:
            self._close()
            raise

    def run(self, commands: int | None = None) -> None:
        """Serve until `end` is called; obey lines that come from the file descriptor `commands`."""
        try:
            with selectors.DefaultSelector() as selector:
                selector.register(self._wake, selectors.EVENT_READ)
                if commands is not None:
                    with suppress(PermissionError, ValueError):  # a plain file or /dev/null: nobody types there
                        selector.register(commands, selectors.EVENT_READ)
                while not self._served(selector, commands):
                    pass
        finally:
            self._close()

    def end(self) -> None:
        """Make `run` return; from any thread, or from a signal's handler."""
        with suppress(OSError):
            os.write(self._waker, b"e")

    def _served(self, selector: selectors.BaseSelector, commands: int | None) -> bool:
        """Serve all that is due, sleep until something else is; whether this is the end."""
        now = time.monotonic()
        self._console.pass_time(now)
        for line in self._lines:
            line.serve(now)
        watched = self._watch(selector)
        ready = {key.fd for key, _ in selector.select(self._sleep(time.monotonic()))}
        for file in watched:
            selector.unregister(file)
        if self._wake in ready:
            return True
        return commands is not None and commands in ready and self._typed(selector, commands)

    def _watch(self, selector: selectors.BaseSelector) -> list[int]:
        """Wake up when the other side of a line writes, or has room for what waits."""
        files = [line.fileno() for line in self._lines if line.fileno() >= 0]
        for line in self._lines:
            if line.fileno() >= 0:
                selector.register(line.fileno(), selectors.EVENT_READ | (selectors.EVENT_WRITE if line.waits else 0))
        return files

    def _sleep(self, now: float) -> float | None:
        """Seconds until something is due; None: until something happens."""
        times = [self._console.next_time(), *(line.next_time(now) for line in self._lines)]
        due = [at for at in times if at is not None]
        return max(min(due) - now, _SHORTEST_SLEEP) if due else None

    def _typed(self, selector: selectors.BaseSelector, commands: int) -> bool:
        """Obey what was typed; whether that was `quit`."""
        try:
            text = os.read(commands, 4096).decode("utf-8", "replace")
        except OSError:
            text = ""  # in the background of a shell
        if not text:
            selector.unregister(commands)
        for words in text.splitlines():
            now = time.monotonic()
            try:
                wish = self._console.obey(words, now)
            except CommandError as error:
                self._say(str(error))
                continue
            for line in self._lines:
                line.serve(now)  # what was typed is true from now on
            if wish == "quit":
                return True
            if wish:
                self._say(HELP if wish == "help" else "\n".join(line.report for line in self._lines))
        return False

    def _close(self) -> None:
        for line in self._lines:
            line.close()
        for file in (self._wake, self._waker):
            with suppress(OSError):
                os.close(file)
