"""`ahmss list` and `ahmss check`: what there is, and what is wrong with it."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import msgspec
from rich.console import Console
from rich.table import Table

from ahmss.database.algorithms import NotBuilt
from ahmss.database.check import check
from ahmss.database.objects import Listing
from ahmss.database.records import AlgorithmEntry, ObjectKind
from ahmss.database.workspace import Workspace
from ahmss.errors import CommandError
from ahmss.main.afforded import sentence_of
from ahmss.main.counting import counted

__all__ = ["check_workspace", "list_workspace", "show_table"]

Rows = list[dict[str, Any]]
_ERROR = "error"


def list_workspace(what: str, directory: Path | None, *, as_json: bool) -> None:
    """List kinds of objects, humans and algorithms, or what one kind affords."""
    workspace = Workspace.find(directory)
    readers = {"objects": _objects, "humans": _humans, "algorithms": _algorithms}
    if what and what not in readers:
        if what not in workspace.objects.names():
            kinds = ", ".join(workspace.objects.names())
            lists = " or ".join(readers)
            raise CommandError(f'no list "{what}"; type {lists}, or a kind of object to see what it affords: {kinds}')
        tables = {what: _actions(workspace, workspace.objects.get(what))}
    else:
        tables = {name: read(workspace) for name, read in readers.items() if what in ("", name)}
    if as_json:
        print(json.dumps(tables))
        return
    for title, rows in tables.items():
        show_table(title, [_shown(row) for row in rows])


def check_workspace(directory: Path | None, *, as_json: bool) -> int:
    """Read everything through; returns the number of problems."""
    workspace = Workspace.find(directory)
    report = check(workspace)
    if as_json:
        print(msgspec.json.encode(report).decode())
        return len(report.problems)
    for problem in report.problems:
        print(problem)
    for note in report.notes:
        print(f"note: {note}")
    print(
        f"{report.objects} objects, {report.humans} humans, {report.algorithms} algorithms, {report.motions} motions: "
        + (counted(len(report.problems), "problem") if report.problems else "nothing is wrong")
    )
    return len(report.problems)


def show_table(title: str, rows: Rows) -> None:
    """A table for a person; plain lines where the output is no terminal."""
    if not rows:
        print(f"{title}: none")
        return
    if not sys.stdout.isatty():
        for row in rows:
            print("\t".join(str(value) for value in row.values()))
        return
    table = Table(title=title, title_justify="left")
    for i, name in enumerate(rows[0]):
        table.add_column(name, no_wrap=i == 0)
    for row in rows:
        table.add_row(*(str(value) for value in row.values()))
    Console().print(table)


def _shown(row: dict[str, Any]) -> dict[str, Any]:
    """A row as a person reads it."""
    shown = {key: value for key, value in row.items() if key != _ERROR}
    if shown.get("frames") == 0:
        shown["frames"] = "as needed"
    return shown


def _objects(workspace: Workspace) -> Rows:
    return [_row(entry) for entry in workspace.objects.list()]


def _humans(workspace: Workspace) -> Rows:
    return [_row(entry) for entry in workspace.humans.list()]


def _row(entry: Listing) -> dict[str, Any]:
    """What is wrong stands where a person looks for the sentence, and by itself for a program."""
    row = {"name": entry.name, "sentence": entry.error or entry.sentence}
    return row | ({_ERROR: entry.error} if entry.error else {})


def _algorithms(workspace: Workspace) -> Rows:
    rows: Rows = []
    for entry in workspace.algorithms.list():
        if isinstance(entry, AlgorithmEntry):
            rows.append({"name": entry.name, "kind": entry.kind, "sentence": entry.sentence})
        elif isinstance(entry, NotBuilt):
            rows.append({"name": entry.name, "kind": entry.kind, "sentence": entry.message})
        else:
            rows.append({"name": Path(entry.file).parent.name, "kind": "broken", "sentence": str(entry)})
    return rows


def _actions(workspace: Workspace, kind: ObjectKind) -> Rows:
    return [
        {
            "action": action.name, "sentence": sentence_of(workspace, kind, action), "asks": ", ".join(action.asks),
            "frames": action.frames,
            "algorithms": f"as its {action.of} affords it"
            if action.of
            else " + ".join(filter(None, (action.human_algorithm, action.object_algorithm))),
        }
        for action in kind.affordances.values()
    ]  # fmt: skip
