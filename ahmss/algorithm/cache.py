"""What the pool reads ahead for those it forks: compiled algorithm files and motion data, while they are unchanged."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path
from types import CodeType
from typing import Any, NamedTuple, TypeVar

from numpy.typing import NDArray

from ahmss.motion import clip as clips
from ahmss.walking import library as libraries

__all__ = ["clip", "code", "known_libraries", "library", "resampled", "touch"]

K = TypeVar("K")
T = TypeVar("T")
_LIMIT = 256  # entries of each kind; the oldest goes first


class _Stamp(NamedTuple):
    """What changes when a file does."""

    changed: int
    size: int
    inode: int


_clips: dict[str, tuple[_Stamp, clips.Clip]] = {}
_resampled: dict[tuple[str, int], tuple[_Stamp, clips.Clip]] = {}
_libraries: dict[str, tuple[_Stamp, libraries.Library | None]] = {}
_contents: dict[bytes, libraries.Library | None] = {}  # by what is in the file: each workspace has a copy of its own
_codes: dict[str, tuple[_Stamp, CodeType]] = {}


def _stamp(path: str) -> _Stamp:
    """The stamp of a file."""
    status = os.stat(path)
    return _Stamp(status.st_mtime_ns, status.st_size, status.st_ino)


def clip(path: str) -> clips.Clip:
    """A motion clip, read again only when its file has changed; its arrays can't be written.

    Raises:
        DataError, OSError: as `ahmss.motion.clip.load`.
    """
    stamp = _stamp(path)
    known = _clips.get(path)
    if known is not None and known[0] == stamp:
        return known[1]
    loaded = _frozen(clips.load(Path(path)))
    _remember(_clips, path, (stamp, loaded))
    return loaded


def resampled(path: str, frames: int) -> clips.Clip:
    """A motion clip in so many frames, made again only when its file has changed; its arrays can't be written.

    Raises:
        DataError, OSError, ValueError: as `ahmss.motion.clip.load` and `ahmss.motion.resample.resample`.
    """
    stamp = _stamp(path)
    known = _resampled.get((path, frames))
    if known is not None and known[0] == stamp:
        return known[1]
    from ahmss.motion.resample import resample  # it brings scipy, which most algorithms do without

    made = _frozen(resample(clip(path), frames))
    _remember(_resampled, (path, frames), (stamp, made))
    return made


def library(path: str) -> libraries.Library | None:
    """A walk library, read again only when its file has changed; its arrays can't be written. None: the file is none.

    Files that say the same are one library.

    Raises:
        DataError, OSError: as `ahmss.walking.library.load`.
    """
    stamp = _stamp(path)
    known = _libraries.get(path)
    if known is not None and known[0] == stamp:
        return known[1]
    digest = hashlib.sha256(Path(path).read_bytes()).digest()
    if digest not in _contents:
        _remember(_contents, digest, _loaded_library(Path(path)))
    _remember(_libraries, path, (stamp, _contents[digest]))
    return _contents[digest]


def _loaded_library(path: Path) -> libraries.Library | None:
    loaded = libraries.load(path) if libraries.is_library(path) else None
    for walk in loaded.clips.values() if loaded is not None else ():
        _freeze(walk.rotations, walk.root, walk.bearing)
    return loaded


def known_libraries() -> list[libraries.Library]:
    """The walk libraries that have been read, each once."""
    return [*{id(loaded): loaded for _, loaded in _libraries.values() if loaded is not None}.values()]


def code(path: str) -> CodeType:
    """The compiled code of a Python file, compiled again only when the file has changed.

    Raises:
        OSError: it can't be read. SyntaxError: it is not Python.
    """
    stamp = _stamp(path)
    known = _codes.get(path)
    if known is not None and known[0] == stamp:
        return known[1]
    compiled = compile(Path(path).read_bytes(), path, "exec", dont_inherit=True)
    _remember(_codes, path, (stamp, compiled))
    return compiled


def touch() -> None:
    """Look at all that is remembered, so that a forked process has copied it before it is needed."""
    for _, loaded in (*_clips.values(), *_resampled.values()):
        loaded.rotations.sum()
        repr(loaded.header)
    for loaded in known_libraries():
        for key, walk in loaded.clips.items():
            hash(key)
            _freeze(walk.rotations, walk.root, walk.bearing)
    for _, compiled in _codes.values():
        hash(compiled)


def _frozen(loaded: clips.Clip) -> clips.Clip:
    """The clip, its arrays not to be written."""
    _freeze(loaded.rotations, loaded.root, loaded.importance, loaded.contacts, loaded.targets)
    return loaded


def _freeze(*arrays: NDArray[Any] | None) -> None:
    for array in arrays:
        if array is not None:
            array.flags.writeable = False


def _remember(cache: dict[K, T], key: K, entry: T) -> None:
    """Put an entry in, and the oldest out where there are too many."""
    cache.pop(key, None)
    cache[key] = entry
    if len(cache) > _LIMIT:
        del cache[next(iter(cache))]
