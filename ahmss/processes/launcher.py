"""The launcher: starts algorithms as processes of their own, watches them, and leaves none behind."""

from __future__ import annotations

import contextlib
import os
import select
import sys
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Protocol

import msgspec

from ahmss.algorithm.messages import Start, encode_start
from ahmss.errors import AhmssError
from ahmss.processes.child import Child, Hired, Request, Spawned
from ahmss.processes.deadlines import Deadlines
from ahmss.processes.hire import Pool
from ahmss.processes.process import AlgorithmProcess
from ahmss.processes.stream import Pipes

__all__ = ["Entry", "Launcher"]

_NAP = 0.002  # seconds between looks at a process whose exit status is still to come
_TOGETHER = 16  # programs in one request, which is to be shorter than the pool takes
_GLANCE = 0.05  # seconds between looks at one that says nothing: it may have died, or be past its deadline


class Entry(Protocol):
    """What the launcher needs of an algorithm (the database's AlgorithmEntry has it)."""

    @property
    def name(self) -> str:
        """What messages call it."""
        ...

    @property
    def argv(self) -> tuple[str, ...]:
        """The command; a first word `python` means: from the pool."""
        ...

    @property
    def directory(self) -> Path:
        """Where it is run."""
        ...


class Launcher:
    """The algorithm processes of one main.

        with Launcher(notice=print) as launcher:        # at the end nothing is left running
            process = launcher.start(entry, start)
            process.ask(frame)
            launcher.wait([process], 1 / 60)
            launcher.tend()                             # once a frame

    Args:
        warm: take Python algorithms from the pool; without, each is a new interpreter.
        deadlines: how long processes may take.
        notice: is told, once, why the pool could not be used.
        once: wait no second time for an answer that has not come in the time given: whoever thinks for many frames
            would keep each of them, and a main that is late would never be on time again.
    """

    def __init__(
        self,
        *,
        warm: bool = True,
        deadlines: Deadlines | None = None,
        notice: Callable[[str], None] | None = None,
        once: bool = False,
    ) -> None:
        self._deadlines = deadlines or Deadlines()
        self._notice, self._once = notice, once
        self._processes: list[AlgorithmProcess] = []
        self._pool: Pool | None = None
        if warm:
            try:
                self._pool = Pool()
            except (OSError, AhmssError) as error:
                self._without_pool(str(error))

    def __enter__(self) -> Launcher:
        """Itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close."""
        self.close()

    @property
    def processes(self) -> tuple[AlgorithmProcess, ...]:
        """Those that have not ended yet."""
        return tuple(process for process in self._processes if not process.ended)

    def start(self, entry: Entry, start: Start) -> AlgorithmProcess:
        """Start an algorithm and send it START. Returns at once; its first answer comes when it comes.

        Raises:
            AlgorithmError: there is no such program, or it can't be executed.
        """
        pipes = Pipes.make()
        try:
            child = self._child(entry, start, pipes)
        except BaseException:
            pipes.close()
            raise
        human = start.kind == "human"
        process = AlgorithmProcess(
            entry.name, child, encode_start(start), human=human, frames=start.frames, deadlines=self._deadlines
        )
        self._processes.append(process)
        return process

    def prepare(self, entry: Entry, motion: Path) -> None:
        """Have the pool read a Python algorithm and its motion data, so that its first start is as quick as the others.

        What can't be read is told when it is started.
        """
        script = _script(entry)
        if script is not None:
            self._send(Request(script, str(entry.directory), (str(motion),), ahead=True))

    def expect(self, programs: Iterable[tuple[Entry, Path | None, int]]) -> None:
        """As `prepare`, of all that may be started some time: algorithms, their motion data or None, their frames."""
        requests = [
            Request(script, str(entry.directory), (str(motion),) if motion is not None else (), frames, ahead=True)
            for entry, motion, frames in programs
            if (script := _script(entry)) is not None
        ]
        for first in range(0, len(requests), _TOGETHER):
            self._send(Request((), "", ahead=True, others=tuple(requests[first : first + _TOGETHER])))

    def foresee(self, root: Path, kinds: Iterable[str]) -> None:
        """Have a process of the pool make, as nothing else is to be done, what hands will ask of the shapes of objects.

        Args:
            root: the workspace's folder.
            kinds: of the objects.
        """
        self._send(Request((), str(root), ahead=True, kinds=tuple(kinds), cache=os.environ.get("XDG_CACHE_HOME", "")))

    def _send(self, request: Request) -> None:
        """Ask the pool for what nobody waits for."""
        if self._pool is not None:
            with contextlib.suppress(OSError, AhmssError):
                self._pool.send(msgspec.json.encode(request))

    def wait(self, processes: Iterable[AlgorithmProcess], timeout: float) -> bool:
        """Wait until none of these owes a frame, at most `timeout` seconds; True if so. Logs are read meanwhile.

        With `once`, what was waited for in vain is taken when it has come.
        """
        processes = [process for process in processes if process.pending]
        for process in processes:  # as a rule it is there already: then there is nothing to wait for
            process.collect()
        until = time.monotonic() + timeout
        while owing := [process for process in processes if process.pending and not process.overdue]:
            left = until - time.monotonic()
            if left <= 0.0:
                for process in owing:
                    process.overdue = self._once
                return False
            _look(owing, left)
        return not any(process.pending for process in processes)

    def tend(self) -> None:
        """What is due for any process: logs, deadlines, ends. Once a frame."""
        for process in self._processes:
            process.tend()
        self._processes = [process for process in self._processes if not process.ended]

    def close(self) -> None:
        """End all, politely first, by force after the deadline to stop; return when nothing is left."""
        for process in self._processes:
            process.stop()
        until = time.monotonic() + self._deadlines.stop
        forced = False
        self.tend()
        while self._processes:
            if not forced and time.monotonic() > until:
                forced = True
                for process in self._processes:
                    process.kill()
            time.sleep(_NAP)
            self.tend()
        if self._pool is not None:
            self._pool.close()
            self._pool = None

    def _child(self, entry: Entry, start: Start, pipes: Pipes) -> Child:
        """A process for the entry, from the pool if it is Python."""
        directory, script = entry.directory, _script(entry)
        if script is None:
            return Spawned(entry.argv, directory, pipes)

        def alone(reason: str) -> Spawned:
            self._without_pool(reason)
            return _interpreter(script, directory, pipes)

        if self._pool is None:
            return _interpreter(script, directory, pipes)
        clips = tuple(path for path in (start.motion, start.goal.posture) if path)
        request = Request(script, str(directory), clips, start.frames)
        try:
            return Hired(self._pool.connect, request, pipes, alone)
        except (OSError, AhmssError) as error:
            return alone(str(error))

    def _without_pool(self, reason: str) -> None:
        """Say once that the pool is not there."""
        if self._notice is not None:
            self._notice(f"Python algorithms start more slowly, because the pool can't be used: {reason}")
            self._notice = None


def _script(entry: Entry) -> tuple[str, ...] | None:
    """The Python file of an entry, with its arguments; None if it is no Python algorithm."""
    argv = entry.argv
    if argv[0] != "python" and not argv[0].endswith(".py"):
        return None
    script = argv[1:] if argv[0] == "python" else argv
    return str((entry.directory / script[0]).absolute()), *script[1:]


def _interpreter(script: tuple[str, ...], directory: Path, pipes: Pipes) -> Spawned:
    """A Python algorithm in an interpreter of its own."""
    return Spawned((sys.executable, "-m", "ahmss.processes.worker", *script), directory, pipes)


def _look(owing: list[AlgorithmProcess], timeout: float) -> None:
    """Wait until one of these says something, and take it."""
    poll = select.poll()
    timeout = min(timeout, _GLANCE)
    sources: dict[int, AlgorithmProcess] = {}
    for process in owing:
        if process.silent:
            timeout = min(timeout, _NAP)
        else:
            sources[process.fileno()] = process
        if process.log_fileno >= 0:
            sources[process.log_fileno] = process
    for source in sources:
        poll.register(source, select.POLLIN)
    heard = poll.poll(timeout * 1000.0)
    for source, _ in heard:
        sources[source].collect(log=source != sources[source].fileno())
    if not heard:
        for process in owing:
            process.collect()
