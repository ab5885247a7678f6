"""What was made of users' files, kept on disk between runs; all of it may be deleted at any time."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

__all__ = ["keep", "place", "take"]


def place(what: str, digest: str) -> Path:
    """Where a thing of a kind (`shapes`) is kept, by a digest of all that it was made of."""
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "ahmss" / what / digest


def take(path: Path) -> bytes | None:
    """What is kept there; None where nothing is."""
    try:
        return path.read_bytes()
    except OSError:
        return None


def keep(path: Path, data: bytes) -> None:
    """Keep it, whole or not at all; a disk that is full or read-only costs only the time to make it again."""
    part = path.with_suffix(f".{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part.write_bytes(data)
        os.replace(part, path)
    except OSError:
        with contextlib.suppress(OSError):
            part.unlink()
