"""Why a tracker is silent: one sentence with a cure, from what the system says and what came over the line."""

from __future__ import annotations

import errno
import grp
import os
import pwd
import stat
from dataclasses import dataclass
from pathlib import Path

from serial.tools import list_ports

from ahmss.capture.config import LineConfig, TrackerConfig
from ahmss.capture.formats.decode import REACH

__all__ = ["Heard", "of_error", "of_silence", "unbelieved"]

_LATELY = 1.0  # seconds
_GROUP_READS_AND_WRITES = stat.S_IRGRP | stat.S_IWGRP


@dataclass
class Heard:
    """What came over a line so far; times are monotonic seconds, 0 for never.

    last_damaged: when a whole record came last whose values can't be.
    """

    opened: float = 0.0
    set_up: float = 0.0
    bytes: int = 0
    answered: bool = False
    stations: tuple[int, ...] | None = None
    records: int = 0
    last_record: float = 0.0
    last_damaged: float = 0.0

    def unbelieved(self, now: float) -> bool:
        """Whether records come, but none that can be believed."""
        return self.last_damaged > self.last_record and now - self.last_damaged < _LATELY


def unbelieved(where: str, device: str) -> str:
    """Why records come and are of no use."""
    return (
        f"{where}: {device} sends records with values that can't be; come nearer to the transmitter (what is farther "
        f"than {REACH:g} m is not believed)"
    )


def of_error(port: str, error: OSError) -> str:
    """Why a port can't be opened, or went away (pyserial's errors are OSErrors too)."""
    number = _number(error)
    if number == errno.ENOENT or (number is None and not os.path.exists(port)):
        others = ", ".join(sorted(other.device for other in list_ports.comports())) or "none"
        return f"{port}: no such port; plug the tracker in, or give another (this machine has: {others})"
    if number in (errno.EACCES, errno.EPERM):
        return f"{port}: this user may not open it; {_let_in(port)}"
    if number in (errno.EBUSY, errno.EAGAIN):
        return f"{port}: another program has it open; end that one first"
    if number in (errno.ENOTTY, errno.EINVAL, errno.EISDIR):
        why = error.strerror or error
        return f"{port}: this is no serial port, or not one of that speed; look at port and baud in the file ({why})"
    return f"{port}: unplugged, or the adapter went away ({error.strerror or error}); plug it in again"


def of_silence(config: TrackerConfig, line: LineConfig, heard: Heard, now: float) -> str:
    """Why an open line gives no records, or gives none any more."""
    where, device = line.port, config.kind.upper()
    if heard.unbelieved(now):
        return unbelieved(where, device)
    if heard.records:
        quiet = now - heard.last_record
        return f"{where}: {device} fell silent {quiet:.0f} s ago; look at its power and its cable"
    if heard.answered and heard.stations == ():
        return (
            f"{where}: {device} answers, but sees no sensor; plug in sensors and transmitter, and switch it off and on"
        )
    if heard.answered:
        return (
            f"{where}: {device} answers, but sends no record that can be read; is kind = {config.kind!r} right, and is "
            "the transmitter plugged in?"
        )
    if heard.bytes:
        return (
            f"{where}: bytes come, but nothing that {device} sends; the baud rate is hardly {line.baud} (switches "
            "on its back set it): `ahmss capture doctor` tries the others"
        )
    return (
        f"{where}: not a byte comes; is the {device} switched on, is the cable plugged in at both ends, and is it the "
        "right cable (a FASTRAK wants a null modem)?"
    )


def _let_in(port: str) -> str:
    """How a user comes to open a port that refuses them: by its folder's owner, or by its group."""
    user = os.environ.get("USER", "$USER")
    try:
        found = os.stat(port)
    except OSError as error:
        return _closed_folder(port) or f"nor may they look at its rights ({error.strerror or error})"
    own = f"type: sudo chown {user} {port}   (holds until it is plugged in again)"
    if found.st_gid == 0 or found.st_mode & _GROUP_READS_AND_WRITES != _GROUP_READS_AND_WRITES:
        return f"its mode lets no group in; {own}"
    try:
        group = grp.getgrgid(found.st_gid).gr_name
    except KeyError:
        return f"its group, {found.st_gid}, has no name here, so nobody can be added to it; {own}"
    if found.st_gid in os.getgroups():
        return f"though its group {group} is theirs: something else forbids it, such as the container that this runs in"
    return f"type: sudo usermod -aG {group} {user}   (and log in again)"


def _closed_folder(port: str) -> str:
    """Which of the folders that lead to a port is closed to this user, and who may open it; "" where none is."""
    for folder in reversed(Path(os.path.abspath(port)).parents):
        if os.access(folder, os.X_OK):
            continue
        try:
            owner = _user_named(folder.stat().st_uid)
        except OSError:
            return ""
        return (
            f"the folder {folder} is closed to them; {owner}, whose it is, or root may open it: "
            f"sudo chmod o+x {folder}   (or give a port elsewhere)"
        )
    return ""


def _user_named(number: int) -> str:
    """A user's name, or its number where it has none."""
    try:
        return pwd.getpwuid(number).pw_name
    except KeyError:
        return f"user {number}"


def _number(error: OSError) -> int | None:
    """The system's error number; pyserial keeps some of them in the error that it wraps."""
    inner = error.__context__.args if error.__context__ else ()
    return error.errno or next((part for part in inner[:1] if isinstance(part, int)), None)
