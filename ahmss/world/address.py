"""Where a server is: what a person types, and what ZeroMQ wants."""

from __future__ import annotations

from dataclasses import dataclass

from ahmss.errors import CommandError

__all__ = ["PORT", "Address", "parse"]

PORT = 7417
"""Requests and frames; snapshots are on the port after it."""

_LOOPBACK = ("127.", "localhost", "[::1]")


@dataclass(frozen=True)
class Address:
    """A host and the port of its requests; port 0 lets the system choose both ports."""

    host: str = "127.0.0.1"
    port: int = PORT

    @property
    def is_loopback(self) -> bool:
        """Whether only programs on this machine can reach it."""
        return self.host.startswith(_LOOPBACK)

    def endpoint(self, port: int | None = None) -> str:
        """What ZeroMQ binds or connects to."""
        return f"tcp://{self.host}:{self.port if port is None else port}"

    def __str__(self) -> str:
        """HOST:PORT."""
        return f"{self.host}:{self.port}"


def parse(text: str) -> Address:
    """`HOST`, `HOST:PORT`, `tcp://HOST:PORT` or nothing (this machine, the usual port).

    Raises:
        CommandError: the port is no number between 0 and 65534.
    """
    bare = text.removeprefix("tcp://").strip().rstrip("/")
    host, separator, port = bare.rpartition(":")
    if not separator or bare.endswith("]"):
        host, port = bare, str(PORT)
    host = "127.0.0.1" if host in ("", "localhost") else host
    if not port.isdigit() or int(port) > 65534:
        raise CommandError(f'server address "{text}": "{port}" is no port; write HOST or HOST:PORT with 0 to 65534')
    return Address(host, int(port))
