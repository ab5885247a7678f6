"""A bench's numbers as a table against the thesis and the goals."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rich.console import Console
from rich.table import Table

from ahmss.bench.goals import GOALS, Goal, look_up

__all__ = ["has_goals", "markdown", "missed", "show"]


def has_goals(report: Mapping[str, Any]) -> bool:
    """Whether anything was measured that has a number to reach."""
    return any(look_up(report, goal.key) is not None for goal in GOALS)


def missed(report: Mapping[str, Any]) -> list[str]:
    """The keys of the goals that were measured and not reached."""
    found: list[str] = []
    for goal in GOALS:
        value = look_up(report, goal.key)
        if value is not None and not goal.met(value):
            found.append(goal.key)
    return found


def show(report: Mapping[str, Any]) -> None:
    """Print the table of what was measured."""
    table = Table(title="Measured against the thesis (2000) and the numbers to reach")
    table.add_column("what")
    for column in ("thesis", "reach", "measured"):
        table.add_column(column, justify="right")
    table.add_column("")
    for goal, cells in zip(GOALS, _rows(report), strict=True):
        if look_up(report, goal.key) is not None:
            table.add_row(*cells)
    Console().print(table)


def markdown(report: Mapping[str, Any]) -> str:
    """The same as a table for the documentation."""
    lines = ["| what | thesis (2000) | to reach | measured | |", "|---|---|---|---|---|"]
    lines += ["| " + " | ".join(cells) + " |" for cells in _rows(report)]
    return "\n".join(lines)


def _rows(report: Mapping[str, Any]) -> list[tuple[str, str, str, str, str]]:
    """A row a goal: what, thesis, reach, measured, and whether it was reached."""
    rows: list[tuple[str, str, str, str, str]] = []
    for goal in GOALS:
        value = look_up(report, goal.key)
        measured = "not measured" if value is None else f"{value:,.{_digits(value)}f} {goal.unit}".rstrip()
        verdict = "" if value is None else ("reached" if goal.met(value) else "missed")
        rows.append((goal.what, _with_unit(goal), f"{goal.reach} {goal.unit}".rstrip(), measured, verdict))
    return rows


def _with_unit(goal: Goal) -> str:
    """The thesis's figure with its unit."""
    return goal.thesis if goal.thesis == "-" else f"{goal.thesis} {goal.unit}".rstrip()


def _digits(value: float) -> int:
    """Decimals that a person would read."""
    return 0 if value >= 200 else 1 if value >= 20 else 2
