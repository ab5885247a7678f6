"""A workspace: the folder with objectdb/, humandb/ and algorithms/, and the border that no data file crosses."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from ahmss.errors import WorkspaceError

if TYPE_CHECKING:
    from ahmss.database.algorithms import AlgorithmFinder
    from ahmss.database.humans import HumanDatabase
    from ahmss.database.objects import ObjectDatabase

__all__ = ["Workspace"]

_PACKAGE = Path(__file__).resolve().parent.parent


class Workspace:
    """The three databases under one root; each look-up sees what the files say now.

    Args:
        root: the folder that holds objectdb/.

    Raises:
        WorkspaceError: there is no objectdb/ in it.
    """

    def __init__(self, root: Path) -> None:
        self.root = Path(root).resolve()
        if not (self.root / "objectdb").is_dir():
            raise WorkspaceError(f"{root}: no workspace, it has no objectdb/; `ahmss init {root}` lays one out")

    @classmethod
    def find(cls, directory: Path | None = None, start: Path | None = None) -> Workspace:
        """The workspace that is meant: `directory`, else the nearest upwards from `start` (the current directory),
        else the checkout that this code runs from, else the data installed with the package."""
        if directory is not None:
            return cls(directory)
        here = (start or Path.cwd()).resolve()
        for candidate in (here, *here.parents, _PACKAGE.parent, _PACKAGE / "workspace"):
            if (candidate / "objectdb").is_dir() and (candidate / "algorithms").is_dir():
                return cls(candidate)
        raise WorkspaceError(f"no workspace in {here} or above it; `ahmss init DIR` lays one out")

    @cached_property
    def objects(self) -> ObjectDatabase:
        """The kinds of objects in objectdb/."""
        from ahmss.database.objects import ObjectDatabase

        return ObjectDatabase(self)

    @cached_property
    def humans(self) -> HumanDatabase:
        """The humans in humandb/."""
        from ahmss.database.humans import HumanDatabase

        return HumanDatabase(self)

    @cached_property
    def algorithms(self) -> AlgorithmFinder:
        """The algorithms of objects' own folders, objectdb/ and algorithms/."""
        from ahmss.database.algorithms import AlgorithmFinder

        return AlgorithmFinder(self)

    def label(self, path: Path) -> str:
        """How messages name a file: its path from the workspace."""
        return str(path.relative_to(self.root)) if path.is_relative_to(self.root) else str(path)

    def inside(self, base: Path, path: str) -> Path:
        """The file that a data file in folder `base` means by `path`, with every symbolic link followed.

        Raises:
            WorkspaceError: it is absolute, or leads out of the workspace.
        """
        if not path or "\0" in path:
            raise WorkspaceError(f"{path!r} is no file name")
        if Path(path).is_absolute() or "\\" in path or (len(path) > 1 and path[1] == ":"):
            raise WorkspaceError(f'"{path}" is an absolute path; give one from the folder of this file, with /')
        try:
            real = (base / path).resolve()
        except (OSError, RuntimeError):
            raise WorkspaceError(f'"{path}" is a chain of links without an end') from None
        if not real.is_relative_to(self.root):
            raise WorkspaceError(f'"{path}" leads out of the workspace; copy the file into it')
        return real
