"""The virtual-space server: what it is made of, and who is answered what.

Two kinds of it serve: in real time (realtime.py) frames and requests are carried out as they come, and the world ticks
by the clock; in lockstep (lockstep.py) they wait until every main has spoken, and it ticks when all have delivered.
"""

from __future__ import annotations

import math
import time
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import msgspec
import zmq

from ahmss.errors import ProtocolError, WorldError
from ahmss.world import schema
from ahmss.world.address import Address
from ahmss.world.assets import Assets
from ahmss.world.changes import Changes
from ahmss.world.intake import Intake, UnknownHuman
from ahmss.world.journal import Journal
from ahmss.world.keys import ServerKeys
from ahmss.world.meeting import Meetings
from ahmss.world.publisher import Publisher
from ahmss.world.schema import Reply, Request
from ahmss.world.sessions import Session, Sessions
from ahmss.world.sockets import Sockets
from ahmss.world.space import Space

__all__ = ["Server", "Settings"]

_LEASES_S = 0.25
_COMPLAINTS_S = 60.0
_STATS = 4096


@dataclass(frozen=True)
class Settings:
    """How a server runs.

    Args:
        address: where it listens; beyond loopback only with keys. Port 0: the system chooses.
        rate: ticks a second.
        lockstep: names of the humans of a run that waits for each of them; empty: real time.
        directory: where journal and assets stay over a restart; None: nowhere.
        recording: a file that every tick is written to; None: none.
        keys: for other machines.
        lease_s: a main that is silent for so long frees what it holds.
        grace_s: a human whose main is gone leaves the world after so long.
    """

    address: Address = field(default_factory=Address)
    rate: float = 60.0
    lockstep: tuple[str, ...] = ()
    directory: Path | None = None
    recording: Path | None = None
    keys: ServerKeys | None = None
    lease_s: float = 3.0
    grace_s: float = 10.0


class Server(ABC):
    """One virtual space with its sockets. Made, it listens; `run` serves until it is told to stop.

    Args:
        log: gets one sentence for each event that a person should know of.

    Raises:
        WorldError: the address is taken or is not this machine's, keys are missing, or the directory can't be used.
        DataError: the recording can't be begun.
    """

    def __init__(self, settings: Settings, log: Callable[[str], None]) -> None:
        self.settings, self.log = settings, log
        self.tick = 0
        self.tick_s = 1 / settings.rate
        self.sockets = Sockets(settings.address, settings.keys)
        self._journal: Journal | None = None
        try:
            self.space = self._make_space()
            self.publisher = Publisher(self.space, self.sockets.publisher, log)
            if settings.recording is not None:
                self.publisher.record(settings.recording)
        except BaseException:
            self._close_all()
            raise
        self.intake = Intake(self.space)
        self.sessions = Sessions(settings.lease_s, patient=bool(settings.lockstep))
        self.meetings = Meetings()
        self.busy_ms: deque[float] = deque(maxlen=_STATS)
        self.late_ms: deque[float] = deque(maxlen=_STATS)
        self.missed = 0
        self.is_stopping = False
        self._next_leases = self._next_complaint = 0.0
        self._back_until = time.monotonic() + settings.lease_s if self.space.things.by_name else math.inf

    @abstractmethod
    def run(self) -> None:
        """Serve until `stop`."""

    def stop(self) -> None:
        """Let `run` return soon; may be called from a signal handler."""
        self.is_stopping = True

    def close(self) -> None:
        """Close sockets, recording and journal."""
        self.publisher.close()
        self._close_all()

    # What comes in

    def take_frame(self, identity: bytes, data: bytes | memoryview, session: Session, now: float) -> None:
        """Stage a frame, or tell its sender why not."""
        try:
            self.intake.take(identity, data)
        except UnknownHuman:
            if self.sessions.complain(session, now):
                self.sockets.reply(identity, schema.JoinFirst())
        except ProtocolError as error:
            self.complain(session, error, now)
        except WorldError as error:
            self.sockets.reply(identity, schema.Refused(0, str(error)))

    def flush(self) -> None:
        """Apply the frames that have come."""
        for owner, refused in self.intake.flush():
            self.sockets.reply(owner, refused)

    def answer(self, identity: bytes, request: Request, now: float) -> None:
        """Carry out one request and reply."""
        try:
            reply = self._carry_out(identity, request, now)
        except WorldError as error:
            reply = schema.Refused(request.request, str(error))
        if reply is not None and (request.request or isinstance(reply, schema.Refused)):
            self.sockets.reply(identity, reply)
        for whom, number in self.meetings.complete():
            self.sockets.reply(whom, schema.Done(number))

    def complain(self, session: Session, error: ProtocolError, now: float) -> None:
        """Count a message that is none; say so to its sender and, now and then, in the log."""
        if now >= self._next_complaint:
            self._next_complaint = now + _COMPLAINTS_S
            self.log(f"a client sends what is no message ({error}); it is told so and otherwise ignored")
        if self.sessions.complain(session, now):
            self.sockets.reply(session.identity, schema.Refused(0, str(error)))

    def skip_parts(self, session: Session, now: float) -> None:
        """A message of several parts is none; read it to its end."""
        while self.sockets.router.getsockopt(zmq.RCVMORE):
            self.sockets.router.recv()
        self.complain(session, ProtocolError("world protocol: a message has one part"), now)

    # What the two kinds do each in its way

    @abstractmethod
    def present_scene(self, identity: bytes) -> schema.Scene:
        """The scene for a client that asks."""

    @abstractmethod
    def present_snapshot(self, identity: bytes) -> schema.Snapshot:
        """The snapshot for a client that asks."""

    @abstractmethod
    def check_join(self, identity: bytes, join: schema.Join) -> None:
        """WorldError: this client may not join this human."""

    @abstractmethod
    def withdraw(self, identity: bytes, now: float) -> None:
        """The client has left or is gone."""

    # What both do at a tick

    def keep(self, changes: Changes) -> None:
        """Write a tick's changes to the journal, if there is one."""
        if self._journal is not None:
            self._journal.write(changes, self.space.things)

    def check_leases(self, now: float) -> None:
        """Mains that are gone free what they hold; humans that nobody came back to leave."""
        if now < self._next_leases:
            return
        self._next_leases = now + _LEASES_S
        gone: list[str] = []
        for identity in self.sessions.lapsed(now, self.sockets.is_reachable):
            names = self.space.abandon(identity, now, self.settings.grace_s)
            gone += names
            for name in names:
                self.meetings.leave(self.space.people.by_name[name].group, name)
            self.space.assets.forget(identity)
            self.withdraw(identity, now)
        left = self.space.expire(now, self.settings.grace_s)
        if gone:
            self.log(f"{_few(gone)}: the main is gone; what it held is free")
        if left:
            self.log(f"{_few(left)}: nobody came back, so the human has left the world")
        for whom, number in self.meetings.complete():
            self.sockets.reply(whom, schema.Done(number))
        if now >= self._back_until:
            self._back_until = math.inf
            self.space.let_fall()

    # How

    def _carry_out(self, identity: bytes, request: Request, now: float) -> Reply | None:
        """What the server itself answers; the rest is the space's."""
        number = request.request
        match request:
            case schema.Hello():
                rate, mains = self.settings.rate, len(self.settings.lockstep)
                return schema.Welcome(number, self.sockets.snapshots, rate, mains > 0, self.tick, alone=mains == 1)
            case schema.Heartbeat():
                return schema.Done(number)
            case schema.PutAsset(hash=name, size=size):
                have = self.space.assets.put(identity, name, size, request.offset, request.data)
                return schema.AssetPart(number, name, size, have, b"")
            case schema.GetAsset(hash=name, offset=offset):
                size = self.space.assets.size(name)
                data = self.space.assets.part(name, max(0, offset), schema.CHUNK)
                return schema.AssetPart(number, name, size, offset, data)
            case schema.GetScene():
                return _numbered(self.present_scene(identity), number)
            case schema.GetSnapshot():
                return _numbered(self.present_snapshot(identity), number)
            case schema.GetStats():
                return self._stats(number)
            case schema.Sync(human=human, line=line, names=names):
                person = self.space.people.owned(identity, human)
                self.meetings.come(person.group, line, human, names, (identity, number))
                return None
            case schema.Join():
                return self._join(identity, request, now)
            case schema.Leave(human=human):
                person = self.space.people.owned(identity, human)
                reply = self.space.carry_out(identity, request, now)
                self.meetings.leave(person.group, human)
                self.withdraw(identity, now)
                return reply
            case _:
                return self.space.carry_out(identity, request, now)

    def _join(self, identity: bytes, request: schema.Join, now: float) -> Reply:
        self.check_join(identity, request)
        reply = self.space.carry_out(identity, request, now)
        self.sessions.hear(identity, now).is_main = True
        self.meetings.join(request.group, request.name)
        return msgspec.structs.replace(reply, tick=self.tick)

    def _stats(self, number: int) -> schema.Stats:
        people = len(self.space.people.by_name)
        return schema.Stats(
            number, list(self.busy_ms), list(self.late_ms), people, self.intake.taken, self.missed,
            self.sessions.malformed, len(self.sessions),
        )  # fmt: skip

    def _make_space(self) -> Space:
        """The world as the journal left it, or an empty one."""
        directory = self.settings.directory
        if directory is None:
            return Space(Assets(None), self.settings.rate)
        self._journal = Journal(directory, self.log)
        space = Space(Assets(directory / "assets"), self.settings.rate)
        if self._journal.restore(space.things):
            self.log(f"{directory}: {len(space.things.by_name)} objects are back in the world")
        space.take_changes()
        space.settle()
        return space

    def _close_all(self) -> None:
        if self._journal is not None:
            self._journal.close()
        self.sockets.close()


def _numbered(reply: Reply, number: int) -> Reply:
    """The reply to that request."""
    return msgspec.structs.replace(reply, request=number)


def _few(names: list[str]) -> str:
    """At most three names in a line of the log."""
    return ", ".join(names[:3]) + (f" and {len(names) - 3} others" if len(names) > 3 else "")
