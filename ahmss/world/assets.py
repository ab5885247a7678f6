"""Shapes, textures and skeleton records by the hash of their content, in memory or in a directory."""

from __future__ import annotations

import os
from pathlib import Path

from ahmss.errors import WorldError
from ahmss.world.schema import content_hash

__all__ = ["LARGEST_ASSET", "Assets"]

LARGEST_ASSET = 64 << 20
_MOST_BYTES = 2 << 30
_MOST_UNDER_WAY = 128 << 20
_HASH_LENGTH = 64
_HEX = frozenset("0123456789abcdef")


class Assets:
    """What clients have sent, kept for viewers, recordings and restarts.

    Args:
        directory: where they stay over a restart; None keeps them in memory.
    """

    def __init__(self, directory: Path | None) -> None:
        self._directory = directory
        self._sizes: dict[str, int] = {}
        self._kept: dict[str, bytes] = {}
        self._parts: dict[tuple[bytes, str], bytearray] = {}
        if directory is not None:
            directory.mkdir(parents=True, exist_ok=True)
            self._sizes = {p.name: p.stat().st_size for p in directory.iterdir() if _is_hash(p.name)}

    def has(self, name: str) -> bool:
        """Whether all of it is here."""
        return name in self._sizes

    def size(self, name: str) -> int:
        """Its bytes. WorldError: not here."""
        if name not in self._sizes:
            raise WorldError(f"the server has no asset {name[:12]}; the main that shows it must send it")
        return self._sizes[name]

    def get(self, name: str) -> bytes | None:
        """All of it, or None where it is not here."""
        if name in self._kept:
            return self._kept[name]
        if self._directory is None or name not in self._sizes:
            return None
        return (self._directory / name).read_bytes()

    def part(self, name: str, offset: int, length: int) -> bytes:
        """At most `length` bytes of it. WorldError: not here."""
        self.size(name)
        if name in self._kept or self._directory is None:
            return self._kept[name][offset : offset + length]
        try:
            with (self._directory / name).open("rb") as file:
                file.seek(offset)
                return file.read(length)
        except OSError as error:
            raise WorldError(f"the server can't read asset {name[:12]}: {error.strerror}; send it again") from error

    def put(self, sender: bytes, name: str, size: int, offset: int, data: bytes) -> int:
        """Take a part; how many bytes of it are here now (all of them, where it was known). WorldError: refused."""
        if name in self._sizes:
            return self._sizes[name]
        if not _is_hash(name) or not 0 < size <= LARGEST_ASSET:
            raise WorldError(f"asset {name[:12]} is refused: a name is a SHA-256, a size 1 to {LARGEST_ASSET} bytes")
        key = (sender, name)
        have = self._parts.get(key, bytearray())
        if offset != len(have) or not data:
            return len(have)
        if len(have) + len(data) > size:
            self._parts.pop(key, None)
            raise WorldError(f"asset {name[:12]} is longer than it said; send it again")
        if sum(map(len, self._parts.values())) + len(data) > _MOST_UNDER_WAY:
            raise WorldError("too many assets are on their way at once; try again in a moment")
        self._parts[key] = have
        have += data
        if len(have) == size:
            del self._parts[key]
            self._keep(name, bytes(have))
            return size
        return len(have)

    def forget(self, sender: bytes) -> None:
        """Drop what a client that is gone has sent in part."""
        for key in [key for key in self._parts if key[0] == sender]:
            del self._parts[key]

    def _keep(self, name: str, data: bytes) -> None:
        if content_hash(data) != name:
            raise WorldError(f"asset {name[:12]} came damaged: its content has another hash; send it again")
        if sum(self._sizes.values()) + len(data) > _MOST_BYTES:
            raise WorldError(f"the server keeps {_MOST_BYTES >> 20} MB of shapes and textures and has no room for more")
        if self._directory is None:
            self._kept[name] = data
        else:
            try:
                part = self._directory / f"{name}.part"
                part.write_bytes(data)
                os.replace(part, self._directory / name)
            except OSError as error:
                reason = error.strerror
                raise WorldError(f"the server can't keep asset {name[:12]}: {reason}; free some space") from error
        self._sizes[name] = len(data)


def _is_hash(name: str) -> bool:
    """Also keeps a name from leading out of the directory."""
    return len(name) == _HASH_LENGTH and set(name) <= _HEX
