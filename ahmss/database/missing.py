"""Files that an object.toml names and that are not there: the complaint names its key and line."""

from __future__ import annotations

from pathlib import Path

from ahmss.database.document import Document
from ahmss.database.records import ObjectKind
from ahmss.database.workspace import Workspace

__all__ = ["check_files"]


def check_files(workspace: Workspace, kind: ObjectKind, affordance: str = "") -> None:
    """Whether what a kind names is there: its shape and texture, or the motion of one of its affordances.

    Raises:
        DataError: a file is missing; says which key of which file names it.
    """
    files: dict[tuple[str, ...], Path | None] = {("shape",): kind.shape, ("texture",): kind.texture}
    if affordance:
        files = {("affordances", affordance, "motion"): kind.affordances[affordance].motion}
    for place, path in files.items():
        if path is not None and not path.is_file():
            own = kind.directory / "object.toml"
            raise Document(own, workspace.label(own)).error(place, f"no file {workspace.label(path)}")
