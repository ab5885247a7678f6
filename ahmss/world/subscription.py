"""The snapshots that a server publishes, the newest alone; followed where a restarted server has them elsewhere."""

from __future__ import annotations

from typing import cast

import zmq

from ahmss.world.address import Address
from ahmss.world.keys import ClientKeys
from ahmss.world.schema import Snapshot, decode_snapshot

__all__ = ["Subscription"]

_READABLE = int(zmq.POLLIN)
_RECONNECT_MS = (50, 1000)


class Subscription:
    """A SUB socket, from the first `follow` on; `socket` is None before.

    Args:
        address: the server's.
        keys: this client's keys and the server's public key, where the server asks for them.
    """

    def __init__(self, context: zmq.Context[zmq.Socket[bytes]], address: Address, keys: ClientKeys | None) -> None:
        self.socket: zmq.Socket[bytes] | None = None
        self._context, self._address, self._keys = context, address, keys
        self._port = 0

    def follow(self, port: int) -> None:
        """Follow what is published on this port of the server's host."""
        if port == self._port:
            return
        self.close()
        socket = self._context.socket(zmq.SUB)
        socket.setsockopt(zmq.LINGER, 0)
        socket.setsockopt(zmq.CONFLATE, 1)
        socket.setsockopt(zmq.RECONNECT_IVL, _RECONNECT_MS[0])
        socket.setsockopt(zmq.RECONNECT_IVL_MAX, _RECONNECT_MS[1])
        socket.setsockopt(zmq.SUBSCRIBE, b"")
        if self._keys is not None:
            self._keys.secure(socket)
        socket.connect(self._address.endpoint(port))
        self.socket, self._port = socket, port

    def take(self) -> Snapshot | None:
        """The newest that has come since the last call, or None. Never blocks.

        Raises:
            ProtocolError: what has come is no snapshot.
        """
        if self.socket is None or not cast(int, self.socket.getsockopt(zmq.EVENTS)) & _READABLE:
            return None
        return decode_snapshot(self.socket.recv(zmq.NOBLOCK))

    def close(self) -> None:
        """Close the socket."""
        if self.socket is not None:
            self.socket.close(0)
            self.socket = None
