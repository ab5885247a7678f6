"""A child process: one that main spawned itself, or one hired from the pool. The same few questions to either."""

from __future__ import annotations

import contextlib
import errno
import os
import select
import shutil
import signal
import socket
import struct
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Protocol

import msgspec

from ahmss.errors import AlgorithmError
from ahmss.processes.silence import Silence
from ahmss.processes.stream import Pipes

__all__ = ["GREETING", "Child", "Hired", "Request", "Spawned", "describe"]

GREETING = struct.Struct("<i")  # from the pool: first the worker's process id, at its end its exit status
_UNKNOWN = 256  # an exit status that nobody could tell
_PATIENCE = 5.0  # seconds until a pool that does not answer is given up, longer on a busy machine


class Child(Protocol):
    """A process with three pipes."""

    pipes: Pipes

    @property
    def pid(self) -> int:
        """Of the process; 0: not known yet."""
        ...

    def poll(self) -> int | None:
        """None while it runs; then its exit code, or minus the signal that killed it. Reaps it and its group."""
        ...

    def signal(self, number: int) -> None:
        """Send a signal to it and to all that it started."""
        ...


class Request(msgspec.Struct, frozen=True):
    """What the pool is asked to run: a Python file, its arguments, the folder to run it in.

    clips: those that it will want; frames: how many it was asked for, so that the clips can be resampled ahead.
    ahead: nothing is run, but the pool reads all that ahead as if it had been. others: more that it reads then. kinds:
    of objects, of the workspace in the folder, whose distances are made then; cache: main's XDG_CACHE_HOME, which need
    not be the pool's.
    """

    argv: tuple[str, ...]
    directory: str
    clips: tuple[str, ...] = ()
    frames: int = 0
    ahead: bool = False
    others: tuple[Request, ...] = ()
    kinds: tuple[str, ...] = ()
    cache: str = ""


class Spawned:
    """A child that this process started, by posix_spawn, at the head of a session of its own.

    Raises:
        AlgorithmError: it can't be started; says why.
    """

    def __init__(
        self, argv: Sequence[str], directory: Path, pipes: Pipes, environment: Mapping[str, str] = os.environ
    ) -> None:
        self.pipes = pipes
        program = _find(argv[0], directory)
        actions = [(os.POSIX_SPAWN_DUP2, end, number) for number, end in enumerate(pipes.ends)]
        here = os.open(".", os.O_RDONLY | os.O_CLOEXEC)
        try:
            os.chdir(directory)  # posix_spawn has no other way to say where
            self._pid = os.posix_spawn(
                program, [program, *argv[1:]], environment, file_actions=actions,
                setsid=True, setsigmask=[], setsigdef=[signal.SIGPIPE, signal.SIGINT],
            )  # fmt: skip
        except OSError as error:
            raise AlgorithmError(_cannot_start(program, error)) from None
        finally:
            os.fchdir(here)
            os.close(here)
        pipes.close_ends()
        self._status: int | None = None

    @property
    def pid(self) -> int:
        """As `Child.pid`."""
        return self._pid

    def poll(self) -> int | None:
        """As `Child.poll`."""
        if self._status is None and os.waitid(os.P_PID, self._pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None:
            self.signal(signal.SIGKILL)  # what it left behind, while its number is still its own
            self._status = os.waitstatus_to_exitcode(os.waitpid(self._pid, 0)[1])
        return self._status

    def signal(self, number: int) -> None:
        """As `Child.signal`."""
        if self._status is None:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._pid, number)


class Hired:
    """A child of the pool. Until it has greeted, main keeps its ends of the pipes, so that another may take its place.

    Args:
        connect: gives a connection to the pool.
        request: what to run.
        pipes: given to the child.
        instead: starts the child without the pool, if the pool lets us down twice; given the reason.

    Raises:
        OSError, AlgorithmError: the request could not be sent.
    """

    def __init__(
        self, connect: Callable[[], socket.socket], request: Request, pipes: Pipes, instead: Callable[[str], Spawned]
    ) -> None:
        self.pipes = pipes
        self._connect = connect
        self._request = msgspec.json.encode(request)
        self._tries = 0
        self._instead = instead
        self._own: Spawned | None = None
        self._pid = 0
        self._pidfd = -1
        self._status: int | None = None
        self._silence = Silence()
        self._pool = self._ask()

    @property
    def pid(self) -> int:
        """As `Child.pid`."""
        return self._own.pid if self._own is not None else self._pid

    def poll(self) -> int | None:
        """As `Child.poll`."""
        if self._own is not None:
            return self._own.poll()
        while self._status is None:
            try:
                data, descriptors, _, _ = socket.recv_fds(self._pool, GREETING.size, 1)
            except BlockingIOError:
                if not self._pid and self._silence.lasts(0) > _PATIENCE:
                    self._replace(f"it did not answer within {_PATIENCE:g} s")
                return self._status
            except OSError:
                data, descriptors = b"", []
            if not data:
                return self._lost()
            (number,) = GREETING.unpack(data)
            if self._pid:
                self._end(number)
            else:
                self._pid, self._pidfd = number, descriptors[0]
                self.pipes.close_ends()
        return self._status

    def signal(self, number: int) -> None:
        """As `Child.signal`."""
        if self._own is not None:
            self._own.signal(number)
        elif self._pid and self._status is None and not select.select([self._pidfd], [], [], 0)[0]:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._pid, number)

    def abandon(self) -> None:
        """Give up a child that has not greeted: the pool drops it when it finds nobody here."""
        if self._own is None and not self._pid:
            self.pipes.close_ends()
            self._end(_UNKNOWN)

    def _ask(self) -> socket.socket:
        """Send the request over a new connection."""
        self._tries += 1
        pool = self._connect()
        socket.send_fds(pool, [self._request], list(self.pipes.ends))
        return pool

    def _lost(self) -> int | None:
        """The pool's end is closed."""
        if not self._pid:
            self._replace("it closed the connection")
            return self._status
        if select.select([self._pidfd], [], [], 0)[0]:
            self._end(_UNKNOWN)  # the pool died before it could tell how its child did
        return self._status

    def _replace(self, reason: str) -> None:
        """Try once more, for the pool may just have ended; then go on without it."""
        self._pool.close()
        if self._tries == 1:
            with contextlib.suppress(OSError, AlgorithmError):
                self._pool = self._ask()
                return
        try:
            self._own = self._instead(reason)
        except AlgorithmError as error:
            os.write(self.pipes.ends[2], str(error).encode())  # so that its log says why
            self.pipes.close_ends()
            self._end(_UNKNOWN)

    def _end(self, status: int) -> None:
        """It is over."""
        self._status = status
        self._pool.close()
        if self._pidfd >= 0:
            os.close(self._pidfd)
            self._pidfd = -1


def describe(status: int) -> str:
    """An exit status in words."""
    if status == _UNKNOWN:
        return "it ended"
    if status < 0:
        with contextlib.suppress(ValueError):
            return f"it was killed by {signal.Signals(-status).name}"
        return f"it was killed by signal {-status}"
    return f"it ended with exit code {status}"


def _find(program: str, directory: Path) -> str:
    """A program's path: in its folder, or on the PATH."""
    if program == "python":
        return sys.executable
    own = directory / program
    return str(own.absolute()) if own.exists() or "/" in program else shutil.which(program) or str(own.absolute())


def _cannot_start(program: str, error: OSError) -> str:
    """Why a program did not start, and what to do."""
    reasons = {
        errno.ENOENT: "there is no such program (is it compiled, and is the program that its #! line names there?)",
        errno.EACCES: "it may not be executed (chmod +x)",
        errno.ENOEXEC: "it is no program for this machine (a script needs a #! line)",
    }
    return f"{program} can't be started: {reasons.get(error.errno or 0, error.strerror)}"
