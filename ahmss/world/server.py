"""The virtual-space server: sockets, the loop, and who is answered what.

In real time, frames and requests are carried out as they come; the world ticks by the clock. In lockstep (barrier.py)
they wait until every main has spoken, and the world ticks when all have delivered.
"""

from __future__ import annotations

import math
import time
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
from ahmss.world.barrier import Barrier
from ahmss.world.doorkeeper import Doorkeeper
from ahmss.world.frame import BUNDLE, KIND, unbundle
from ahmss.world.intake import Intake, UnknownHuman
from ahmss.world.journal import Journal
from ahmss.world.keys import ServerKeys
from ahmss.world.link import LARGEST_MESSAGE
from ahmss.world.meeting import Meetings
from ahmss.world.publisher import Publisher
from ahmss.world.schema import Reply, Request, decode_request, encode
from ahmss.world.sessions import Session, Sessions
from ahmss.world.space import Space

__all__ = ["Server", "Settings"]

_MOST_IN_A_ROW = 2048
_LEASES_S = 0.25
_COMPLAINTS_S = 60.0
_SHOW_S = 1 / 60
_STATS = 4096
_WAIT_MS = 15
_FRAME, _FRAMES = bytes([KIND]), bytes([BUNDLE])
_AT_ONCE = int(zmq.NOBLOCK)
_CROWD = 200
"""With so many humans, messages are let gather for a moment: to take in many at once is several times cheaper."""

_GATHER_A_HUMAN_S = 4e-6


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


class Server:
    """One virtual space with its sockets. Made, it listens; `run` serves until it is told to stop.

    Args:
        log: gets one sentence for each event that a person should know of.

    Raises:
        WorldError: the address is taken or is not this machine's, keys are missing, or the directory can't be used.
    """

    def __init__(self, settings: Settings, log: Callable[[str], None]) -> None:
        self.settings, self._log = settings, log
        if settings.keys is None and not settings.address.is_loopback:
            raise WorldError(
                f"a server that listens on {settings.address.host} can be reached from other machines and needs keys; "
                "make them with `ahmss keys`, or listen on 127.0.0.1"
            )
        self.tick = 0
        self._journal = None if settings.directory is None else Journal(settings.directory, log)
        assets = None if settings.directory is None else settings.directory / "assets"
        self.space = Space(Assets(assets), settings.rate)
        if self._journal is not None and self._journal.restore(self.space.things):
            log(f"{settings.directory}: {len(self.space.things.by_name)} objects are back in the world")
        self.space.take_changes()
        self.space.settle()
        self._intake = Intake(self.space)
        self._sessions = Sessions(settings.lease_s, patient=bool(settings.lockstep))
        self._barrier = Barrier(settings.lockstep)
        self._meetings = Meetings()
        self._tick_s = 1 / settings.rate
        self._busy: deque[float] = deque(maxlen=_STATS)
        self._late: deque[float] = deque(maxlen=_STATS)
        self._missed = 0
        self._next_leases = self._next_complaint = 0.0
        self._shown_at = 0.0
        self._stopping = False
        self._latest: schema.Snapshot = self.space.snapshot(0, 0.0)
        self._open()
        self._publisher = Publisher(self.space, self._pub, log)
        if settings.recording is not None:
            self._publisher.record(settings.recording)

    def stop(self) -> None:
        """Let `run` return soon; may be called from a signal handler."""
        self._stopping = True

    def run(self) -> None:
        """Serve until `stop`."""
        poller = zmq.Poller()
        poller.register(self._router, zmq.POLLIN)
        if self._doorkeeper is not None:
            poller.register(self._doorkeeper.socket, zmq.POLLIN)
        if self.settings.lockstep:
            self._run_lockstep(poller)
        else:
            self._run_clock(poller)

    def close(self) -> None:
        """Close sockets, recording and journal."""
        self._publisher.close()
        if self._journal is not None:
            self._journal.close()
        self._router.close()
        self._pub.close()
        if self._doorkeeper is not None:
            self._doorkeeper.close()
        self._context.term()
        if self.address.path:
            for endpoint in (self.address.endpoint(), self.address.endpoint(1)):
                Path(endpoint.removeprefix("ipc://")).unlink(missing_ok=True)

    # The loops

    def _run_clock(self, poller: zmq.Poller) -> None:
        """Real time: take what comes, publish when due, tick by the clock."""
        clock = time.monotonic
        next_tick = clock() + self._tick_s
        busy, started = 0.0, clock()
        while not self._stopping:
            now = clock()
            everybody = len(self._intake.frames) >= len(self.space.people.by_name)
            due = self._publisher.due(everybody=everybody)
            if now >= next_tick:
                self._tick_clock(now)
                done = clock()
                self._busy.append((busy + done - started) * 1e3)
                self._late.append((done - next_tick) * 1e3)
                busy, started = 0.0, done
                behind = int((done - next_tick) * self.settings.rate)
                self.tick += behind
                self._missed += behind
                next_tick += (behind + 1) * self._tick_s
                continue
            if now >= due:
                self._publish(now)
                continue
            wait = min(next_tick, due) - now
            busy += now - started
            ready = poller.poll(math.ceil(wait * 1e3) if wait > 2e-4 else 0)
            started = clock()
            if ready and self._drain():
                self._publisher.note(started)
                humans = len(self.space.people.by_name)
                gather_s = min(humans * _GATHER_A_HUMAN_S, next_tick - clock())
                if humans >= _CROWD and gather_s > 0.0:
                    busy += clock() - started
                    time.sleep(gather_s)
                    started = clock()

    def _run_lockstep(self, poller: zmq.Poller) -> None:
        """Lockstep: the mains' frames are the clock."""
        while not self._stopping:
            if not self._drain() and self._doorkeeper is not None:
                poller.poll(_WAIT_MS)
            now = time.monotonic()
            while self._advance(now):
                pass
            self._check_leases(now)
            if now - self._shown_at >= _SHOW_S:
                self._shown_at = now
                self._show(now)

    def _drain(self) -> bool:
        """Take in what has come, but not for ever; whether there was anything. In lockstep wait, and take one."""
        if self._doorkeeper is not None:
            self._doorkeeper.answer()
        receive, hear, intake = self._router.recv, self._sessions.hear, self._intake
        in_order = bool(self.settings.lockstep)
        wait = 0 if in_order and self._doorkeeper is None else _AT_ONCE
        now = time.monotonic()
        for count in range(1 if in_order else _MOST_IN_A_ROW):
            try:
                identity = receive(wait)
            except zmq.Again:
                return count > 0
            message = receive(_AT_ONCE, copy=False)
            session, data = hear(identity, now), message.buffer
            if session.was_dropped:
                session.was_dropped = False
                self._reply(identity, schema.JoinFirst())
            if message.more:
                self._skip_parts(session, now)
            elif in_order or not len(data) or data[0] != KIND:
                self._take_request(session, message.bytes, now)
            else:
                self._take(identity, data, session, now)
                if intake.is_full:
                    self._flush()
        return True

    # What comes in

    def _take(self, identity: bytes, data: bytes | memoryview, session: Session, now: float) -> None:
        """A frame."""
        try:
            self._intake.take(identity, data)
        except UnknownHuman:
            if self._sessions.complain(session, now):
                self._reply(identity, schema.JoinFirst())
        except ProtocolError as error:
            self._complain(session, error, now)
        except WorldError as error:
            self._reply(identity, schema.Refused(0, str(error)))

    def _flush(self) -> None:
        """Apply the frames that have come."""
        for owner, refused in self._intake.flush():
            self._reply(owner, refused)

    def _take_request(self, session: Session, data: bytes, now: float) -> None:
        """A request, or in lockstep also a frame: now, or when all have spoken."""
        identity = session.identity
        if self._barrier.name_of(identity) and data[:1] in (_FRAME, _FRAMES):
            self._queue_frames(session, data, now)
            return
        try:
            request: Request = decode_request(data)
        except ProtocolError as error:
            self._complain(session, error, now)
            return
        if self._waits(identity, request):
            self._queue(session, request)
            return
        self._flush()
        self._answer(identity, request, now)

    def _waits(self, identity: bytes, request: Request) -> bool:
        """Whether a request of lockstep is part of the run's order."""
        if not self.settings.lockstep or isinstance(
            request, schema.Hello | schema.Heartbeat | schema.PutAsset | schema.GetAsset | schema.GetStats
        ):
            return False
        if isinstance(request, schema.Join) and self._barrier.expects(request.name):
            if not self._barrier.name_of(identity):
                self._barrier.enter(identity, request.name)
                self._sessions.hear(identity, time.monotonic()).is_main = True
            return True
        return bool(self._barrier.name_of(identity))

    def _queue_frames(self, session: Session, data: bytes, now: float) -> None:
        """A frame of lockstep, or several."""
        try:
            for frame in [data] if data[:1] == _FRAME else unbundle(data):
                self._queue(session, frame)
        except ProtocolError as error:
            self._complain(session, error, now)

    def _queue(self, session: Session, entry: bytes | Request) -> None:
        if not self._barrier.push(session.identity, entry):
            self._complain(session, ProtocolError("far more is sent than lockstep takes; wait for the ticks"), 0.0)

    def _answer(self, identity: bytes, request: Request, now: float) -> None:
        """Carry out one request and reply."""
        try:
            reply = self._carry_out(identity, request, now)
        except WorldError as error:
            reply = schema.Refused(request.request, str(error))
        if reply is not None and (request.request or isinstance(reply, schema.Refused)):
            self._reply(identity, reply)
        for whom, number in self._meetings.complete():
            self._reply(whom, schema.Done(number))

    def _carry_out(self, identity: bytes, request: Request, now: float) -> Reply | None:
        """What the server itself answers; the rest is the space's."""
        number = request.request
        match request:
            case schema.Hello():
                rate, mains = self.settings.rate, len(self.settings.lockstep)
                return schema.Welcome(number, self._snapshot_port, rate, mains > 0, self.tick, alone=mains == 1)
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
                return _numbered(self._present_scene(identity), number)
            case schema.GetSnapshot():
                return _numbered(self._present_snapshot(identity), number)
            case schema.GetStats():
                return self._stats(number)
            case schema.Sync(human=human, line=line, names=names):
                person = self.space.people.owned(identity, human)
                self._meetings.come(person.group, line, human, names, (identity, number))
                return None
            case schema.Join():
                return self._join(identity, request, now)
            case schema.Leave(human=human):
                person = self.space.people.owned(identity, human)
                reply = self.space.carry_out(identity, request, now)
                self._meetings.leave(person.group, human)
                self._leave_barrier(identity, now)
                return reply
            case _:
                return self.space.carry_out(identity, request, now)

    def _join(self, identity: bytes, request: schema.Join, now: float) -> Reply:
        entered = self._barrier.name_of(identity)
        if entered and request.name != entered:
            raise WorldError(f"in lockstep each main moves one human; this one moves {entered}")
        reply = self.space.carry_out(identity, request, now)
        self._sessions.hear(identity, now).is_main = True
        self._meetings.join(request.group, request.name)
        return msgspec.structs.replace(reply, tick=self.tick)

    def _present_scene(self, identity: bytes) -> schema.Scene:
        """In lockstep only a main's own place in the order may make a new scene."""
        if not self.settings.lockstep or self._barrier.name_of(identity) or not self._barrier.owners:
            self.space.settle()
        return self.space.scene()

    def _present_snapshot(self, identity: bytes) -> schema.Snapshot:
        if self.settings.lockstep and self._barrier.owners and not self._barrier.name_of(identity):
            return _at(self._latest, time.time())
        self.space.settle()
        return self.space.snapshot(self.tick, time.time())

    def _stats(self, number: int) -> schema.Stats:
        people = len(self.space.people.by_name)
        return schema.Stats(
            number, list(self._busy), list(self._late), people, self._intake.taken, self._missed,
            self._sessions.malformed, len(self._sessions),
        )  # fmt: skip

    # Ticks

    def _tick_clock(self, now: float) -> None:
        """One tick of real time."""
        self.tick += 1
        self._flush()
        self._check_leases(now)
        self.space.settle()
        if self._publisher.is_recording and self.space.revision > 0:  # a recording begins with the first that is there
            self._publisher.write(self.space.snapshot(self.tick, self.tick / self.settings.rate), now)
        self._publish(now)
        self._keep()

    def _publish(self, now: float) -> None:
        self._flush()
        self._publisher.publish(self.tick, now, self._tick_s)
        self._intake.frames.clear()

    def _keep(self) -> None:
        changes = self.space.take_changes()
        if self._journal is not None:
            self._journal.write(changes, self.space.things)

    def _advance(self, now: float) -> bool:
        """Lockstep: one round, if every main has spoken; whether it was one."""
        entries = self._barrier.next_round()
        if not entries:
            return False
        if not isinstance(entries[0][1], bytes):
            for owner, entry in entries:
                if not isinstance(entry, bytes):
                    self._answer(owner, entry, now)
            return True
        for owner, entry in entries:
            if isinstance(entry, bytes):
                self._take(owner, entry, self._sessions.hear(owner, now), now)
        self._flush()
        self._tick_lockstep(now)
        return True

    def _tick_lockstep(self, now: float) -> None:
        """All mains have delivered."""
        self.tick += 1
        changes = self.space.take_changes()
        self.space.settle()
        more_comes = changes.is_quiet and self._barrier.is_ahead
        for owner in () if more_comes else self._barrier.owners:
            self._reply(owner, self.space.ticked(self.tick, owner, changes, self._intake.frames))
        self._intake.frames.clear()
        if self._publisher.is_recording:
            self._latest = self.space.snapshot(self.tick, self.tick / self.settings.rate)
            self._publisher.write(self._latest, now)
        if self._journal is not None:
            self._journal.write(changes, self.space.things)

    def _show(self, now: float) -> None:
        """Lockstep: let viewers see the last tick, 60 times a second of the clock on the wall."""
        if self._latest.tick != self.tick and not self.space.changes.is_structural:
            self._latest = self.space.snapshot(self.tick, 0.0)
        self._publisher.send(_at(self._latest, time.time()), now, self._tick_s)

    def _check_leases(self, now: float) -> None:
        """Mains that are gone free what they hold; humans that nobody came back to leave."""
        if now < self._next_leases:
            return
        self._next_leases = now + _LEASES_S
        gone: list[str] = []
        for identity in self._sessions.lapsed(now, self._is_reachable):
            names = self.space.abandon(identity, now)
            gone += names
            for name in names:
                self._meetings.leave(self.space.people.by_name[name].group, name)
            self.space.assets.forget(identity)
            self._leave_barrier(identity, now)
        left = self.space.expire(now, self.settings.grace_s)
        if gone:
            self._log(f"{_few(gone)}: the main is gone; what it held is free")
        if left:
            self._log(f"{_few(left)}: nobody came back, so the human has left the world")
        for whom, number in self._meetings.complete():
            self._reply(whom, schema.Done(number))

    def _leave_barrier(self, identity: bytes, now: float) -> None:
        """A main takes no more part in lockstep; what it asked beyond is answered now."""
        for entry in self._barrier.leave(identity):
            if not isinstance(entry, bytes):
                self._answer(identity, entry, now)

    # Sockets

    def _open(self) -> None:
        """Make and bind the sockets."""
        settings = self.settings
        self._context: zmq.Context[zmq.Socket[bytes]] = zmq.Context()
        self._doorkeeper = None if settings.keys is None else Doorkeeper(self._context, settings.keys.authorised)
        self._router = self._socket(zmq.ROUTER)
        self._router.setsockopt(zmq.ROUTER_MANDATORY, 1)
        self._router.setsockopt(zmq.ROUTER_HANDOVER, 1)
        self._router.setsockopt(zmq.MAXMSGSIZE, LARGEST_MESSAGE)
        self._router.setsockopt(zmq.RCVHWM, 256)
        self._router.setsockopt(zmq.SNDHWM, 64)
        self._router.setsockopt(zmq.RCVTIMEO, _WAIT_MS)
        self._pub = self._socket(zmq.PUB)
        self._pub.setsockopt(zmq.CONFLATE, 1)
        self._pub.setsockopt(zmq.MAXMSGSIZE, 4096)
        address = settings.address
        if address.path:
            self._bind(self._router, address.endpoint())
            self._bind(self._pub, address.endpoint(1))
            self.address, self._snapshot_port = address, 1
            return
        anywhere = f"tcp://{address.host}:*"
        port = self._bind(self._router, address.endpoint() if address.port else anywhere)
        self._snapshot_port = self._bind(self._pub, address.endpoint(port + 1) if address.port else anywhere)
        self.address = Address(address.host, port)

    def _socket(self, kind: int) -> zmq.Socket[bytes]:
        socket = self._context.socket(kind)
        socket.setsockopt(zmq.LINGER, 100)
        socket.setsockopt(zmq.IPV6, int(":" in self.settings.address.host))
        socket.setsockopt(zmq.HEARTBEAT_IVL, 1000)
        socket.setsockopt(zmq.HEARTBEAT_TIMEOUT, 4000)
        if self.settings.keys is not None:
            self.settings.keys.secure(socket)
        return socket

    def _bind(self, socket: zmq.Socket[bytes], endpoint: str) -> int:
        """Bind; the port that it got, of a TCP endpoint."""
        try:
            socket.bind(endpoint)
        except zmq.ZMQError as error:
            self._close_failed()
            raise WorldError(
                f"the server can't listen on {endpoint}: {error.strerror}; stop what is there or name another port"
            ) from error
        port = str(socket.getsockopt_string(zmq.LAST_ENDPOINT)).rpartition(":")[2]
        return int(port) if port.isdigit() else 0

    def _close_failed(self) -> None:
        """Close what was opened before the start failed."""
        if self._journal is not None:
            self._journal.close()
        self._context.destroy(0)

    def _reply(self, identity: bytes, reply: Reply) -> None:
        """Send to one client, or drop it: a client that does not read must not hold up the others."""
        try:
            self._router.send(identity, zmq.NOBLOCK | zmq.SNDMORE)
            self._router.send(encode(reply), zmq.NOBLOCK)
        except zmq.ZMQError as error:
            if error.errno not in (zmq.EHOSTUNREACH, zmq.EAGAIN):
                raise

    def _is_reachable(self, identity: bytes) -> bool:
        try:
            self._router.send(identity, zmq.NOBLOCK | zmq.SNDMORE)
            self._router.send(encode(schema.Done(0)), zmq.NOBLOCK)
        except zmq.ZMQError as error:
            return error.errno != zmq.EHOSTUNREACH
        return True

    def _complain(self, session: Session, error: ProtocolError, now: float) -> None:
        """Count a message that is none; say so to its sender and, now and then, in the log."""
        if now >= self._next_complaint:
            self._next_complaint = now + _COMPLAINTS_S
            self._log(f"a client sends what is no message ({error}); it is told so and otherwise ignored")
        if self._sessions.complain(session, now):
            self._reply(session.identity, schema.Refused(0, str(error)))

    def _skip_parts(self, session: Session, now: float) -> None:
        while self._router.getsockopt(zmq.RCVMORE):
            self._router.recv()
        self._complain(session, ProtocolError("world protocol: a message has one part"), now)



def _numbered(reply: Reply, number: int) -> Reply:
    """The reply to that request."""
    return msgspec.structs.replace(reply, request=number)


def _few(names: list[str]) -> str:
    """At most three names in a line of the log."""
    return ", ".join(names[:3]) + (f" and {len(names) - 3} others" if len(names) > 3 else "")


def _at(snapshot: schema.Snapshot, now: float) -> schema.Snapshot:
    """A tick of lockstep as it is shown: with the time on the clock."""
    return msgspec.structs.replace(snapshot, time=now)
