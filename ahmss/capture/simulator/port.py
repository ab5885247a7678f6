"""A pseudo-terminal as a serial port: another program opens its name as it would /dev/ttyUSB0."""

from __future__ import annotations

import os
import termios
import tty
from contextlib import suppress
from pathlib import Path

from ahmss.errors import CommandError

__all__ = ["Port"]

_BAUD: dict[int, int] = {
    getattr(termios, f"B{rate}"): rate
    for rate in (
        300, 600, 1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400, 460800, 500000, 576000, 921600,
        1000000, 1500000, 2000000, 3000000, 4000000,
    )
    if hasattr(termios, f"B{rate}")
}  # fmt: skip
_CODE = {rate: code for code, rate in _BAUD.items()}
_CHUNK = 4096
_SPEED_IN, _SPEED_OUT = 4, 5  # in what tcgetattr gives


class Port:
    """The device's end of the cable. Plugged in it has a name, and that name may be a link that stays the same."""

    def __init__(self, link: Path | None, baud: int) -> None:
        """Args: the name that stays, if there is to be one; the device's rate.

        Raises:
            CommandError: a pseudo-terminal has no such rate.
        """
        if baud not in _CODE:
            raise CommandError(f"{baud} baud; there are: {', '.join(map(str, sorted(_CODE)))}")
        self._link, self._baud = link, baud
        self._device, self._name = -1, ""
        self._kept = -1  # a hold on the other end, so that the line lives on when its reader closes it

    @property
    def plugged(self) -> bool:
        """Whether there is a port that can be opened."""
        return self._device >= 0

    @property
    def name(self) -> str:
        """What the other program opens."""
        return str(self._link) if self._link else self._name

    def fileno(self) -> int:
        """For a selector."""
        return self._device

    def plug(self) -> None:
        """Make the port, raw from the start: nothing that the device sends comes back to it as a command.

        Raises:
            CommandError: there is something else at the link's place.
        """
        if self.plugged:
            return
        if self._link is not None and self._link.exists() and not self._link.is_symlink():
            raise CommandError(f"{self._link}: a file is there already; give another name for the line")
        self._device, self._kept = os.openpty()
        self._name = os.ttyname(self._kept)
        tty.setraw(self._kept)
        settings = termios.tcgetattr(self._kept)
        settings[_SPEED_IN] = settings[_SPEED_OUT] = _CODE[self._baud]
        termios.tcsetattr(self._kept, termios.TCSANOW, settings)
        os.set_blocking(self._device, False)
        if self._link is not None:
            self._link.unlink(missing_ok=True)
            self._link.symlink_to(self._name)

    def unplug(self) -> None:
        """Pull the cable out: who has the port open finds it gone."""
        if not self.plugged:
            return
        if self._link is not None and self._link.is_symlink() and os.readlink(self._link) == self._name:
            self._link.unlink(missing_ok=True)
        os.close(self._kept)
        os.close(self._device)
        self._device = self._kept = -1

    def read(self) -> bytes:
        """What the other side has sent."""
        with suppress(BlockingIOError):
            return os.read(self._device, _CHUNK)
        return b""

    def write(self, data: bytes) -> int:
        """Send; the number of bytes that the other side had room for."""
        with suppress(BlockingIOError):
            return os.write(self._device, data)
        return 0

    def baud(self) -> int:
        """The rate at which the other side listens; the device's own where that can't be said."""
        return _BAUD.get(termios.tcgetattr(self._device)[_SPEED_OUT], self._baud)
