"""One running algorithm process, as main sees it: it is asked for frames and gives poses, or a reason why not."""

from __future__ import annotations

import os
import struct
from collections import deque

from ahmss.algorithm.messages import HEADER, Kind, decode_meant, decode_ready, decode_state, encode
from ahmss.errors import AlgorithmError, ProtocolError
from ahmss.processes.answers import Answer, Arrived, Done, Message, Note, Phase
from ahmss.processes.child import Child, describe
from ahmss.processes.deadlines import Deadlines
from ahmss.processes.ending import Ending
from ahmss.processes.rows import OF_HUMAN, OF_OBJECT
from ahmss.processes.silence import Silence
from ahmss.processes.stream import Inbound, Log, Outbound

__all__ = ["AlgorithmProcess"]

_FRAME_NUMBER = struct.Struct("<d")
_STOP, _REST, _CLOSED = encode(Kind.STOP), encode(Kind.REST), encode(Kind.CLOSED)
_END_PATIENCE = 0.2  # seconds that an exit status may come after the end of the output
_LOG_EACH = 8  # times that it is tended, to one look at its log
_LONGEST_LINE = 4096  # bytes of a text that are read
_MOST_NOTES = 20  # that one process may tell


class AlgorithmProcess:
    """A motion being made. Nothing here blocks; `Launcher.start` makes it.

        process.ask(encode_frame(...))
        launcher.wait([process], 0.016)
        for message in process.receive(): ...      # Answer, State, Note ...; raises AlgorithmError once

    name: the algorithm's. human: whether it moves the human. phase: see Phase. pending: the frame asked for and not
    yet answered, or 0. overdue: it was waited for, and is not again. last: the last frame answered. failure: the
    AlgorithmError that ended it, or None. ended: its process is gone and nothing of it is left.

    Args:
        name: of the algorithm.
        child: its process.
        start: the START message.
        human: whether it moves the human; an object algorithm goes on until stopped.
        frames: how many it is to make of the human; 0: until it says that it is done.
        deadlines: how long it may take.
    """

    def __init__(
        self, name: str, child: Child, start: bytes, *, human: bool, frames: int, deadlines: Deadlines
    ) -> None:
        self.name = name
        self.human = human
        self.phase = Phase.STARTING
        self.pending = 0
        self.overdue = False
        self.last = 0
        self.failure: AlgorithmError | None = None
        self.ended = False
        self._frames = frames if human else 0
        self._told = False
        self._tended = 0
        self._child = child
        self._deadlines = deadlines
        self._rows = OF_HUMAN if human else OF_OBJECT
        self._outbound = Outbound(child.pipes.input)
        self._inbound = Inbound(child.pipes.output)
        self._log = Log(child.pipes.error)
        self._inbox: deque[Message] = deque()
        self._notes: set[str] = set()
        self._silence = Silence()
        self._closing = False  # its output was seen to have ended
        self._end = Ending(child, self._outbound, deadlines.stop)
        self._outbound.send(start)

    @property
    def active(self) -> bool:
        """Whether it still makes its motion."""
        return self.phase in (Phase.STARTING, Phase.RUNNING)

    def fileno(self) -> int:
        """Readable when there is something to receive; -1 once it has ended."""
        return -1 if self.ended else self._inbound.source

    @property
    def log_fileno(self) -> int:
        """Readable when it has written to its standard error; -1 when that is over."""
        return -1 if self.ended or self._log.over else self._log.source

    def ask(self, frame: bytes) -> None:
        """Send a FRAME message (see `encode_frame`); the answer comes by `receive`.

        A process that is over takes it without a word: `phase` and `receive` say so.

        Raises:
            ValueError: the frame asked for before is not answered yet.
        """
        if not self.active:
            return
        if self.pending:
            raise ValueError(f"{self.name} still owes frame {self.pending}")
        self.pending, self.overdue = int(_FRAME_NUMBER.unpack_from(frame, HEADER.size)[0]), False
        if self.phase is Phase.RUNNING:
            self._silence.begin()
        self._outbound.send(frame)

    @property
    def silent(self) -> bool:
        """Whether its output has ended."""
        return self._inbound.over

    def collect(self, *, log: bool = False) -> None:
        """Read what is there: messages, or (`log`) its standard error. Called by the launcher while it waits."""
        if log and not self.ended:
            self._log.drain()
        elif self.active:
            self._read()
            self._watch()

    def receive(self) -> list[Message]:
        """What has come since the last call, in order.

        Raises:
            AlgorithmError: it crashed, fell silent, or sent what the protocol forbids. Raised once; it is being ended.
        """
        if not self._inbox:
            self.collect()
        if self._inbox:
            messages = list(self._inbox)
            self._inbox.clear()
            return messages
        if self.failure is not None and not self._told:
            self._told = True
            raise self.failure
        return []

    def rest(self) -> None:
        """Ask it to bring its motion to rest, and then to say that it is done: only of one that can."""
        if self.active:
            self._outbound.send(_REST)

    def closed(self) -> None:
        """Tell it that in the frame it is asked for next the hand has closed: only an algorithm that is to know."""
        if self.active:
            self._outbound.send(_CLOSED)

    def stop(self) -> None:
        """Ask it to end: STOP and the end of its input now, SIGTERM and SIGKILL later where that does not help."""
        if self.active:
            self.phase = Phase.STOPPED
            self._outbound.send(_STOP)
            self._finish(self._deadlines.stop)

    def fail(self, reason: str, said: str = "") -> None:
        """Give it up for a reason (a clause, such as "it gave no frame for a second"); `receive` will raise it.

        said: the reason where it is the algorithm's own.
        """
        if not self.active:
            return
        self._log.drain()
        where = f" at frame {self.pending or self.last}" if self.pending or self.last else ""
        last = self._log.last_line()
        same = last.split("Error: ", 1)[-1] in reason  # a traceback ends with the reason itself
        log = f'; its log ends with "{last}"' if last and not same else ""
        self.failure = AlgorithmError(f"algorithm {self.name}{where}: {reason}{log}", said and said + log)
        self.phase = Phase.FAILED
        self.pending = 0  # nobody need wait for it
        self._finish(0.0)

    def stderr_tail(self) -> str:
        """The last of what it wrote to its standard error."""
        if not self.ended:
            self._log.drain()
        return self._log.text()

    def tend(self) -> None:
        """What is due: unsent bytes, its log, deadlines, its end. Called by the launcher."""
        if self.ended:
            return
        if self.active:
            if not self._outbound.empty:
                self._outbound.flush()
            if not self.pending:  # else who asked waits for the answer and reads it
                self._read()
            self._watch()
        if self.ended:  # it was read to its end just now
            return
        self._tended += 1
        if not self._log.over and (self._tended % _LOG_EACH == 0 or not self.active):
            self._log.drain()
        if not self.active:
            self._bury()

    def kill(self) -> None:
        """End it by force, now. `tend` still has to see it off."""
        self.stop()
        self._end.kill()

    # --- reading ------------------------------------------------------------------------------------------------------

    def _read(self) -> None:
        """Take the messages that are there."""
        try:
            for kind, payload in self._inbound.read():
                self._take(kind, payload)
                if not self.active:
                    return
        except ProtocolError as error:
            self.fail(str(error))

    def _take(self, kind: int, payload: memoryview) -> None:
        """One message from the algorithm."""
        if kind == self._rows.kind:
            self._answer(payload)
        elif kind == Kind.STATE:
            self._inbox.append(decode_state(payload))
        elif kind == Kind.READY:
            decode_ready(payload)
            self._greeted()
        elif kind == Kind.DONE:
            self._done()
        elif kind == Kind.ARRIVED:
            self._inbox.append(Arrived())
        elif kind == Kind.MEANT:
            self._inbox.append(decode_meant(payload))
        elif kind == Kind.NOTE:
            self._note(_line(payload))
        elif kind == Kind.ERROR:
            said = _line(payload)
            self.fail(said or "it failed without saying why", said)
        else:
            allowed = f"READY, {self._rows.kind.name}, STATE, NOTE, ARRIVED, MEANT, DONE and ERROR"
            hint = "does it print to its standard output?"
            raise ProtocolError(f"it sent a message of kind {kind}; {allowed} are allowed ({hint})")

    def _answer(self, payload: memoryview) -> None:
        """A POSE or OBJECT."""
        row = self._rows.read(payload, self.pending)
        if self.phase is Phase.STARTING:  # READY is a courtesy: a pose says as much
            self._greeted()
        self.last, self.pending = self.pending, 0
        self._inbox.append(Answer(self.last, row))

    def _note(self, text: str) -> None:
        """Something to tell; what says the same again, or too much, is not told."""
        if text and text not in self._notes and len(self._notes) < _MOST_NOTES:
            self._notes.add(text)
            self._inbox.append(Note(text))

    def _greeted(self) -> None:
        """It has spoken: from here on each frame has its own deadline."""
        self.phase = Phase.RUNNING
        self._silence.begin()
        self._child.poll()

    def _done(self) -> None:
        """Its motion is over."""
        self._inbox.append(Done(self.last))
        self.pending = 0
        self.phase = Phase.DONE
        self._finish(self._deadlines.stop)

    def _watch(self) -> None:
        """Deadlines, and a process that has died or closed its output."""
        if self._inbound.over:
            if not self._closing:
                self._closing = True
                self._silence.begin()
            if self._frames and self.last == self._frames:
                self._done()
            elif not self._died() and self._lasts() > _END_PATIENCE:
                self.fail("it closed its standard output before its motion was over")
        elif self.phase is Phase.STARTING:
            if not self._died() and self._lasts() > self._deadlines.start:
                self.fail(f"it did not answer within {self._deadlines.start:g} s of its start")
        elif self.pending and self._silence.due and not self._died():  # what it started may hold its output open
            self._give_up_late()

    def _lasts(self) -> float:
        """Seconds of its own that it has been silent for."""
        return self._silence.lasts(self._child.pid)

    def _give_up_late(self) -> None:
        """Give it up when its frame is overdue."""
        allowed = self._deadlines.frame if self.last else max(self._deadlines.first, self._deadlines.frame)
        if self._lasts() > allowed:
            self.fail(f"it gave no pose within {allowed:g} s")

    def _died(self) -> bool:
        """Whether its process is gone; then its last words count, and if there are none, how it ended."""
        status = self._child.poll()
        if status is not None:
            self._read()
            if self.active:
                self.fail(f"{describe(status)} before its motion was over")
        return status is not None

    # --- its end ------------------------------------------------------------------------------------------------------

    def _finish(self, patience: float) -> None:
        """Let it end by itself for so many seconds, then by signals."""
        self._end.begin(patience)
        self._bury()

    def _bury(self) -> None:
        """Press it to end, and close all when it has."""
        if self._end.press():
            self._close()

    def _close(self) -> None:
        """Nothing of it is left."""
        self._log.drain()
        self._outbound.close()
        os.close(self._inbound.source)
        os.close(self._log.source)
        self.ended = True


def _line(payload: memoryview) -> str:
    """A text in one line."""
    return " ".join(bytes(payload[:_LONGEST_LINE]).decode(errors="replace").split())
