"""Where a server is: what a person types, and what ZeroMQ wants."""

from __future__ import annotations

from dataclasses import dataclass

from ahmss.errors import CommandError

__all__ = ["PORT", "Address", "parse"]

PORT = 7417
"""Requests and frames; snapshots are on the port after it."""

_LONGEST_PATH = 90
_LOOPBACK = ("127.", "localhost", "[::1]")


@dataclass(frozen=True)
class Address:
    """A host and the port of its requests; port 0 lets the system choose both ports.

    With a `path` it is a socket in the file system instead, which is faster and for this machine only.
    """

    host: str = "127.0.0.1"
    port: int = PORT
    path: str = ""

    @property
    def is_loopback(self) -> bool:
        """Whether only programs on this machine can reach it."""
        return bool(self.path) or self.host.startswith(_LOOPBACK)

    def endpoint(self, port: int | None = None) -> str:
        """What ZeroMQ binds or connects to; `port` is that of the snapshots."""
        if self.path:
            return f"ipc://{self.path}" + (".snapshots" if port else "")
        return f"tcp://{self.host}:{self.port if port is None else port}"

    def __str__(self) -> str:
        """What `parse` takes."""
        return f"ipc://{self.path}" if self.path else f"{self.host}:{self.port}"


def parse(text: str) -> Address:
    """`HOST`, `HOST:PORT`, `tcp://HOST:PORT`, `ipc://PATH`, or nothing (this machine, the usual port).

    Raises:
        CommandError: the port is no number between 0 and 65534, or the path is too long for a socket.
    """
    if text.startswith("ipc://"):
        path = text.removeprefix("ipc://")
        if not 0 < len(path.encode()) <= _LONGEST_PATH:
            raise CommandError(f'server address "{text}": the path of a socket has 1 to {_LONGEST_PATH} bytes')
        return Address(path=path)
    bare = text.removeprefix("tcp://").strip().rstrip("/")
    host, separator, port = bare.rpartition(":")
    if not separator or bare.endswith("]"):
        host, port = bare, str(PORT)
    host = "127.0.0.1" if host in ("", "localhost") else host
    if not port.isdigit() or int(port) > 65534:
        raise CommandError(f'server address "{text}": "{port}" is no port; write HOST or HOST:PORT with 0 to 65534')
    return Address(host, int(port))
