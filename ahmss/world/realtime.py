"""The server in real time: what comes is carried out, the world ticks by the clock."""

from __future__ import annotations

import math
import time

import zmq

from ahmss.errors import ProtocolError
from ahmss.world import schema
from ahmss.world.frame import KIND
from ahmss.world.server import Server
from ahmss.world.sessions import Session

__all__ = ["RealTimeServer"]

_MOST_IN_A_ROW = 2048
_AT_ONCE = int(zmq.NOBLOCK)
_CROWD = 200
"""With so many humans, messages are let gather for a moment: to take in many at once is several times cheaper."""

_GATHER_A_HUMAN_S = 4e-6


class RealTimeServer(Server):
    """Serves mains and viewers that keep to the clock."""

    def run(self) -> None:
        """Take what comes, publish when due, tick by the clock, until `stop`."""
        clock, poller = time.monotonic, self.sockets.poller()
        next_tick = clock() + self.tick_s
        busy, started = 0.0, clock()
        while not self.is_stopping:
            now = clock()
            everybody = len(self.intake.frames) >= len(self.space.people.by_name)
            due = self.publisher.due(everybody=everybody)
            if now >= next_tick:
                self._tick(now)
                done = clock()
                next_tick = self._account(busy + done - started, done, next_tick)
                busy, started = 0.0, done
                continue
            if now >= due:
                self._publish(now)
                continue
            wait = min(next_tick, due) - now
            busy += now - started
            ready = poller.poll(math.ceil(wait * 1e3) if wait > 2e-4 else 0)
            started = clock()
            if ready and self._drain():
                self.publisher.note(started)
                busy += clock() - started
                self._gather(next_tick - clock())
                started = clock()

    def present_scene(self, identity: bytes) -> schema.Scene:  # noqa: ARG002 - who asks matters in lockstep
        """The scene as it is now."""
        self.space.settle()
        return self.space.scene()

    def present_snapshot(self, identity: bytes) -> schema.Snapshot:  # noqa: ARG002 - as above
        """The world as it is now."""
        self.space.settle()
        return self.space.snapshot(self.tick, time.time())

    def check_join(self, identity: bytes, join: schema.Join) -> None:
        """A main may move any number of humans."""

    def withdraw(self, identity: bytes, now: float) -> None:
        """Nobody waits for it."""

    def _drain(self) -> bool:
        """Take in what has come, but not for ever; whether there was anything."""
        if self.sockets.doorkeeper is not None:
            self.sockets.doorkeeper.answer()
        receive, hear = self.sockets.router.recv, self.sessions.hear
        now = time.monotonic()
        for count in range(_MOST_IN_A_ROW):
            try:
                identity = receive(_AT_ONCE)
            except zmq.Again:
                return count > 0
            message = receive(_AT_ONCE, copy=False)
            session, data = hear(identity, now), message.buffer
            if session.was_dropped:
                session.was_dropped = False
                self.sockets.reply(identity, schema.JoinFirst())
            if message.more:
                self.skip_parts(session, now)
            elif len(data) and data[0] == KIND:
                self.take_frame(identity, data, session, now)
                if self.intake.is_full:
                    self.flush()
            else:
                self._take_request(session, message.bytes, now)
        return True

    def _take_request(self, session: Session, data: bytes, now: float) -> None:
        try:
            request = schema.decode_request(data)
        except ProtocolError as error:
            self.complain(session, error, now)
            return
        self.flush()
        self.answer(session.identity, request, now)

    def _gather(self, most_s: float) -> None:
        """Let the messages of a crowd gather."""
        humans = len(self.space.people.by_name)
        if humans >= _CROWD and most_s > 0.0:
            time.sleep(min(humans * _GATHER_A_HUMAN_S, most_s))

    def _tick(self, now: float) -> None:
        """One tick."""
        self.tick += 1
        self.flush()
        self.check_leases(now)
        self.space.advance()
        self.space.settle()
        if self.publisher.is_recording and not self.space.was_empty:  # a recording begins with the first that is there
            self.publisher.write(self.space.snapshot(self.tick, self.tick / self.settings.rate), now)
        self._publish(now)

    def _publish(self, now: float) -> None:
        self.flush()
        self.space.settle()
        self.keep(self.space.take_changes())  # first: what was seen outlives a killed server
        self.publisher.publish(self.tick, now, self.tick_s, self.sockets.listeners())
        self.intake.frames.clear()

    def _account(self, busy: float, done: float, due: float) -> float:
        """Note how busy a tick was and whether ticks were missed; when the next is due."""
        self.busy_ms.append(busy * 1e3)
        self.late_ms.append((done - due) * 1e3)
        behind = int((done - due) * self.settings.rate)
        self.tick += behind
        self.missed += behind
        return due + (behind + 1) * self.tick_s
