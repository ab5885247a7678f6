"""The pool: a small process that has numpy and the author's modules loaded, and keeps forked workers ready.

    python -m ahmss.processes.pool SOCKET SECONDS        (`hire` starts it, the listening socket as descriptor 3)

Workers take requests from the socket themselves; the pool hears of it, forks the next, reads the program and the clips
ahead for those to come, and tells main how its child ended. One thread, no ZeroMQ. It ends when no main has used it for
so many seconds.
"""

from __future__ import annotations

import contextlib
import gc
import importlib
import os
import select
import signal
import socket
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import msgspec

from ahmss.processes import ahead, worker
from ahmss.processes.child import GREETING, Request
from ahmss.processes.rehearsal import rehearse
from ahmss.processes.runtime import Meeting, code_stamp, sweep
from ahmss.processes.turn import take_long_turns

__all__ = ["main"]

_LISTENER = 3
_READY = 8  # workers forked ahead
_LOOK = 2.0  # seconds between looks at whether the pool is still wanted
_FEW = 2  # waiting workers below which the pool forks at once; else it leaves the processor to those that start
_PAUSE = 0.1  # seconds without a request after which it forks, and learns what the requests named
_GRACE = 1.0  # seconds that a worker may outlive its main
_HEAVY = ("ahmss.motion.resample",)  # it brings scipy
_DEATHS = 20  # workers that may die unasked before the pool gives up
_LARGEST_NOTICE = 1 << 16
_REHEARSED = b"ready"


@dataclass(eq=False)
class _Worker:
    """A forked worker: waiting for a request, or busy with one."""

    pid: int
    pidfd: int
    notice: socket.socket  # here it tells what it has taken
    knowledge: int  # how much the pool had learned when it was forked
    rehearsed: bool = False  # it waits; before that it takes a processor for some hundredths of a second
    main: socket.socket | None = None  # whose child it has become
    retired: bool = False
    orphaned: float | None = None  # when its main was seen to be gone


class _Pool:
    """The loop, and the workers."""

    def __init__(self, listener: socket.socket, meeting: Meeting, linger: float) -> None:
        self._listener = listener
        self._meeting = meeting
        self._linger = linger
        self._stamp = code_stamp()
        self._workers: set[_Worker] = set()
        self._knowledge = 0
        self._deaths = 0
        self._heard: list[bytes] = []  # requests that are still to be learned from
        self._last_request = self._last_used = time.monotonic()
        self._poll = select.epoll()
        self._actions: dict[int, Callable[[], None]] = {}

    def run(self) -> None:
        """Serve until nobody wants it."""
        next_look = 0.0
        self._fill()
        self._read_ahead()
        while self._deaths < _DEATHS:
            ready = [descriptor for descriptor, _ in self._poll.poll(self._patience())]
            for descriptor, action in [(descriptor, self._actions.get(descriptor)) for descriptor in ready]:
                # One that was closed by an action before may be another one's number already.
                if action is not None and self._actions.get(descriptor) is action:
                    action()
            now = time.monotonic()
            self._end_orphans(now)
            if now - self._last_request > _PAUSE or len(self._waiting()) < _FEW:
                self._learn()
                self._fill()
                self._retire_ignorant()
            if now > next_look:
                next_look = now + _LOOK
                if not self._wanted(now):
                    break
        self._close()

    def _read_ahead(self) -> None:
        """Load what takes long to load and most algorithms want, once there are workers that do without; tidy up."""
        for name in _HEAVY:
            importlib.import_module(name)
        self._knowledge += 1
        gc.freeze()
        sweep(self._meeting.socket.parent)

    def _patience(self) -> float:
        """Seconds until something may be due."""
        short = self._heard or self._ignorant() or len(self._waiting()) < _READY
        if short or any(w.orphaned is not None for w in self._workers):
            return _PAUSE
        return min(_LOOK, self._linger)

    # --- workers ------------------------------------------------------------------------------------------------------

    def _waiting(self) -> list[_Worker]:
        """The workers that could take a request."""
        return [w for w in self._workers if w.main is None and not w.retired]

    def _ignorant(self) -> list[_Worker]:
        """Those waiting that were forked before the pool learned what it knows now."""
        return [w for w in self._waiting() if w.knowledge < self._knowledge]

    def _fill(self) -> None:
        """Fork until enough are waiting: all at once where none is ready, else one after the other.

        The motions that are under way want the processors.
        """
        waiting = self._waiting()
        ready = sum(w.rehearsed for w in waiting)
        for _ in range(min(_READY - len(waiting), 1 - (len(waiting) - ready) if ready else _READY)):
            self._fork()

    def _fork(self) -> None:
        """One more worker."""
        ours, its = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        pid = os.fork()
        if pid == 0:
            _be_worker(its.detach())
        its.close()
        ours.setblocking(False)
        member = _Worker(pid, os.pidfd_open(pid), ours, self._knowledge)
        self._workers.add(member)
        self._watch(ours.fileno(), lambda: self._hear(member))
        self._watch(member.pidfd, lambda: self._bury(member))

    def _hear(self, member: _Worker) -> None:
        """A worker tells that it is ready, or what it has taken: remember whose child it is, learn for others."""
        data, descriptors = _REHEARSED, list[int]()
        while data == _REHEARSED:
            try:
                data, descriptors, _, _ = socket.recv_fds(member.notice, _LARGEST_NOTICE, 1)
            except BlockingIOError:
                return
            except OSError:
                data, descriptors = b"", []
            member.rehearsed |= data == _REHEARSED
        if not data or not descriptors:
            self._forget(member.notice.fileno())
            return
        member.main = socket.socket(fileno=descriptors[0])
        member.main.setblocking(False)
        self._watch(member.main.fileno(), lambda: self._orphan(member))
        self._last_request = time.monotonic()
        self._deaths = 0
        self._heard.append(data)

    def _learn(self) -> None:
        """Take in what the requests named, for the workers to come."""
        news = False
        while self._heard:
            news |= ahead.learn(msgspec.json.decode(self._heard.pop(), type=Request))
        if news:
            self._knowledge += 1
            gc.freeze()

    def _orphan(self, member: _Worker) -> None:
        """A main has closed its connection: its child has a moment to see that by itself."""
        if member.main is not None:
            self._forget(member.main.fileno())
            member.orphaned = time.monotonic()

    def _end_orphans(self, now: float) -> None:
        """Kill the children of mains that are gone."""
        for member in self._workers:
            if member.orphaned is not None and now - member.orphaned > _GRACE:
                _kill_group(member.pid)

    def _bury(self, member: _Worker) -> None:
        """A worker has ended: end what it started, and tell its main how it did."""
        self._hear(member)
        if member.main is not None:
            _kill_group(member.pid)
        status = os.waitstatus_to_exitcode(os.waitpid(member.pid, 0)[1])
        if member.main is not None:
            with contextlib.suppress(OSError):
                member.main.send(GREETING.pack(status))
            self._forget(member.main.fileno())
            member.main.close()
        elif not member.retired:
            self._deaths += 1
        self._forget(member.pidfd)
        os.close(member.pidfd)
        self._forget(member.notice.fileno())
        member.notice.close()
        self._workers.discard(member)

    def _retire_ignorant(self) -> None:
        """Let one go that knows less than the pool does, where all are ready; `_fill` forks another."""
        waiting, ignorant = self._waiting(), self._ignorant()
        if ignorant and len(waiting) == _READY and all(w.rehearsed for w in waiting):
            self._retire(ignorant[0])

    def _retire(self, member: _Worker) -> None:
        """Tell a waiting worker to end. One that takes a request at this moment still does it."""
        member.retired = True
        with contextlib.suppress(OSError):
            member.notice.send(b"end")

    # --- the pool itself ----------------------------------------------------------------------------------------------

    def _wanted(self, now: float) -> bool:
        """Whether to go on: somebody uses it, or did until lately, and it is still the code that is on the disk."""
        if any(w.main is not None for w in self._workers):
            self._last_used = now
            return True
        if not self._meeting.socket.exists() or code_stamp() != self._stamp:
            return False
        if not self._meeting.unused():
            self._last_used = now
        return now - self._last_used < self._linger

    def _close(self) -> None:
        """End. Who connects from here on makes a new pool."""
        lock = self._meeting.lock()
        self._meeting.clear()
        self._listener.shutdown(socket.SHUT_RDWR)
        self._meeting.remove()
        os.close(lock)
        for member in self._workers:
            member.notice.close()

    def _watch(self, descriptor: int, action: Callable[[], None]) -> None:
        """Call `action` when there is something to read."""
        self._actions[descriptor] = action
        self._poll.register(descriptor, select.EPOLLIN)

    def _forget(self, descriptor: int) -> None:
        """Undo `_watch`; twice is once."""
        if self._actions.pop(descriptor, None) is not None:
            self._poll.unregister(descriptor)


def _be_worker(notice: int) -> None:
    """In the child: a session of its own, no descriptor but the listener and the line to the pool. Does not return."""
    try:
        os.setsid()
        take_long_turns()
        os.dup2(notice, _LISTENER + 1)
        os.closerange(_LISTENER + 2, 1 << 16)
        gc.enable()
        rehearse()
        pool = socket.socket(fileno=_LISTENER + 1)
        pool.send(_REHEARSED)  # where the pool is gone this raises, and the worker ends
        worker.serve(socket.socket(fileno=_LISTENER), pool)
    finally:
        os._exit(1)


def _kill_group(pid: int) -> None:
    """Kill a process that is not reaped yet, and what it started."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(pid, signal.SIGKILL)


def main() -> None:
    """Be the pool of the socket named on the command line."""
    path = Path(sys.argv[1])
    listener = socket.socket(fileno=_LISTENER)
    listener.setblocking(False)
    os.set_inheritable(_LISTENER, False)
    gc.disable()
    gc.freeze()
    _Pool(listener, Meeting(path.parent, path.stem.removeprefix("pool-")), float(sys.argv[2])).run()


if __name__ == "__main__":
    main()
