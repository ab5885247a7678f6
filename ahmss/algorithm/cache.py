"""What the pool reads ahead for those it forks: compiled algorithm files and motion clips, while they are unchanged."""

from __future__ import annotations

import os
from pathlib import Path
from types import CodeType
from typing import NamedTuple, TypeVar

from ahmss.motion import clip as clips

__all__ = ["clip", "code", "resampled", "touch"]

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
    for _, compiled in _codes.values():
        hash(compiled)


def _frozen(loaded: clips.Clip) -> clips.Clip:
    """The clip, its arrays not to be written."""
    for array in (loaded.rotations, loaded.root, loaded.importance, loaded.contacts, loaded.targets):
        if array is not None:
            array.flags.writeable = False
    return loaded


def _remember(cache: dict[K, T], key: K, entry: T) -> None:
    """Put an entry in, and the oldest out where there are too many."""
    cache.pop(key, None)
    cache[key] = entry
    if len(cache) > _LIMIT:
        del cache[next(iter(cache))]
