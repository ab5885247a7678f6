"""ULTRATRAK's datagrams, received by a thread: lost, doubled, late and foreign ones do no harm."""

from __future__ import annotations

import errno
import socket
import threading
import time
from collections.abc import Callable

from ahmss.capture.assembly import Sweep
from ahmss.capture.config import TrackerConfig, UdpConfig
from ahmss.capture.formats import ultratrak
from ahmss.capture.formats.losses import Losses
from ahmss.capture.trouble import Heard, unbelieved

__all__ = ["Numbers", "UdpPort"]

_TIMEOUT = 0.02
_RETRY = 0.5
_LARGEST = 4096
_NEAR = 3  # frames by which a number may be off


class Numbers:
    """Tells a tracker that goes on from damaged numbers, and from one that was started again."""

    def __init__(self, rate: float) -> None:
        """Args: frames a second."""
        self._rate = rate
        self._latest: tuple[int, float] | None = None
        self._stranger: int | None = None

    def judge(self, number: int, now: float) -> bool | None:
        """True: the numbers begin anew here; False: they go on; None: this one belongs to nothing.

        A number goes on when it is near the latest, or as far ahead as time has gone by; else when the next agrees.
        """
        if self._latest is None:
            self._latest = (number, now)
            return True
        ahead, due = number - self._latest[0], (now - self._latest[1]) * self._rate
        goes_on = -self._rate <= ahead <= _NEAR or abs(ahead - due) <= _NEAR + 0.25 * due
        if not goes_on and not (self._stranger is not None and 0 < number - self._stranger <= _NEAR):
            self._stranger = number
            return None
        self._stranger = None
        if goes_on:
            self._latest = max(self._latest, (number, now))
            return False
        self._latest = (number, now)
        return ahead < 0


class UdpPort:
    """The socket's thread. Whatever goes wrong stays in it: `trouble` says what, and `give` gets the frames."""

    def __init__(self, config: TrackerConfig, give: Callable[[Sweep], None]) -> None:
        """Args: the tracker; who takes the frames, as sweeps of all its stations."""
        self.losses = Losses()
        self.heard = Heard()
        self._config, self._udp, self._give = config, config.udp, give
        self._error = ""
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._run, name="tracker udp", daemon=True)

    def start(self) -> None:
        """Begin; returns at once."""
        self._thread.start()

    def end(self) -> None:
        """Ask the thread to end; returns at once."""
        self._stopping.set()

    def stop(self) -> None:
        """End the thread; returns when the socket is closed."""
        self.end()
        if self._thread.ident is not None:
            self._thread.join(5.0)

    def trouble(self, now: float) -> str:
        """Why no frame came for the last second; "" while they come."""
        if self._error:
            return self._error
        heard, udp = self.heard, self._udp
        if not heard.opened or now - max(heard.opened, heard.last_record) < 1.0:
            return ""
        where = f"UDP {udp.address}:{udp.port}"
        if heard.unbelieved(now):
            return unbelieved(where, "ULTRATRAK")
        if heard.records:
            return f"{where}: silent for {now - heard.last_record:.0f} s; look at its power and its cable"
        if self.losses.foreign:
            return f"{where}: {self.losses.foreign} datagrams came, none of an ULTRATRAK; is this the right port?"
        return (
            f"{where}: nothing comes; does the tracker's PC send to this machine and port, and does the firewall let "
            f"it in?{' It hears this machine alone.' if udp.address.startswith('127.') else ''}"
        )

    def _run(self) -> None:
        while not self._stopping.is_set():
            try:
                with _listening(self._udp) as sock:
                    self._error = ""
                    self.heard = Heard(opened=time.monotonic())
                    self._serve(sock)
            except OSError as error:
                self._error = _of_error(self._udp, error)
                self._stopping.wait(_RETRY)

    def _serve(self, sock: socket.socket) -> None:
        numbers = Numbers(self._config.rate)
        while not self._stopping.is_set():
            try:
                data, sender = sock.recvfrom(_LARGEST)
            except TimeoutError:
                continue
            now = time.monotonic()
            if self._udp.sender and sender[0] != self._udp.sender:
                self.losses.foreign += 1
                continue
            self._frame(data, now, numbers)

    def _frame(self, data: bytes, now: float, numbers: Numbers) -> None:
        damaged = self.losses.damaged
        frame = ultratrak.decode(data, self._config.units, self.losses, now)
        if self.losses.damaged > damaged:
            self.heard.last_damaged = now
        fresh = None if frame is None else numbers.judge(frame.number, now)
        if frame is None:
            return
        if fresh is None:
            self.losses.miscounted += len(frame.readings)
            return
        self.heard.bytes += len(data)
        self.heard.records += len(frame.readings)
        if frame.readings or self.losses.damaged == damaged:
            self.heard.last_record = now
        self._give(Sweep(frame.number, {reading.station: reading for reading in frame.readings}, now, fresh))


def _listening(udp: UdpConfig) -> socket.socket:
    """The bound socket.

    Raises:
        OSError: the address is not this machine's, or the port is taken.
    """
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        sock.settimeout(_TIMEOUT)
        sock.bind((udp.address, udp.port))
    except BaseException:
        sock.close()
        raise
    return sock


def _of_error(udp: UdpConfig, error: OSError) -> str:
    where = f"UDP {udp.address}:{udp.port}"
    if error.errno == errno.EADDRINUSE:
        return f"{where}: another program listens there; end that one first, or give another port"
    if error.errno == errno.EADDRNOTAVAIL or isinstance(error, socket.gaierror):
        return f"{where}: this machine has no such address; give 127.0.0.1, or 0.0.0.0 for all that it has"
    return f"{where}: can't listen there ({error.strerror or error})"
