"""Finding algorithm programs in folders: the object's own, then objectdb/, then algorithms/."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

import msgspec

from ahmss.database.document import Document, one_of
from ahmss.database.freshness import Fresh
from ahmss.database.objectfile import NAME
from ahmss.database.parameter import Parameter
from ahmss.database.records import AlgorithmEntry
from ahmss.database.workspace import Workspace
from ahmss.errors import CommandError, DataError, WorkspaceError

__all__ = ["AlgorithmFile", "AlgorithmFinder", "NotBuilt", "ParameterEntry"]


class NotBuilt(DataError):
    """The program is to be compiled first; its folder has a Makefile."""

    name = ""
    kind = ""


class ParameterEntry(msgspec.Struct, forbid_unknown_fields=True):
    """[parameters.NAME] of algorithm.toml."""

    type: Literal["float", "int", "bool", "str", "floats"]
    default: Any = None
    minimum: float | None = None
    maximum: float | None = None
    unit: str = ""
    sentence: str = ""
    bounds: str = ""


class AlgorithmFile(msgspec.Struct, forbid_unknown_fields=True):
    """algorithm.toml."""

    kind: Literal["human", "object"]
    argv: list[str]
    name: str | None = None
    sentence: str = ""
    world: Literal["none", "near", "all"] = "near"
    footprints: bool = False
    humans: bool = False
    ways: bool = False
    shape: bool = False
    shapes: bool = False
    carries: bool = False
    accompanies: bool = False
    stretches: bool = False
    rests: bool = False
    arrives: bool = False
    arms: bool = False
    fewest: float = 0.0
    catches: bool = False
    parameters: dict[str, dict[str, Any]] = {}


class AlgorithmFinder:
    """Looks algorithms up by name; a folder with algorithm.toml, or a bare executable."""

    def __init__(self, workspace: Workspace) -> None:
        self.workspace = workspace
        self._entries: Fresh[AlgorithmEntry] = Fresh()

    def find(self, name: str, directory: Path | None = None) -> AlgorithmEntry:
        """The algorithm that an object in `directory` (objectdb/<kind>) means by `name`.

        Raises:
            CommandError: there is none of that name.
            DataError: its algorithm.toml is wrong.
        """
        if NAME.fullmatch(name):
            for base in self._bases(directory):
                found = self._entry(base, name)
                if found is not None:
                    return found
        where = [self.workspace.label(base) for base in self._bases(directory)]
        raise CommandError(f'no algorithm "{name}" in {", ".join(where)}{one_of(name, self.names(directory))}')

    def names(self, directory: Path | None = None) -> list[str]:
        """The algorithms that an object in `directory` may name, in alphabetical order."""
        names: set[str] = set()
        for base in self._bases(directory):
            names |= {path.name for path in _children(base) if NAME.fullmatch(path.name) and _is_algorithm(path)}
        return sorted(names)

    def list(self) -> list[AlgorithmEntry | DataError]:
        """Every algorithm of the workspace, objects' own too; for a broken one its error."""
        out: list[AlgorithmEntry | DataError] = []
        folders: list[Path | None] = [None, *(p for p in _children(self.workspace.root / "objectdb") if p.is_dir())]
        for directory in folders:
            bases = self._bases(None) if directory is None else (directory,)
            for base in bases:
                for path in _children(base):
                    if NAME.fullmatch(path.name) and _is_algorithm(path):
                        try:
                            entry = self._entry(base, path.name)
                        except DataError as error:
                            out.append(error)
                        else:
                            out += [entry] if entry else []
        return out

    def _bases(self, directory: Path | None) -> tuple[Path, ...]:
        own = () if directory is None else (directory,)
        return (*own, self.workspace.root / "objectdb", self.workspace.root / "algorithms")

    def _entry(self, base: Path, name: str) -> AlgorithmEntry | None:
        file = base / name / "algorithm.toml"
        if file.is_file():
            return self._entries.get(file, (file,), lambda _: self._read(file, name))
        for path in (base / name, base / name / name):
            if _is_program(path):
                self._stay_inside(path)
                return AlgorithmEntry(name, "", (str(path),), path.parent)
        return None

    def _stay_inside(self, path: Path) -> None:
        if not path.resolve().is_relative_to(self.workspace.root):
            raise DataError(self.workspace.label(path), "", "is a link that leads out of the workspace; copy it in")

    def _read(self, file: Path, name: str) -> AlgorithmEntry:
        self._stay_inside(file)
        document = Document(file, self.workspace.label(file))
        top = document.convert(document.data, AlgorithmFile)
        if top.name is not None and top.name != name:
            raise document.error(("name",), f'"{top.name}" is not the name of its folder, "{name}"; make them the same')
        parameters = {n: _parameter(document, n, raw) for n, raw in top.parameters.items()}
        argv = self._argv(document, top.argv)
        if top.ways and not top.humans:
            raise document.error(("ways",), "asks where the other humans mean to be; add `humans = true`")
        if top.arms and not top.humans:
            raise document.error(("arms",), "asks where the other humans' arms are; add `humans = true`")
        if top.shapes and not top.footprints:
            raise document.error(("shapes",), "asks for the shapes of what occupies the floor; add `footprints = true`")
        if not 0.0 <= top.fewest <= 1.0:
            raise document.error(("fewest",), f"{top.fewest:g} is no share of the action's frames; allowed: 0 to 1")
        body = (top.carries, top.accompanies, top.ways, top.stretches, top.rests, top.arrives, top.arms, top.fewest)
        if top.catches and top.kind != "object":
            raise document.error(("catches",), "is what an object does; leave it out of a human's algorithm")
        asks = (top.world, top.footprints, top.humans, top.shape, *body, top.catches, top.shapes)
        return AlgorithmEntry(name, top.kind, argv, file.parent, top.sentence, parameters, *asks)

    def _argv(self, document: Document, argv: list[str]) -> tuple[str, ...]:
        """The program as it is to be started: the pool's Python, a file of the folder, or a name on the PATH."""
        if not argv or not argv[0]:
            raise document.error(("argv",), 'names the program, as ["python", "nod.py"] or ["./nod"]')
        folder = document.path.parent
        script = argv[1] if argv[0] == "python" and len(argv) > 1 else argv[0]
        if argv[0] == "python" and len(argv) == 1:
            raise document.error(("argv",), 'names no script; write ["python", "nod.py"]')
        if argv[0] != "python" and "/" not in script and not (folder / script).exists():
            return tuple(argv)
        try:
            path = self.workspace.inside(folder, script)
        except WorkspaceError as error:
            raise document.error(("argv",), str(error)) from None
        if not path.is_file() and (folder / "Makefile").is_file():
            place = f"{self.workspace.label(folder)}"
            error = NotBuilt(document.label, "argv", f'"{script}" is not built yet; type: make -C {place}')
            error.name, error.kind = folder.name, str(document.data.get("kind", ""))
            raise error
        if not path.is_file():
            raise document.error(("argv",), f'no file "{script}" in {self.workspace.label(folder)}')
        if argv[0] == "python":
            return tuple(argv)
        if not os.access(path, os.X_OK):
            raise document.error(("argv",), f'"{script}" may not be executed; chmod +x it')
        return (str(path), *argv[1:])


def _parameter(document: Document, name: str, raw: dict[str, Any]) -> Parameter:
    place = ("parameters", name)
    entry = document.convert(raw, ParameterEntry, place)
    parameter = Parameter(entry.type, None, entry.minimum, entry.maximum, entry.unit, entry.sentence, entry.bounds)
    if entry.default is None:
        return parameter
    try:
        return msgspec.structs.replace(parameter, default=parameter.convert(entry.default))
    except ValueError as error:
        raise document.error((*place, "default"), str(error)) from None


def _children(base: Path) -> Iterator[Path]:
    try:
        yield from sorted(base.iterdir())
    except OSError:
        return


def _is_program(path: Path) -> bool:
    return path.is_file() and os.access(path, os.X_OK)


def _is_algorithm(path: Path) -> bool:
    return (path / "algorithm.toml").is_file() or _is_program(path) or _is_program(path / path.name)
