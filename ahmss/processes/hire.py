"""Main's side of the pool: find the one that this user's other mains share, or make it."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import sys

from ahmss.errors import AlgorithmError
from ahmss.processes.runtime import Meeting, code_stamp, private_directory

__all__ = ["Pool", "same_user"]

_BACKLOG = 128
_CREDENTIALS = 12  # pid, uid, gid: three 32-bit integers


class Pool:
    """The pool of warm Python processes, made if it is not there. While this is open it is known to be in use.

    Args:
        meeting: where; the usual place of this user, code and Python if left out.
        linger: seconds that a pool made by this one goes on after its last user.

    Raises:
        OSError, AlgorithmError: there can be none.
    """

    def __init__(self, meeting: Meeting | None = None, linger: float = 30.0) -> None:
        if not hasattr(os, "pidfd_open") or not hasattr(socket, "SOCK_SEQPACKET"):
            raise AlgorithmError("this system has no pidfd or no SOCK_SEQPACKET")
        self.meeting = meeting or Meeting(private_directory(), code_stamp())
        self._linger = linger
        self._errands: list[socket.socket] = []
        self._use = self.meeting.use()
        try:
            self.connect().close()
        except OSError:
            os.close(self._use)
            raise

    def connect(self) -> socket.socket:
        """A new, non-blocking connection for one request. Makes the pool anew where it has gone.

        Raises:
            OSError: it can't be reached, nor made.
        """
        with contextlib.suppress(FileNotFoundError, ConnectionRefusedError):
            return self._connect()
        lock = self.meeting.lock()
        try:
            with contextlib.suppress(FileNotFoundError, ConnectionRefusedError):
                return self._connect()  # another main was quicker
            _make(self.meeting, self._linger)
            return self._connect()
        finally:
            os.close(lock)

    def send(self, data: bytes) -> None:
        """Send a request that needs no answer and no pipes.

        Raises:
            OSError: as `connect`.
        """
        connection = self.connect()
        self._errands.append(connection)  # open until the end: a worker gives up a request that nobody waits for
        with open(os.devnull, "r+b", buffering=0) as nowhere:
            socket.send_fds(connection, [data], [nowhere.fileno()] * 3)

    def close(self) -> None:
        """No longer in use by this main."""
        os.close(self._use)
        for connection in self._errands:
            connection.close()

    def _connect(self) -> socket.socket:
        """A connection to the socket as it is."""
        connection = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        connection.setblocking(False)
        try:
            connection.connect(str(self.meeting.socket))
            if not same_user(connection):
                raise PermissionError(f"{self.meeting.socket} belongs to another user")
        except OSError:
            connection.close()
            raise
        return connection


def same_user(connection: socket.socket) -> bool:
    """Whether the process at the other end of a Unix socket is this user's."""
    credentials = connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS)
    return int.from_bytes(credentials[4:8], sys.byteorder) == os.getuid()


def _make(meeting: Meeting, linger: float) -> None:
    """Open the socket here, so that nobody has to wait for the pool to be up, and start the pool on it."""
    meeting.clear()
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with listener:
        listener.bind(str(meeting.socket))
        listener.listen(_BACKLOG)
        nowhere = os.open(os.devnull, os.O_RDWR | os.O_CLOEXEC)
        log = os.open(meeting.log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC, 0o600)
        environment = dict(os.environ, OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1", MKL_NUM_THREADS="1")
        moves = [(nowhere, 0), (nowhere, 1), (log, 2), (listener.fileno(), 3)]
        try:
            os.posix_spawn(
                sys.executable,
                [sys.executable, "-m", "ahmss.processes.pool", str(meeting.socket), str(linger)],
                environment,
                file_actions=[(os.POSIX_SPAWN_DUP2, source, target) for source, target in moves],
                setsid=True, setsigmask=[], setsigdef=[signal.SIGPIPE, signal.SIGINT],
            )  # fmt: skip
        finally:
            os.close(nowhere)
            os.close(log)
