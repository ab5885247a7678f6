"""One client's connection for requests and frames: numbers requests, meets replies, reconnects by itself."""

from __future__ import annotations

import secrets
import struct
import time
from collections import deque
from collections.abc import Callable
from typing import cast

import msgspec
import zmq

from ahmss.errors import Unreachable, WorldError
from ahmss.world.address import Address
from ahmss.world.keys import ClientKeys
from ahmss.world.schema import Heartbeat, Refused, Reply, Request, decode_reply, encode

__all__ = ["LARGEST_MESSAGE", "Link", "Pending"]

LARGEST_MESSAGE = 4 << 20
"""Bytes; a server cuts off who sends more."""

_HEARTBEAT_S = 0.5
_WATCH_S = 0.1
_READABLE = int(zmq.POLLIN)
_MOST_WAITING = 1000
_EVENT = struct.Struct("=HI")  # of a socket's monitor: what happened, and a value


class Pending:
    """A request under way. `done` turns true in `Link.pump`; `result` gives the reply or raises the refusal."""

    def __init__(self, request: Request) -> None:
        self.request = request
        self.done = False
        self._reply: Reply | None = None
        self._error: WorldError | None = None

    def result(self) -> Reply:
        """The reply. Raises WorldError with the server's reason, or Unreachable where the connection broke."""
        if self._error is not None:
            raise self._error
        if self._reply is None:
            raise WorldError(f"the server has not answered {type(self.request).__name__} yet")
        return self._reply

    def settle(self, reply: Reply) -> None:
        """The reply has come."""
        self.done = True
        if isinstance(reply, Refused):
            self._error = WorldError(reply.reason)
        else:
            self._reply = reply

    def fail(self, error: WorldError) -> None:
        """No reply will come."""
        self.done = True
        self._error = error


class Link:
    """A DEALER socket with what makes it last. Not for use from two threads.

    Args:
        address: the server's.
        keys: this client's keys and the server's public key, where the server asks for them.
        connected: called at each new connection, before anything that waits is sent.
        answered: called with each request and its reply (a refusal too).
        unasked: called with each message that answers no request.
    """

    def __init__(
        self,
        context: zmq.Context[zmq.Socket[bytes]],
        address: Address,
        keys: ClientKeys | None,
        connected: Callable[[], None],
        answered: Callable[[Request, Reply], None],
        unasked: Callable[[Reply], None],
    ) -> None:
        self.address = address
        self.is_up = False
        self.last_heard = 0.0
        self._connected, self._answered, self._unasked = connected, answered, unasked
        self._pending: dict[int, Pending] = {}
        self._waiting: deque[bytes] = deque(maxlen=_MOST_WAITING)
        self._number = 0
        self._last_sent = self._next_watch = 0.0
        self.socket = context.socket(zmq.DEALER)
        self.socket.setsockopt(zmq.ROUTING_ID, b"m" + secrets.token_bytes(15))
        self.socket.setsockopt(zmq.LINGER, 200)
        self.socket.setsockopt(zmq.IMMEDIATE, 1)  # nothing is queued for a server that is not there
        self.socket.setsockopt(zmq.SNDHWM, 256)
        self.socket.setsockopt(zmq.RCVTIMEO, int(_WATCH_S * 1000))
        self.socket.setsockopt(zmq.RECONNECT_IVL, 50)
        self.socket.setsockopt(zmq.RECONNECT_IVL_MAX, 1000)
        self.socket.setsockopt(zmq.HEARTBEAT_IVL, 1000)
        self.socket.setsockopt(zmq.HEARTBEAT_TIMEOUT, 4000)
        if keys is not None:
            keys.secure(self.socket)
        events = zmq.EVENT_HANDSHAKE_SUCCEEDED | zmq.EVENT_DISCONNECTED
        self._monitor = self.socket.get_monitor_socket(events)
        self.socket.connect(address.endpoint())

    def close(self) -> None:
        """Close the sockets; what was sent just before is given 0.2 s to leave."""
        self.socket.disable_monitor()
        self._monitor.close(0)
        self.socket.close()

    def ask(self, request: Request) -> Pending:
        """Send a request, now or as soon as there is a connection; never blocks."""
        self._number += 1
        numbered = msgspec.structs.replace(request, request=self._number)
        data = encode(numbered)
        pending = Pending(numbered)
        if len(data) > LARGEST_MESSAGE:
            pending.fail(WorldError(
                f"{type(request).__name__} is {len(data)} bytes, a server takes {LARGEST_MESSAGE}; send it in parts"
            ))  # fmt: skip
            return pending
        self._pending[self._number] = pending
        if not (self.is_up and self.send(data)):
            self._waiting.append(data)
        return pending

    def send(self, data: bytes) -> bool:
        """Send bytes at once; False where there is no connection or its queue is full."""
        try:
            self.socket.send(data, zmq.NOBLOCK)
        except zmq.Again:
            self._next_watch = 0.0
            return False
        self._last_sent = time.monotonic()
        return True

    def pump(self) -> None:
        """Take in all that has come, meet replies, keep the connection alive. Never blocks."""
        now = time.monotonic()
        if now >= self._next_watch or not self.is_up:
            self._next_watch = now + _WATCH_S
            self._watch()
        while self._events() & _READABLE:  # cheaper than to meet an exception each time
            self.take(decode_reply(self.socket.recv(zmq.NOBLOCK)))
        if self.is_up and now - self._last_sent > _HEARTBEAT_S:
            self.send(encode(Heartbeat()))

    def take(self, reply: Reply) -> None:
        """Meet one reply with its request."""
        self.last_heard = time.monotonic()
        number = getattr(reply, "request", 0)
        pending = self._pending.pop(number, None) if number else None
        if pending is not None:
            pending.settle(reply)
            self._answered(pending.request, reply)
        else:
            self._unasked(reply)

    def take_one(self) -> None:
        """Wait for one message and take it in, or 0.1 s at most."""
        try:
            self.take(decode_reply(self.socket.recv()))
        except zmq.Again:
            self._watch()
            self.pump()

    def wait(self, pending: Pending, timeout: float) -> Reply:
        """Block until the reply has come.

        Raises:
            Unreachable: no server, or no answer in `timeout` seconds.
            WorldError: the server refused; the message is its reason.
        """
        limit = time.monotonic() + timeout
        self.pump()
        while not pending.done:
            left = limit - time.monotonic()
            if left <= 0:
                self._pending.pop(getattr(pending.request, "request", 0), None)
                raise Unreachable(self._silence(pending, timeout))
            if self.is_up:
                self.take_one()
            else:
                self._monitor.poll(int(min(left, _WATCH_S) * 1000) + 1)
                self.pump()
        return pending.result()

    def _events(self) -> int:
        return cast(int, self.socket.getsockopt(zmq.EVENTS))

    def _silence(self, pending: Pending, timeout: float) -> str:
        asked = type(pending.request).__name__
        if self.is_up:
            return f"the server at {self.address} has not answered {asked} in {timeout:g} s; try again"
        return f"no virtual-space server answers at {self.address}; start one with `ahmss server`, or check the keys"

    def _watch(self) -> None:
        """Follow the connection: up sends what waits, down fails what was under way."""
        while True:
            try:
                event, _ = _EVENT.unpack(self._monitor.recv_multipart(zmq.NOBLOCK)[0])
            except zmq.Again:
                return
            if event == zmq.EVENT_DISCONNECTED and self.is_up:
                self.is_up = False
                self._fail_sent()
            elif event == zmq.EVENT_HANDSHAKE_SUCCEEDED:
                self.is_up = True
                self.last_heard = time.monotonic()
                waiting, self._waiting = self._waiting, deque(maxlen=_MOST_WAITING)
                self._connected()
                for data in waiting:
                    if not self.send(data):
                        self._waiting.append(data)

    def _fail_sent(self) -> None:
        """What was sent and not answered may have been carried out or not: its askers must look."""
        error = Unreachable(f"the connection to {self.address} broke before the server answered; look, and ask again")
        sent, self._pending = self._pending, {}
        for pending in sent.values():
            pending.fail(error)
