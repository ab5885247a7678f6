"""Seeing that files changed: by modification time, size and inode, cheap enough to look at every command."""

from __future__ import annotations

import os
from collections.abc import Callable, Hashable, Iterable
from pathlib import Path
from typing import Generic, TypeVar

from ahmss.errors import AhmssError

__all__ = ["Fresh", "Stamp", "stamp"]

T = TypeVar("T")
Stamp = tuple[int, int, int] | None


def stamp(path: Path | str) -> Stamp:
    """What changes when the file does; None where there is none."""
    try:
        status = os.stat(path)
    except OSError:
        return None
    return (status.st_mtime_ns, status.st_size, status.st_ino)


class Fresh(Generic[T]):
    """Values made from files, made anew when one of those files changed.

    A failure is remembered too (and raised again) until a file changes, so that a broken file costs nothing.
    """

    def __init__(self) -> None:
        self._made: dict[Hashable, tuple[dict[Path, Stamp], T | None, AhmssError | None]] = {}

    def get(self, key: Hashable, files: Iterable[Path], make: Callable[[set[Path]], T]) -> T:
        """The value for `key`; `make` gets the set of files that the value depends on and may add to it."""
        known = self._made.get(key)
        if known is None or any(stamp(path) != was for path, was in known[0].items()):
            known = self._make(set(files), make)
            self._made[key] = known
        _, value, error = known
        if error is not None:
            raise error.with_traceback(None)
        return value  # type: ignore[return-value]

    def _make(
        self, files: set[Path], make: Callable[[set[Path]], T]
    ) -> tuple[dict[Path, Stamp], T | None, AhmssError | None]:
        stamps = {path: stamp(path) for path in files}  # before reading: a change meanwhile is seen next time
        value: T | None = None
        error: AhmssError | None = None
        try:
            value = make(files)
        except AhmssError as caught:  # kept, and raised at each look-up until the file changes
            error = caught
        return {path: stamps.get(path, stamp(path)) for path in files}, value, error

    def forget(self, keep: set[Hashable]) -> None:
        """Drop what is not in `keep`: the files are gone."""
        for key in set(self._made) - keep:
            del self._made[key]
