"""Seeing that files changed: by modification time, size and inode, cheap enough to look at every command."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from ahmss.errors import AhmssError

__all__ = ["Fresh", "Stamp", "Watched", "stamp"]

T = TypeVar("T")
Stamp = tuple[int, int, int] | None
_GRAIN = 50_000_000  # nanoseconds: a file may change again within the grain of its clock and look the same


def stamp(path: Path | str) -> Stamp:
    """What changes when the file does; None where there is none."""
    try:
        status = os.stat(path)
    except OSError:
        return None
    return (status.st_mtime_ns, status.st_size, status.st_ino)


class Watched(dict[Path, Stamp]):
    """The files that a value depends on, each as it was just before it was read."""

    def add(self, path: Path) -> None:
        """Depend on this file too; call it before reading."""
        self.setdefault(path, stamp(path))

    def changed(self) -> bool:
        """Whether one of them is another now."""
        return any(stamp(path) != was for path, was in self.items())

    def young(self, now: int) -> bool:
        """Whether one had been written so shortly before `now` that a later change may not show."""
        return any(was is not None and was[0] > now - _GRAIN for was in self.values())


@dataclass
class _Made(Generic[T]):
    """A value or the failure to make it, and whether its files were too young to be sure of."""

    files: Watched
    young: bool
    value: T | None = None
    error: AhmssError | None = None


class Fresh(Generic[T]):
    """Values made from files, made anew when one of those files changed.

    A failure is remembered too (and raised again) until a file changes, so that a broken file costs nothing.
    """

    def __init__(self) -> None:
        self._made: dict[Hashable, _Made[T]] = {}

    def get(self, key: Hashable, files: Iterable[Path], make: Callable[[Watched], T]) -> T:
        """The value for `key`; `make` gets what it depends on and adds to it what else it reads."""
        known = self._made.get(key)
        if known is None or known.young or known.files.changed():
            made = self._make(files, make)
            if known is not None and known.value is not None and made.value == known.value:
                made.value = known.value  # the same record, so that it stays shared
            self._made[key] = known = made
        if known.error is not None:
            raise known.error.with_traceback(None)
        return known.value  # type: ignore[return-value]

    def _make(self, files: Iterable[Path], make: Callable[[Watched], T]) -> _Made[T]:
        now = time.time_ns()
        watched = Watched()
        for path in files:
            watched.add(path)
        try:
            value = make(watched)
        except AhmssError as error:  # kept, and raised at each look-up until the file changes
            return _Made(watched, watched.young(now), error=error)
        return _Made(watched, watched.young(now), value)
