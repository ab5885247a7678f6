"""`run`: an author's function as an algorithm process, over standard input and output."""

from __future__ import annotations

import contextlib
import os
import sys
import sysconfig
import traceback
from pathlib import Path
from typing import NoReturn

import msgspec
import numpy as np

from ahmss.algorithm.messages import (
    HEADER,
    MAX_PAYLOAD,
    Kind,
    Ready,
    State,
    decode_start,
    encode,
    encode_meant,
    encode_state,
)
from ahmss.algorithm.performance import Function, Performance
from ahmss.body.array import Array
from ahmss.errors import AhmssError, AlgorithmError, ProtocolError

__all__ = ["Channel", "report", "run", "serve", "take_standard_output"]

_FIRST = 3  # the header starts here in the buffer, so that the payload behind it is aligned to 8 bytes
_PAYLOAD = _FIRST + HEADER.size
_OUTPUT: list[int] = []  # the descriptor that standard output had before it was moved


def take_standard_output() -> int:
    """Move standard output to standard error, and return the descriptor that leads to main. Doing it twice is once.

    From here on a stray `print` goes to the log.
    """
    if not _OUTPUT:
        if sys.stdout is not None:
            sys.stdout.flush()
        _OUTPUT.append(os.dup(1))
        os.dup2(2, 1)
        reconfigure = getattr(sys.stdout, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(line_buffering=True)
    return _OUTPUT[0]


class Channel:
    """The algorithm's end of the pipes: blocking, one message at a time."""

    def __init__(self, source: int, sink: int) -> None:
        self.source = source
        self.sink = sink
        self._buffer = bytearray(1 << 16)
        self._filled = _FIRST

    def read(self) -> tuple[int, memoryview] | None:
        """The next message's kind and payload, valid until the next read; None when main has closed the pipe.

        Raises:
            ProtocolError: a message larger than allowed.
        """
        if not self._fill(_PAYLOAD):
            return None
        length, kind = HEADER.unpack_from(self._buffer, _FIRST)
        if length > MAX_PAYLOAD:
            raise ProtocolError(f"a message of {length} bytes is larger than the {MAX_PAYLOAD} allowed")
        end = _PAYLOAD + length
        if not self._fill(end):
            return None
        payload = memoryview(self._buffer)[_PAYLOAD:end]
        if self._filled > end:  # main wrote ahead: keep what follows for the next read
            payload = memoryview(bytes(payload))
            self._buffer[_FIRST : _FIRST + self._filled - end] = self._buffer[end : self._filled]
        self._filled += _FIRST - end
        return kind, payload

    def write(self, *parts: bytes | memoryview) -> None:
        """Send parts in one go, all of them."""
        left = sum(len(part) for part in parts)
        sent = os.writev(self.sink, parts)
        if sent < left:
            rest = memoryview(b"".join(parts))[sent:]
            while rest:
                rest = rest[os.write(self.sink, rest) :]

    def _fill(self, end: int) -> bool:
        """Read until the buffer holds `end` bytes; False at the end of the input."""
        if end > len(self._buffer):
            self._buffer = self._buffer + bytearray(end - len(self._buffer))
        while self._filled < end:
            count = os.readv(self.source, [memoryview(self._buffer)[self._filled :]])
            if count == 0:
                return False
            self._filled += count
        return True


def run(function: Function) -> NoReturn:
    """Be an algorithm process: play `function` for main until its motion is over or main stops it. Does not return.

    Standard output is moved to standard error first. An exception of the function goes to standard error with its
    traceback, to main as one line, and ends the process with exit code 1.
    """
    if os.isatty(0):
        sys.exit("This is an algorithm: main starts it. To try it by hand, see docs/writing-an-algorithm.md.")
    channel = Channel(0, take_standard_output())
    status = 0
    try:
        serve(function, channel)
    except BrokenPipeError:
        pass  # main is gone, and with it whoever wanted poses
    except Exception as error:  # noqa: BLE001 - whatever an author's code raises, main is told
        status = 1
        report(channel, error)
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


def report(channel: Channel, error: Exception) -> None:
    """An exception: one line to main; its traceback to standard error, unless the author refuses in so many words."""
    if not isinstance(error, AlgorithmError):
        traceback.print_exception(error)
    with contextlib.suppress(BrokenPipeError):
        channel.write(encode(Kind.ERROR, _line(error).encode()[:4096]))


def serve(function: Function, channel: Channel) -> None:
    """START, then each FRAME, until STOP, the end of the input, or the motion's end.

    Raises:
        ProtocolError: main broke the protocol. Whatever the function raises.
    """
    message = channel.read()
    if message is None:
        return
    if message[0] != Kind.START:
        raise ProtocolError(f"the first message is of kind {message[0]}, not START")
    performance = Performance(function, decode_start(message[1]))
    channel.write(encode(Kind.READY, msgspec.json.encode(Ready())))
    kind = Kind.POSE if performance.task.message.kind == "human" else Kind.OBJECT
    try:
        while (message := channel.read()) is not None and message[0] != Kind.STOP:
            if message[0] == Kind.REST:
                performance.task.progress.rests = True
                continue
            if message[0] == Kind.CLOSED:
                performance.task.progress.closed = True
                continue
            if message[0] != Kind.FRAME:
                raise ProtocolError(f"a message of kind {message[0]} where FRAME or STOP was expected")
            if not performance.step(_numbers(message[1])):
                channel.write(*_news(performance), encode(Kind.DONE))
                return
            _answer(channel, performance, kind)
            if performance.over:
                return
    except Exception:
        if news := _news(performance):
            channel.write(*news)
        raise
    finally:
        performance.close()


def _numbers(payload: memoryview) -> Array:
    """A block's numbers, as a view."""
    if len(payload) % 8:
        raise ProtocolError(f"FRAME is {len(payload)} bytes long, which is no number of float64")
    return np.frombuffer(payload, "<f8")


def _answer(channel: Channel, performance: Performance, kind: Kind) -> None:
    """Send what changed and what is noted, the pose, and DONE behind the last one, all in one write."""
    row = performance.row
    parts = [*_news(performance), HEADER.pack(row.nbytes, kind), row.data.cast("B")]
    if performance.states and performance.task.object is not None:
        parts.insert(0, encode_state(State(performance.task.object.id, dict(performance.states))))
    if performance.over:
        parts.append(encode(Kind.DONE))
    channel.write(*parts)


def _news(performance: Performance) -> list[bytes | memoryview]:
    """The messages of what the function has noted, what it is to bring about, and that it is where it acts."""
    news: list[bytes | memoryview] = [encode(Kind.NOTE, text.encode()[:4096]) for text in performance.news()]
    if meant := performance.meant():
        news.append(encode_meant(meant))
    if performance.arrived():
        news.append(encode(Kind.ARRIVED))
    return news


def _line(error: Exception) -> str:
    """An exception in one line, with the author's line where it came from."""
    text = str(error).strip().splitlines()[0] if str(error).strip() else ""
    if isinstance(error, AlgorithmError) and text:
        return text
    name = "" if isinstance(error, AhmssError) else type(error).__name__
    own = Path(__file__).parent
    libraries = [Path(sysconfig.get_path(kind)) for kind in ("stdlib", "purelib", "platlib")]
    for place in reversed(traceback.extract_tb(error.__traceback__)):
        file = Path(place.filename)
        if file.parent != own and not any(file.is_relative_to(library) for library in libraries):
            return ": ".join(part for part in (name, text) if part) + f" ({file.name}:{place.lineno})"
    return ": ".join(part for part in (name, text) if part)
