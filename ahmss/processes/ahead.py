"""What the pool learns from each request, for the workers that it forks after it."""

from __future__ import annotations

import ast
import contextlib
import importlib
from pathlib import Path

from ahmss.algorithm import cache
from ahmss.processes.child import Request

__all__ = ["learn"]

# Imported ahead; an author's own modules are read anew at each start.
_INSTALLED = (
    "ahmss.algorithm",
    "ahmss.skills",
    "ahmss.body",
    "ahmss.motion",
    "ahmss.walking",
    "ahmss.grasping",
    "ahmss.reaching",
    "numpy",
    "scipy",
    "shapely",
)
_LARGEST = 2000  # frames of a clip that is resampled ahead
_learned: set[tuple[str, int, int]] = set()


def learn(request: Request) -> bool:
    """Compile the program, import the libraries that it names, read its clips; True if any of it was new.

    What can't be read is left for the worker to stumble over, which has somebody to tell. `others` likewise.
    """
    news = False
    for other in request.others:
        news |= learn(other)
    for path, frames in (
        *((path, 0) for path in request.argv[:1]),
        *((clip, request.frames) for clip in request.clips),
    ):
        with contextlib.suppress(OSError):
            stamp = (path, Path(path).stat().st_mtime_ns, frames)
            if stamp not in _learned:
                _learned.add(stamp)
                news = True
                _read(path, frames)
    return news


def _read(path: str, frames: int) -> None:
    """Take a file into memory."""
    with contextlib.suppress(Exception):
        if path.endswith(".npz"):
            if cache.library(path) is None and cache.clip(path).header.times is None and 0 < frames <= _LARGEST:
                cache.resampled(path, frames + 1)  # the pose of frame 0 and those to be made
            return
        cache.code(path)
        for name in _imports(ast.parse(Path(path).read_bytes())):
            with contextlib.suppress(ImportError):
                importlib.import_module(name)


def _imports(tree: ast.Module) -> list[str]:
    """The installed modules that a program imports at its top."""
    names: list[str] = []
    for node in tree.body:
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            names.append(node.module)
    return [name for name in names if f"{name}.".startswith(tuple(f"{package}." for package in _INSTALLED))]
