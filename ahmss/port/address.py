"""Where a main's port is: what a person types."""

from __future__ import annotations

from ahmss.port.schema import PORT
from ahmss.world.address import Address, parse

__all__ = ["address_of"]


def address_of(text: str) -> Address:
    """`PORT`, or what a server's address may be; nothing is the usual port of this machine.

    Raises:
        CommandError: it is none.
    """
    bare = text.strip()
    if not bare or bare.isdigit():
        return parse(f"127.0.0.1:{bare or PORT}")
    return parse(bare if ":" in bare.removeprefix("tcp://") else f"{bare}:{PORT}")
