"""The server's sockets: made, bound, answered through, closed."""

from __future__ import annotations

from pathlib import Path
from typing import cast

import zmq
from zmq.utils.monitor import parse_monitor_message

from ahmss.errors import WorldError
from ahmss.world.address import Address
from ahmss.world.doorkeeper import Doorkeeper
from ahmss.world.keys import ServerKeys
from ahmss.world.link import LARGEST_MESSAGE
from ahmss.world.ports import check_host, free_port, is_taken
from ahmss.world.schema import Done, Reply, encode

__all__ = ["WAIT_MS", "Sockets"]

_READABLE = int(zmq.POLLIN)

WAIT_MS = 15
"""How long a receive without NOBLOCK waits."""


class Sockets:
    """A ROUTER for requests and frames, a PUB for snapshots, and with keys a doorkeeper.

    Attributes:
        router: RCVTIMEO is WAIT_MS.
        address, snapshots: where it listens, and the port of the snapshots.

    Raises:
        WorldError: the address is taken, is not this machine's, or needs keys.
    """

    def __init__(self, address: Address, keys: ServerKeys | None) -> None:
        if keys is None and not address.is_loopback:
            check_host(address)
            raise WorldError(
                f"a server that listens on {address.host} can be reached from other machines and needs keys; "
                "make them with `ahmss keys`, or listen on 127.0.0.1"
            )
        self._keys = keys
        self._context: zmq.Context[zmq.Socket[bytes]] = zmq.Context()
        self.doorkeeper = None if keys is None else Doorkeeper(self._context, keys.authorised)
        self.router, self.publisher = self._make_router(address), self._make_publisher(address)
        self._comings = self.publisher.get_monitor_socket(zmq.EVENT_ACCEPTED | zmq.EVENT_DISCONNECTED)
        self._listeners = 0
        try:
            self.address, self.snapshots = self._bind_both(address)
        except zmq.ZMQError as error:
            self._context.destroy(0)
            raise WorldError(f"the server can't listen on {address}: {_why_not(address, error)}") from error

    def close(self) -> None:
        """Close all; what was sent just before is given 0.1 s to leave."""
        self.router.close()
        self.publisher.disable_monitor()
        self._comings.close()
        self.publisher.close()
        if self.doorkeeper is not None:
            self.doorkeeper.close()
        self._context.term()
        if self.address.path:
            for endpoint in (self.address.endpoint(), self.address.endpoint(1)):
                Path(endpoint.removeprefix("ipc://")).unlink(missing_ok=True)

    def listeners(self) -> int:
        """How many are connected to where snapshots go out."""
        while cast(int, self._comings.getsockopt(zmq.EVENTS)) & _READABLE:
            came = parse_monitor_message(self._comings.recv_multipart(zmq.NOBLOCK))["event"] == zmq.EVENT_ACCEPTED
            self._listeners += 1 if came else -1
        return self._listeners

    def reply(self, identity: bytes, reply: Reply) -> bool:
        """Send to one client, or drop it: who does not read must not hold up the others. False: nobody is there."""
        try:
            self.router.send(identity, zmq.NOBLOCK | zmq.SNDMORE)
            self.router.send(encode(reply), zmq.NOBLOCK)
        except zmq.ZMQError as error:
            if error.errno not in (zmq.EHOSTUNREACH, zmq.EAGAIN):
                raise
            return error.errno == zmq.EAGAIN
        return True

    def is_reachable(self, identity: bytes) -> bool:
        """Whether a client's connection stands."""
        return self.reply(identity, Done(0))

    def poller(self) -> zmq.Poller:
        """For what comes in."""
        poller = zmq.Poller()
        poller.register(self.router, zmq.POLLIN)
        if self.doorkeeper is not None:
            poller.register(self.doorkeeper.socket, zmq.POLLIN)
        return poller

    def _make_router(self, address: Address) -> zmq.Socket[bytes]:
        router = self._make(zmq.ROUTER, address)
        router.setsockopt(zmq.ROUTER_MANDATORY, 1)
        router.setsockopt(zmq.ROUTER_HANDOVER, 1)
        router.setsockopt(zmq.MAXMSGSIZE, LARGEST_MESSAGE)
        router.setsockopt(zmq.RCVHWM, 256)
        router.setsockopt(zmq.SNDHWM, 64)
        router.setsockopt(zmq.RCVTIMEO, WAIT_MS)
        return router

    def _make_publisher(self, address: Address) -> zmq.Socket[bytes]:
        publisher = self._make(zmq.PUB, address)
        publisher.setsockopt(zmq.CONFLATE, 1)
        publisher.setsockopt(zmq.MAXMSGSIZE, 4096)
        return publisher

    def _make(self, kind: int, address: Address) -> zmq.Socket[bytes]:
        socket = self._context.socket(kind)
        socket.setsockopt(zmq.LINGER, 100)
        socket.setsockopt(zmq.IPV6, int(":" in address.host))
        socket.setsockopt(zmq.HEARTBEAT_IVL, 1000)
        socket.setsockopt(zmq.HEARTBEAT_TIMEOUT, 4000)
        if self._keys is not None:
            self._keys.secure(socket)
        return socket

    def _bind_both(self, address: Address) -> tuple[Address, int]:
        """Bind; where it is, and the port of the snapshots."""
        if address.path:
            self.router.bind(address.endpoint())
            self.publisher.bind(address.endpoint(1))
            return address, 1
        anywhere = f"tcp://{address.host}:*"
        self.router.bind(address.endpoint() if address.port else anywhere)
        port = _port(self.router)
        try:
            self.publisher.bind(address.endpoint(port + 1) if address.port else anywhere)
        except zmq.ZMQError as error:
            if error.errno != zmq.EADDRINUSE or not address.is_loopback:
                raise  # other machines are let through to these two ports
            self.publisher.bind(anywhere)
        return Address(address.host, port), _port(self.publisher)


def _why_not(address: Address, error: zmq.ZMQError) -> str:
    """Why a server can't listen on an address: which of its two ports is taken, and which pair is free."""
    if error.errno != zmq.EADDRINUSE or address.path:
        return f"{error.strerror}; stop what is there or name another address"
    taken = address.port if is_taken(address) else address.port + 1
    return (
        f"another program has port {taken} (a server has two, the one named and the one after it, for snapshots); "
        f"stop what is there, or name another, as in: --address {address.host}:{free_port(address)}"
    )


def _port(listener: zmq.Socket[bytes]) -> int:
    """The port that a bound socket got."""
    return int(str(listener.getsockopt_string(zmq.LAST_ENDPOINT)).rpartition(":")[2])
