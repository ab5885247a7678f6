"""Hosts and ports of this machine: which there are, which are taken, and where a server finds its two."""

from __future__ import annotations

import errno
import socket

from ahmss.errors import WorldError
from ahmss.world.address import PORT, Address

__all__ = ["check_host", "free_port", "is_taken"]

_STEP = 100  # from one server to the next that is proposed
_LAST = 65_000


def check_host(address: Address) -> None:
    """WorldError: the host is neither a number nor a name that is known here."""
    try:
        socket.getaddrinfo(address.host.strip("[]"), None)
    except OSError:
        raise WorldError(f'"{address.host}" is no address that is known here; write it as 127.0.0.1:{PORT}') from None


def is_taken(address: Address) -> bool:
    """Whether another program listens on the port of an address of this machine; one in the file system is not."""
    return not address.path and not _binds(address.host, address.port)


def free_port(address: Address) -> int:
    """The next port on which a server could listen beside what has this one: it and the one after it are free.

    Raises:
        WorldError: there is none.
    """
    for port in range(address.port + _STEP, _LAST, _STEP):
        if _binds(address.host, port) and _binds(address.host, port + 1):
            return port
    raise WorldError(f"no two ports side by side are free on {address.host} above {address.port}")


def _binds(host: str, port: int) -> bool:
    """Whether a program could listen there now."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((host.strip("[]"), port))
        except OSError as error:
            return error.errno != errno.EADDRINUSE
    return True
