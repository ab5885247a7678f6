"""A worker: the process that becomes a Python algorithm, forked ahead by the pool or, without one, started alone.

`python -m ahmss.processes.worker nod.py` is the latter.
"""

from __future__ import annotations

import contextlib
import os
import select
import signal
import socket
import sys
import types
from pathlib import Path
from typing import NoReturn

import msgspec

from ahmss.algorithm import cache
from ahmss.algorithm.author import Channel, report, take_standard_output
from ahmss.processes.child import GREETING, Request
from ahmss.processes.hire import same_user

__all__ = ["become", "serve"]

_LARGEST_REQUEST = 1 << 16
_PATIENCE = 5.0  # seconds that a main may take to say what it wants, once connected


def become(argv: tuple[str, ...], directory: str) -> NoReturn:
    """Run a Python file as the main program, over descriptors 0, 1 and 2. Does not return."""
    output = take_standard_output()
    script = argv[0]
    status = 0
    try:
        os.chdir(directory)
        sys.argv = list(argv)
        sys.path[0] = os.path.dirname(script)
        program = types.ModuleType("__main__")
        program.__file__ = script
        sys.modules["__main__"] = program
        exec(cache.code(script), program.__dict__)
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else int(end.code is not None)
        if isinstance(end.code, str):
            print(end.code, file=sys.stderr)
    except Exception as error:  # noqa: BLE001 - whatever an author's code raises, main is told
        status = 1
        report(Channel(0, output), error)
    with contextlib.suppress(OSError):
        sys.stdout.flush()
        sys.stderr.flush()
    os._exit(status)


def serve(listener: socket.socket, pool: socket.socket) -> NoReturn:
    """Wait for a request at the pool's socket, and become what it asks for. Ends when the pool says so or is gone.

    Args:
        listener: the pool's, non-blocking, shared by all workers.
        pool: to the pool itself: told what was taken, with the connection, so that main hears how it ends.
    """
    own = os.pidfd_open(os.getpid())
    events = select.epoll()
    events.register(listener.fileno(), select.EPOLLIN | select.EPOLLEXCLUSIVE)  # one request wakes one worker
    events.register(pool.fileno(), select.EPOLLIN)
    while True:
        ready = {descriptor for descriptor, _ in events.poll()}
        if pool.fileno() in ready:  # first: a listener whose pool is gone stays readable for ever
            os._exit(0)
        if listener.fileno() in ready:
            with contextlib.suppress(OSError, msgspec.MsgspecError, ValueError):
                taken = _take(listener, pool, own)
                if taken is not None:
                    if taken.ahead:
                        _foresee(taken)  # the pool has been told what it is to read
                    events.close()
                    os.closerange(3, 1 << 16)
                    become(taken.argv, taken.directory)


def _foresee(request: Request) -> NoReturn:
    """Make what will be asked for, so that it is there then. Does not return."""
    if request.kinds:
        from ahmss.processes.foresight import make_fields  # it brings the databases, which no motion needs

        os.environ["XDG_CACHE_HOME"] = request.cache
        with contextlib.suppress(Exception):
            make_fields(Path(request.directory), request.kinds)
    os._exit(0)


def _take(listener: socket.socket, pool: socket.socket, own: int) -> Request | None:
    """Accept one request and put its pipes in place; None if it was none, or its main has given up."""
    try:
        connection, _ = listener.accept()
    except BlockingIOError:
        return None  # a sibling was quicker
    except OSError:
        os._exit(0)  # the listener is shut: the pool has ended
    with connection:
        connection.settimeout(_PATIENCE)
        if not same_user(connection):
            return None
        data, descriptors, _, _ = socket.recv_fds(connection, _LARGEST_REQUEST, 3)
        try:
            request = msgspec.json.decode(data, type=Request)
            if len(descriptors) != 3:
                return None
            _tell(pool, data, connection)
            _greet(connection, own)
            for number, descriptor in enumerate(descriptors):
                os.dup2(descriptor, number)
        finally:
            for descriptor in descriptors:
                os.close(descriptor)
    return request


def _tell(pool: socket.socket, data: bytes, connection: socket.socket) -> None:
    """Tell the pool what was taken. Without a pool nobody would see to the child's end: then this ends instead."""
    try:
        socket.send_fds(pool, [data], [connection.fileno()])
    except OSError:
        os._exit(0)


def _greet(connection: socket.socket, own: int) -> None:
    """Tell main who works for it. Where that main is gone this ends: to the pool it is that one's, and no other's."""
    try:
        socket.send_fds(connection, [GREETING.pack(os.getpid())], [own])
    except OSError:
        os._exit(0)


def _alone() -> NoReturn:
    """Be the worker of one file, named on the command line."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    become(tuple(sys.argv[1:]), os.getcwd())


if __name__ == "__main__":
    _alone()
