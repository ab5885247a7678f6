"""The server in lockstep: the mains' frames are the clock (barrier.py says in which order what happens)."""

from __future__ import annotations

import time
from collections.abc import Callable

import msgspec
import zmq

from ahmss.errors import ProtocolError, WorldError
from ahmss.world import schema
from ahmss.world.barrier import Barrier
from ahmss.world.frame import BUNDLE, KIND, unbundle
from ahmss.world.schema import Request
from ahmss.world.server import Server, Settings
from ahmss.world.sessions import Session
from ahmss.world.sockets import WAIT_MS

__all__ = ["LockstepServer"]

_SHOW_S = 1 / 60
_FRAME, _FRAMES = bytes([KIND]), bytes([BUNDLE])
_OUT_OF_ORDER = schema.Hello | schema.Heartbeat | schema.PutAsset | schema.GetAsset | schema.GetStats
"""Requests that change nothing of the world: they are answered at once."""


class LockstepServer(Server):
    """Serves the mains of one run; others may look on."""

    def __init__(self, settings: Settings, log: Callable[[str], None]) -> None:
        super().__init__(settings, log)
        self._barrier = Barrier(settings.lockstep)
        self._latest = self.space.snapshot(0, 0.0)
        self._shown_at = 0.0

    def run(self) -> None:
        """Take what comes, carry out each round that is complete, until `stop`."""
        poller = self.sockets.poller()
        while not self.is_stopping:
            if not self._take() and self.sockets.doorkeeper is not None:
                poller.poll(WAIT_MS)
            now = time.monotonic()
            while self._advance(now):
                pass
            self.check_leases(now)
            if now - self._shown_at >= _SHOW_S:
                self._shown_at = now
                self._show(now)

    def present_scene(self, identity: bytes) -> schema.Scene:
        """Only a main's own place in the order may make a new scene."""
        if self._barrier.name_of(identity) or not self._barrier.owners:
            self.space.settle()
        return self.space.scene()

    def present_snapshot(self, identity: bytes) -> schema.Snapshot:
        """The world for a main of the run; the last tick for who looks on."""
        if self._barrier.owners and not self._barrier.name_of(identity):
            return _at(self._latest, time.time())
        self.space.settle()
        return self.space.snapshot(self.tick, time.time())

    def check_join(self, identity: bytes, join: schema.Join) -> None:
        """WorldError: the client has another human already."""
        entered = self._barrier.name_of(identity)
        if entered and join.name != entered:
            raise WorldError(f"in lockstep each main moves one human; this one moves {entered}")

    def withdraw(self, identity: bytes, now: float) -> None:
        """The main takes no more part; what it asked beyond is answered now."""
        for entry in self._barrier.leave(identity):
            if not isinstance(entry, bytes):
                self.answer(identity, entry, now)

    def _take(self) -> bool:
        """Take in one message, or wait a little for one; whether there was one."""
        doorkeeper = self.sockets.doorkeeper
        if doorkeeper is not None:
            doorkeeper.answer()
        try:
            identity = self.sockets.router.recv(0 if doorkeeper is None else zmq.NOBLOCK)
        except zmq.Again:
            return False
        message = self.sockets.router.recv(zmq.NOBLOCK, copy=False)
        now = time.monotonic()
        session = self.sessions.hear(identity, now)
        if session.was_dropped:
            session.was_dropped = False
            self.sockets.reply(identity, schema.JoinFirst())
        if message.more:
            self.skip_parts(session, now)
            return True
        try:
            self._sort(session, message.bytes, now)
        except ProtocolError as error:
            self.complain(session, error, now)
        return True

    def _sort(self, session: Session, data: bytes, now: float) -> None:
        """What is part of the run's order is queued, the rest is answered. ProtocolError: the bytes are no message."""
        identity = session.identity
        if self._barrier.name_of(identity) and data[:1] in (_FRAME, _FRAMES):
            for frame in [data] if data[:1] == _FRAME else unbundle(data):
                self._barrier.push(identity, frame)
            return
        request = schema.decode_request(data)
        if self._is_ordered(session, request):
            self._barrier.push(identity, request)
        else:
            self.answer(identity, request, now)

    def _is_ordered(self, session: Session, request: Request) -> bool:
        """Whether a request is part of the run's order."""
        if isinstance(request, _OUT_OF_ORDER):
            return False
        entered = bool(self._barrier.name_of(session.identity))
        if not entered and isinstance(request, schema.Join) and self._barrier.expects(request.name):
            self._barrier.enter(session.identity, request.name)
            session.is_main = entered = True
        return entered

    def _advance(self, now: float) -> bool:
        """One round, if every main has spoken; whether it was one."""
        entries = self._barrier.next_round()
        if not entries:
            return False
        frames = False
        for owner, entry in entries:
            if isinstance(entry, bytes):
                frames = True
                self.take_frame(owner, entry, self.sessions.hear(owner, now), now)
            else:
                self.answer(owner, entry, now)
        if frames:
            self.flush()
            self._tick(now)
        return True

    def _tick(self, now: float) -> None:
        """All mains have delivered."""
        self.tick += 1
        self.space.advance()
        changes = self.space.take_changes()
        self.space.settle()
        self.keep(changes)  # first: what was seen outlives a killed server
        more_comes = changes.is_quiet and b"" not in changes.moved.values() and self._barrier.is_ahead
        for owner in () if more_comes else self._barrier.owners:
            self.sockets.reply(owner, self.space.ticked(self.tick, owner, changes, self.intake.frames))
        self.intake.frames.clear()
        if self.publisher.is_recording:
            self._latest = self.space.snapshot(self.tick, self.tick / self.settings.rate)
            self.publisher.write(self._latest, now)

    def _show(self, now: float) -> None:
        """Let viewers see the last tick, 60 times a second of the clock on the wall."""
        if self._latest.tick != self.tick and not self.space.changes.is_structural:
            self._latest = self.space.snapshot(self.tick, 0.0)
        self.publisher.send(_at(self._latest, time.time()), now, self.tick_s, self.sockets.listeners())


def _at(snapshot: schema.Snapshot, now: float) -> schema.Snapshot:
    """A tick as it is shown: with the time on the clock."""
    return msgspec.structs.replace(snapshot, time=now)
