"""The port at which human models reach a main: a ROUTER that the frame loop serves, without ever waiting."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, cast

import zmq

from ahmss.errors import AhmssError, ProtocolError, WorldError
from ahmss.main.answering import Answering, Job
from ahmss.main.sight import WAITS
from ahmss.port.schema import LARGEST, Refused, Reply, decode_request, encode
from ahmss.world.address import Address
from ahmss.world.doorkeeper import Doorkeeper
from ahmss.world.keys import ServerKeys, read_server
from ahmss.world.ports import check_host

if TYPE_CHECKING:
    from ahmss.main.process import MainProcess

__all__ = ["HumanModelPort"]

_MOST_TAKEN = 16  # messages a frame
_MOST_JOBS = 64  # answers under way; of one client a quarter
_SHARE = 0.1  # of a frame's time for answers
_QUEUE = 64  # messages that wait in the socket, each way, for each client


@dataclass
class _Asked:
    """An answer under way: to whom (with the empty part that a REQ socket wants), to which request."""

    client: tuple[bytes, ...]
    request: int
    job: Job


class HumanModelPort:
    """Answers human models in the frame loop of one main.

    A frame takes in at most 16 messages, starts each answer, and goes on with the answers for a tenth of a frame's
    time at most; what is left goes on in the next frame. A client that asks too much at once is refused, one that does
    not read loses answers, one that is gone is forgotten; nobody else is disturbed.

    Args:
        main: whose human it is.
        address: where to listen (`ahmss.port.address`).
        keys: a directory with server.key and authorised/, for an address that other machines reach.

    Attributes:
        address: where it listens.
        taken, refused, lost: messages that came, requests that were refused, answers that nobody took.

    Raises:
        WorldError: the address is taken, is not this machine's, or needs keys.
    """

    def __init__(self, main: MainProcess, address: Address, keys: Path | None = None) -> None:
        if keys is None and not address.is_loopback:
            check_host(address)
            raise WorldError(
                f"a port on {address.host} can be reached from other machines and needs keys; "
                "make them with `ahmss keys` and name them by --port-keys, or listen on 127.0.0.1"
            )
        self.taken = self.refused = self.lost = 0
        self._main, self._answering = main, Answering(main)
        self._jobs: deque[_Asked] = deque()
        self._slice = _SHARE / main.setup.rate
        self._context: zmq.Context[zmq.Socket[bytes]] = zmq.Context()
        known = None if keys is None else read_server(keys)
        self._doorkeeper = None if known is None else Doorkeeper(self._context, known.authorised)
        self._router = self._make(address, known)
        try:
            self.address = self._bind(address)
        except zmq.ZMQError as error:
            self._context.destroy(0)
            raise WorldError(
                f"the port can't be opened on {address}: {error.strerror}; stop what is there or name another port"
            ) from error

    def serve(self) -> None:
        """A frame's share of the work."""
        if self._doorkeeper is not None:
            self._doorkeeper.answer()
        for _ in range(_MOST_TAKEN):
            if not self._take():
                break
        if self._jobs:
            self._go_on()

    def close(self) -> None:
        """Close the socket."""
        self._router.close()
        if self._doorkeeper is not None:
            self._doorkeeper.close()
        self._context.term()
        if self.address.path:
            Path(self.address.path).unlink(missing_ok=True)

    def _take(self) -> bool:
        """Take one message in; False where none waits."""
        try:
            parts = self._router.recv_multipart(zmq.NOBLOCK)
        except zmq.Again:
            return False
        self.taken += 1
        client, data = tuple(parts[:-1]), parts[-1]
        if client[1:] not in ((), (b"",)):
            self._refuse(client[:1], 0, "human-model port: a request has one part; see docs/human-model-port.md")
            return True
        try:
            request = decode_request(data)
        except ProtocolError as error:
            self._refuse(client, 0, str(error))
            return True
        if self._has_too_many(client):
            self._refuse(client, request.request, "too many questions at once; wait for the answers to those before")
            return True
        self._jobs.append(_Asked(client, request.request, self._answering.answer(request)))
        return True

    def _has_too_many(self, client: tuple[bytes, ...]) -> bool:
        if len(self._jobs) >= _MOST_JOBS:
            return True
        return sum(asked.client == client for asked in self._jobs) >= _MOST_JOBS // 4

    def _go_on(self) -> None:
        """Go on with the answers, each in its turn, until the frame's share of time is over or all wait."""
        end = time.perf_counter() + self._slice
        waiting: list[_Asked] = []
        while self._jobs:
            asked = self._jobs.popleft()
            state = self._advance(asked)
            if state is not None:
                (waiting if state == WAITS else self._jobs).append(asked)
            if time.perf_counter() > end:
                break
        self._jobs.extend(waiting)

    def _advance(self, asked: _Asked) -> bool | None:
        """One piece of work for an answer: WORKS, WAITS, or None where it is over."""
        try:
            return next(asked.job)
        except StopIteration as end:
            self._send(asked.client, cast(Reply, end.value))
        except AhmssError as error:
            self._refuse(asked.client, asked.request, str(error))
        except Exception as error:  # noqa: BLE001 - the frames go on, and both sides are told
            reason = f"a fault of the program itself: {type(error).__name__}: {error}"
            self._main.trouble(f"human-model port: {reason}")
            self._refuse(asked.client, asked.request, reason)
        return None

    def _refuse(self, client: tuple[bytes, ...], request: int, reason: str) -> None:
        self.refused += 1
        self._send(client, Refused(request, reason))

    def _send(self, client: tuple[bytes, ...], reply: Reply) -> None:
        """Send an answer, or lose it: who is gone or does not read must not hold up the frames."""
        try:
            self._router.send_multipart([*client, encode(reply)], zmq.NOBLOCK)
        except zmq.ZMQError as error:
            if error.errno not in (zmq.EHOSTUNREACH, zmq.EAGAIN):
                raise
            self.lost += 1

    def _make(self, address: Address, keys: ServerKeys | None) -> zmq.Socket[bytes]:
        router = self._context.socket(zmq.ROUTER)
        for option, value in (
            (zmq.LINGER, 100), (zmq.IPV6, int(":" in address.host)), (zmq.ROUTER_MANDATORY, 1),
            (zmq.MAXMSGSIZE, LARGEST), (zmq.RCVHWM, _QUEUE),
            (zmq.SNDHWM, _QUEUE), (zmq.HEARTBEAT_IVL, 1000), (zmq.HEARTBEAT_TIMEOUT, 4000),
        ):  # fmt: skip
            router.setsockopt(option, value)
        if keys is not None:
            keys.secure(router)
        return router

    def _bind(self, address: Address) -> Address:
        if address.path:
            self._router.bind(address.endpoint())
            return address
        self._router.bind(address.endpoint() if address.port else f"tcp://{address.host}:*")
        port = int(str(self._router.getsockopt_string(zmq.LAST_ENDPOINT)).rpartition(":")[2])
        return Address(address.host, port)
