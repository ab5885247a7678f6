"""objectdb/: the kinds of objects, as their files say now."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import msgspec

from ahmss.body.array import Array
from ahmss.database import store
from ahmss.database.document import one_of
from ahmss.database.footprint import Footprints, Rings
from ahmss.database.freshness import Fresh, Watched
from ahmss.database.missing import check_files
from ahmss.database.objectfile import NAME, read_object
from ahmss.database.placement import Placed, expand
from ahmss.database.records import ObjectKind, Quaternion, Vector
from ahmss.database.shape import Shape, ShapeLoader
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError, CommandError, DataError

__all__ = ["Listing", "ObjectDatabase"]


class Listing(msgspec.Struct, frozen=True):
    """One line of the list: a kind, what it says of itself, and what is wrong with it ("" where nothing is)."""

    name: str
    sentence: str = ""
    error: str = ""


class ObjectDatabase:
    """The kinds of a workspace; one record a kind, shared by all its objects, read anew when its file changes."""

    def __init__(self, workspace: Workspace) -> None:
        self.workspace = workspace
        self.root = workspace.root / "objectdb"
        self._root = str(self.root)
        self._kinds: Fresh[ObjectKind] = Fresh()
        self._shapes = ShapeLoader(workspace)
        self._footprints = Footprints()

    def names(self) -> list[str]:
        """All kinds, broken ones too, in alphabetical order."""
        try:
            return sorted(p.name for p in self.root.iterdir() if NAME.fullmatch(p.name) and _is_entry(p))
        except OSError as error:
            raise DataError("objectdb", "", f"can't be read: {error.strerror}") from None

    def get(self, name: str) -> ObjectKind:
        """The record of a kind.

        Raises:
            CommandError: there is no such kind.
            DataError: its file is wrong.
        """
        path = Path(f"{self._root}/{name}/object.toml")
        if not NAME.fullmatch(name) or not os.path.isfile(path):
            raise CommandError(f'no kind of object "{name}"{one_of(name, self.names())}')
        return self._kinds.get(name, (path,), lambda files: self._read(path, files))

    def _read(self, path: Path, files: Watched) -> ObjectKind:
        label = self.workspace.label(path)
        if not path.resolve().is_relative_to(self.workspace.root):
            raise DataError(label, "", "is a link that leads out of the workspace; copy it in")
        return read_object(self.workspace, path, files)

    def list(self) -> Sequence[Listing]:
        """Every kind with its sentence; a broken one with what is wrong, which never hides the others."""
        out: list[Listing] = []
        for name in self.names():
            try:
                kind = self.get(name)
            except AhmssError as error:
                out.append(Listing(name, error=str(error)))
                continue
            out.append(Listing(name, kind.sentence, self._fault(kind)))
        return out

    def _fault(self, kind: ObjectKind) -> str:
        """What is wrong with what the kind contains, or with the first file that it names and that is not there."""
        try:
            self.place(kind.name, kind.name)
            for affordance in ("", *kind.affordances):
                check_files(self.workspace, kind, affordance)
        except AhmssError as error:
            return str(error)
        return ""

    def place(
        self, kind: str, name: str, position: Vector = (0.0, 0.0, 0.0), rotation: Quaternion = (1.0, 0.0, 0.0, 0.0)
    ) -> tuple[Placed, ...]:
        """The object and all that it contains, parents first, with their poses in the world.

        Raises:
            CommandError, DataError: a kind is unknown or broken, or objects contain each other in a circle.
        """
        return expand(self.get, self.workspace.label, kind, name, position, rotation)

    def shape(self, kind: str) -> Shape | None:
        """The shape of a kind as it is to be shown, or None for a kind without one.

        Raises:
            DataError: the shape or texture file is missing or not fit to be shown; says why.
        """
        return self._shapes.get(self.get(kind))

    def kept_shape(self, kind: str) -> tuple[Path, str] | None:
        """Where the shape of a kind is kept as a GLB, and its SHA-256; None without a shape, or where the disk is full.

        Raises:
            CommandError, DataError: as `shape`.
        """
        shape = self.shape(kind)
        if shape is None:
            return None
        path = store.place("meshes", f"{shape.hash}.glb")
        if not path.is_file():
            store.keep(path, shape.glb)
        return (path, shape.hash) if path.is_file() else None

    def footprint(self, kind: str, height: float, rotation: Array) -> Rings:
        """The area on the floor that an object of a kind occupies for one who walks; none for a kind without a shape.

        Args:
            kind: of the object.
            height: of its origin over the floor, metres.
            rotation: (4,) world <- object.

        Returns:
            Outlines in the object's frame, which is turned about z only (see `ahmss.database.footprint`), metres.

        Raises:
            CommandError, DataError: as `shape`.
        """
        shape = self.shape(kind)
        if shape is None:
            return ()
        return self._footprints.of(shape, height, rotation)


def _is_entry(path: Path) -> bool:
    return (path / "object.toml").is_file()
