"""Lets in clients whose keys are authorised: ZeroMQ's authentication protocol (ZAP), answered in the server's loop."""

from __future__ import annotations

import zmq
from zmq.utils.z85 import encode

__all__ = ["Doorkeeper"]


class Doorkeeper:
    """Answers ZeroMQ's question for each new connection: may this key in?

    Made before the server's sockets bind. `socket` is polled; `answer` is called when it has something.
    """

    def __init__(self, context: zmq.Context[zmq.Socket[bytes]], authorised: frozenset[bytes]) -> None:
        self._authorised = authorised
        self.refused = 0
        self.socket = context.socket(zmq.ROUTER)
        self.socket.setsockopt(zmq.LINGER, 0)
        self.socket.bind("inproc://zeromq.zap.01")

    def answer(self) -> None:
        """Answer all questions that wait."""
        while True:
            try:
                parts = self.socket.recv_multipart(zmq.NOBLOCK)
            except zmq.Again:
                return
            envelope, (version, number, _domain, _address, _identity, mechanism, *credentials) = parts[:2], parts[2:]
            key = encode(credentials[0]) if mechanism == b"CURVE" and credentials else b""
            known = key in self._authorised
            self.refused += not known
            verdict = [b"200", b"OK", b"client"] if known else [b"400", b"this key is not authorised", b""]
            self.socket.send_multipart([*envelope, version, number, *verdict, b""])

    def close(self) -> None:
        """Close the socket."""
        self.socket.close()
