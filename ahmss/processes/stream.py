"""Messages over pipes that never block: main's ends of an algorithm's standard input, output and error."""

from __future__ import annotations

import contextlib
import fcntl
import os
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

from ahmss.algorithm.messages import HEADER, MAX_PAYLOAD
from ahmss.errors import ProtocolError

__all__ = ["Inbound", "Log", "Outbound", "Pipes"]

_READ = 1 << 16
_PIPE = 1 << 18  # START and a burst of log lines fit without waiting
_KEPT = 1 << 14  # bytes of log that are remembered


@dataclass
class Pipes:
    """Three pipes: `input`, `output`, `error` are main's ends, `ends` the child's, as its descriptors 0, 1, 2."""

    input: int
    output: int
    error: int
    ends: tuple[int, ...]

    @classmethod
    def make(cls) -> Pipes:
        """New pipes, main's ends non-blocking, none inherited by chance."""
        (from_main, to_child), (output, stdout), (error, stderr) = os.pipe(), os.pipe(), os.pipe()
        for end in (to_child, output, error):
            os.set_blocking(end, False)
        if hasattr(fcntl, "F_SETPIPE_SZ"):
            for end in (to_child, error):
                with contextlib.suppress(OSError):  # over the user's limit: then the pipes stay small
                    fcntl.fcntl(end, fcntl.F_SETPIPE_SZ, _PIPE)
        return cls(to_child, output, error, (from_main, stdout, stderr))

    def close(self) -> None:
        """Close all, where no child came of it."""
        self.close_ends()
        for end in (self.input, self.output, self.error):
            os.close(end)

    def close_ends(self) -> None:
        """Forget the child's ends, once it has them."""
        for end in self.ends:
            os.close(end)
        self.ends = ()


class Inbound:
    """Messages from a non-blocking descriptor. `over`: nothing more will come."""

    def __init__(self, source: int) -> None:
        self.source = source
        self.over = False
        self._rest = b""
        self._wanted = 0  # bytes of the message that has begun

    def read(self) -> Iterator[tuple[int, memoryview]]:
        """Each whole message that is there: kind and payload.

        Raises:
            ProtocolError: a message larger than allowed, or one that breaks off at the end.
        """
        if self.over or not self._more():
            return
        view, at = memoryview(self._rest), 0
        while len(view) - at >= HEADER.size:
            length, kind = HEADER.unpack_from(view, at)
            if length > MAX_PAYLOAD:
                hint = "does it print to its standard output?"
                raise ProtocolError(f"it sent a message that would be {length} bytes long ({hint})")
            end = at + HEADER.size + length
            if end > len(view):
                break
            yield kind, view[at + HEADER.size : end]
            at = end
        self._rest = self._rest[at:] if at else self._rest

    def _more(self) -> bool:
        """Read what is there; False if nothing is."""
        parts = [self._rest] if self._rest else []
        count = 0
        with contextlib.suppress(BlockingIOError):
            while count < MAX_PAYLOAD:
                part = os.read(self.source, _READ)
                self.over = not part
                parts.append(part)
                count += len(part)
                if len(part) < _READ:
                    break
        if count:
            self._rest = parts[0] if len(parts) == 1 else b"".join(parts)
        return count > 0


class Outbound:
    """Bytes to a non-blocking descriptor, kept while the pipe is full."""

    def __init__(self, sink: int) -> None:
        self.sink = sink
        self._backlog: deque[memoryview] = deque()

    @property
    def empty(self) -> bool:
        """Whether all has been written."""
        return not self._backlog

    def send(self, message: bytes) -> None:
        """Write a message, or as much as fits; `flush` writes the rest. A reader that is gone takes nothing."""
        if self._backlog:
            self._backlog.append(memoryview(message))
            self.flush()
            return
        with contextlib.suppress(BlockingIOError, BrokenPipeError):
            sent = os.write(self.sink, message)
            if sent == len(message):
                return
            self._backlog.append(memoryview(message)[sent:])
            return
        self._backlog.append(memoryview(message))

    def flush(self) -> None:
        """Write what was kept."""
        try:
            while self._backlog:
                sent = os.write(self.sink, self._backlog[0])
                self._backlog[0] = self._backlog[0][sent:]
                if not self._backlog[0]:
                    self._backlog.popleft()
        except BlockingIOError:
            return
        except BrokenPipeError:
            self._backlog.clear()  # its output will say how it ended

    def close(self) -> None:
        """Let the reader see the end; what was kept is lost."""
        self._backlog.clear()
        if self.sink >= 0:
            os.close(self.sink)
            self.sink = -1


class Log:
    """The last of an algorithm's standard error."""

    def __init__(self, source: int) -> None:
        self.source = source
        self.over = False
        self._kept = bytearray()

    def drain(self) -> None:
        """Take what is there, a pipe's worth at most, so that the writer isn't held up and neither is main."""
        with contextlib.suppress(BlockingIOError):
            for _ in range(_PIPE // _READ):
                part = os.read(self.source, _READ)
                self.over = not part
                self._kept += part
                if len(self._kept) > _KEPT:
                    del self._kept[:-_KEPT]
                if len(part) < _READ:
                    return

    def text(self) -> str:
        """All that is remembered."""
        return self._kept.decode(errors="replace")

    def last_line(self) -> str:
        """The last line that says something, shortened, without control characters; empty if there is none."""
        lines = [line.strip() for line in self.text().splitlines() if line.strip()]
        line = "".join(c if c.isprintable() else " " for c in lines[-1]) if lines else ""
        return line if len(line) <= 200 else line[:200] + " ..."
