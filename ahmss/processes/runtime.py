"""Where main and the pool meet: a private directory, and names that only the same code and Python share."""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import os
import socket
import stat
import sys
import tempfile
from pathlib import Path

import ahmss
from ahmss.errors import AlgorithmError

__all__ = ["Meeting", "code_stamp", "private_directory", "sweep"]

# What the pool holds in memory.
_PACKAGES = ("algorithm", "skills", "processes", "body", "database", "grasping", "motion", "reaching", "walking")


def code_stamp() -> str:
    """Changes when the code that the pool holds does, and differs between checkouts and Pythons."""
    root = Path(ahmss.__file__).parent
    digest = hashlib.sha256(f"{sys.prefix} {sys.version} {root}".encode())
    for file in sorted(file for package in _PACKAGES for file in (root / package).glob("*.py")):
        status = file.stat()
        digest.update(f"{file.name} {status.st_mtime_ns} {status.st_size}".encode())
    return digest.hexdigest()[:16]


def private_directory() -> Path:
    """A directory for sockets that only this user may enter.

    Raises:
        AlgorithmError: somebody else's stands in its place.
    """
    runtime = os.environ.get("XDG_RUNTIME_DIR", "")
    if runtime and Path(runtime).is_dir() and os.access(runtime, os.W_OK):
        directory = Path(runtime) / "ahmss"
    else:
        directory = Path(tempfile.gettempdir()) / f"ahmss-{os.getuid()}"
    directory.mkdir(mode=0o700, exist_ok=True)
    status = directory.lstat()
    if not stat.S_ISDIR(status.st_mode) or status.st_uid != os.getuid() or status.st_mode & 0o077:
        raise AlgorithmError(f"{directory} is not a directory of yours alone (chmod 700); remove it and try again")
    return directory


class Meeting:
    """The files of one pool: its socket, the lock under which it is made, and the lock that its users share."""

    def __init__(self, directory: Path, stamp: str) -> None:
        self.socket = directory / f"pool-{stamp}.socket"
        self.making = directory / f"pool-{stamp}.making"
        self.using = directory / f"pool-{stamp}.using"
        self.log = directory / f"pool-{stamp}.log"

    def use(self) -> int:
        """A descriptor that says, while it is open, that somebody uses the pool."""
        return _locked(self.using, fcntl.LOCK_SH)

    def unused(self) -> bool:
        """Whether nobody uses the pool."""
        try:
            os.close(_locked(self.using, fcntl.LOCK_EX | fcntl.LOCK_NB))
        except BlockingIOError:
            return False
        return True

    def lock(self) -> int:
        """A descriptor that holds the lock on making and ending the pool, until it is closed."""
        return _locked(self.making, fcntl.LOCK_EX)

    def clear(self) -> None:
        """Remove the socket and the log; with the lock held."""
        self.socket.unlink(missing_ok=True)
        self.log.unlink(missing_ok=True)

    def remove(self) -> None:
        """Leave nothing; with the lock held, which is none from here on. Who uses the pool keeps its sign of that."""
        self.clear()
        with contextlib.suppress(BlockingIOError):
            using = _locked(self.using, fcntl.LOCK_EX | fcntl.LOCK_NB)
            self.using.unlink()
            os.close(using)
        self.making.unlink(missing_ok=True)


def sweep(directory: Path) -> None:
    """Remove what pools have left that were killed, or that knew not to."""
    for stamp in {path.stem.removeprefix("pool-") for path in directory.glob("pool-*")}:
        meeting = Meeting(directory, stamp)
        try:
            lock = _locked(meeting.making, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            continue
        if meeting.unused() and not _answers(meeting.socket):
            meeting.remove()
        os.close(lock)


def _locked(path: Path, operation: int) -> int:
    """A descriptor that holds a lock on the file at the path; BlockingIOError where it was to be had at once and can't.

    A file that was removed while this waited locks nothing: then it is made anew.
    """
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        try:
            fcntl.flock(descriptor, operation)
        except OSError:
            os.close(descriptor)
            raise
        with contextlib.suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(descriptor), path.stat()):
                return descriptor
        os.close(descriptor)


def _answers(path: Path) -> bool:
    """Whether somebody listens on the socket."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as stranger:
        stranger.setblocking(False)
        try:
            stranger.connect(str(path))
        except (FileNotFoundError, ConnectionRefusedError):
            return False
        except OSError:  # it has too much to do
            return True
    return True
