"""Tables 5.5 to 5.8 of the thesis (Ichiguchi 2000, 5.4.1), row by row, beside what was measured here.

Its computers were a PC with two Pentium III of 700 MHz for everything but the pictures, and an SGI Octane for these.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rich.console import Console
from rich.table import Table as Grid

from ahmss.bench.goals import look_up

__all__ = ["TABLES", "Row", "Table", "markdown", "show"]


@dataclass(frozen=True, slots=True)
class Row:
    """A row: what it is of, the thesis's number, the key of ours in the report; a rate's milliseconds as printed."""

    what: str
    thesis: float | None
    key: str
    each: str = ""


@dataclass(frozen=True, slots=True)
class Table:
    """A table: its number and title, its unit, the decimals of the thesis's numbers.

    total: the thesis's sum, where it has one.
    """

    title: str
    unit: str
    rows: tuple[Row, ...]
    digits: int = 2
    total: float | None = None


_CASES = {
    "playback": "playback of motion capture",
    "walk": "a walk",
    "slerp": "spherical linear interpolation",
    "walk_fusion": "fusion (a walk, slerp)",
    "walk_object": "object operation (a walk, follow_hand)",
    "walk_fusion_object": "fusion and object operation (all three)",
}
_COMPUTED = (
    (24.98, "40.03"), (24.93, "40.11"), (24.97, "40.05"), (24.89, "40.18"), (12.48, "80.13"), (12.51, "79.94"),
)  # fmt: skip
_POLYGONS = {
    "human": 1301, "chair": 98, "table": 320, "door": 268, "floor": 10_368, "sink": 185, "television": 167,
    "wall 1": 2, "wall 2": 2, "bed": 94, "lamp": 568, "bookshelf": 90, "cup": None,
}  # fmt: skip
_STARTS = (
    ("playback", "playback", 5.2), ("walk", "walk", 5.3), ("slerp", "slerp", 5.2),
    ("walk_fusion", "walk", 5.4), ("walk_fusion", "slerp", 6.1),
    ("walk_object", "walk", 5.4), ("walk_object", "follow_hand", 5.9),
    ("walk_fusion_object", "walk", 5.4), ("walk_fusion_object", "slerp", 6.8),
    ("walk_fusion_object", "follow_hand", 6.2),
)  # fmt: skip
"""Of object operation the table prints slerp where the text, and the case's number, have a walk."""

TABLES = (
    Table(
        "5.5: pictures shown, the room with one human, 640x480", "/s",
        tuple(Row(what, 4.96, f"shown_fps.{case}", "202") for case, what in _CASES.items()),
    ),
    Table(
        "5.6: frames computed", "/s",
        tuple(
            Row(what, rate, f"compute_fps.{case}", each)
            for (case, what), (rate, each) in zip(_CASES.items(), _COMPUTED, strict=True)
        ),
    ),
    Table("5.7: polygons", "", tuple(Row(w, n, f"polygons.{w}") for w, n in _POLYGONS.items()), digits=0, total=13_679),
    Table(
        "5.8: start of an algorithm to its first frame", "ms",
        tuple(
            Row(f"{_CASES[case]}: {name}" if "_" in case else _CASES[case], n, f"start_ms_of.{case}.{name}")
            for case, name, n in _STARTS
        ),
        digits=1,
    ),
)  # fmt: skip
"""The rows of table 5.7 sum to 13,463; the 216 that its total has more are presumably the cup's."""


def show(report: Mapping[str, Any]) -> None:
    """Print the tables of which something was measured."""
    console = Console()
    for table in TABLES:
        head, *rows = _cells(table, report)
        if rows:
            grid = Grid(title=f"Table {table.title}")
            for number, column in enumerate(head):
                grid.add_column(column, justify="right" if number else "left")
            for row in rows:
                grid.add_row(*row)
            console.print(grid)


def markdown(report: Mapping[str, Any]) -> str:
    """The same for the documentation."""
    texts: list[str] = []
    for table in TABLES:
        head, *rows = _cells(table, report)
        if rows:
            lines = [f"Table {table.title}", "", "| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
            texts.append("\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]))
    return "\n\n".join(texts)


def _cells(table: Table, report: Mapping[str, Any]) -> list[list[str]]:
    """Head and rows; the head alone where nothing was measured."""
    ours = [look_up(report, row.key) for row in table.rows]
    head = ["", f"thesis {table.unit}".rstrip(), f"ours {table.unit}".rstrip()]
    timed = any(row.each for row in table.rows)
    head += ["thesis, ms each", "ours, ms each"] if timed else []
    if all(value is None for value in ours):
        return [head]
    rows = [head]
    for row, value in zip(table.rows, ours, strict=True):
        cells = [row.what, _number(row.thesis, table.digits), _number(value, _digits(value, table))]
        if timed:
            cells += [row.each, _number(None if value is None else 1e3 / value, 2)]
        rows.append(cells)
    if table.total is not None:
        known = [value for value in ours if value is not None]
        rows.append(["total", _number(table.total, table.digits), _number(sum(known), table.digits)])
    return rows


def _digits(value: float | None, table: Table) -> int:
    """Decimals that a person would read: none of thousands."""
    return 0 if value is not None and value >= 200.0 else table.digits


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:,.{digits}f}"
