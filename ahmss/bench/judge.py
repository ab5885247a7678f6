"""`ahmss bench --judge`: the items of table 5.9, each measured and set beside real capture."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from ahmss.bench.acted import Acted, act
from ahmss.bench.capture import IN_PLACE, STANDING, WALKING
from ahmss.bench.depth import in_things, under_floor
from ahmss.bench.measures import BOUNDS, UNITS, Measured, Series
from ahmss.bench.survey import ACTIONS, MEAN, TRANSITIONS, Span, actions_in, between
from ahmss.database.workspace import Workspace

__all__ = ["SCRIPT", "Item", "Judgement", "judge", "judged", "markdown", "show", "to_json"]

SCRIPT = Path("examples") / "scenario.txt"
"""What is played where no other script is named."""

_AROUND = 0.5  # seconds of the actions before and after that belong to a transition
_HEADS = {
    "slide": "slide", "drift": "drift", "speed_p95": "feet p95", "acceleration": "acc.", "acceleration_p99": "acc. p99",
    "jerk": "jerk", "pop": "pop", "hips": "hips", "floor": "floor", "hand": "hand", "slip": "slip",
    "depth": "depth",
}  # fmt: skip
_MOST = ("slide", "acceleration", "jerk", "hand", "depth")
_DIGITS = {"slide": 1, "drift": 1, "speed_p95": 3, "pop": 1, "hips": 1, "floor": 1, "hand": 1, "slip": 1, "depth": 1}


@dataclass(frozen=True)
class Item:
    """An action, or a transition ("->"), with the thesis's score and what was measured; None: it was not played."""

    name: str
    score: float | None
    measured: Measured | None
    seconds: float = 0.0


@dataclass(frozen=True)
class Judgement:
    """The 23 items in the order in which they happen, and what went wrong in playing them."""

    items: tuple[Item, ...]
    failures: tuple[str, ...]

    @property
    def played(self) -> list[Item]:
        """The items that were played."""
        return [item for item in self.items if item.measured is not None]

    @property
    def worse(self) -> list[Item]:
        """Those of which a measure is worse than in real capture, or than the system's own bounds."""
        return [item for item in self.items if item.measured is not None and item.measured.worse]


def judge(script: Path, workspace: Workspace) -> Judgement:
    """Play a script and measure what of the 23 items is in it.

    Raises:
        AhmssError: the script can't be played.
    """
    return judged(act(script, workspace), workspace)


def judged(acted: Acted, workspace: Workspace) -> Judgement:
    """The items in what was played."""
    series = Series(acted, in_things(acted, workspace), under_floor(acted))
    spans, frames, margin = actions_in(acted.doings), len(acted.root), round(_AROUND * acted.rate)
    items: list[Item] = []
    for number, (action, span) in enumerate(zip(ACTIONS, spans, strict=True)):
        if number:
            before = spans[number - 1]
            pause = None if before is None or span is None else (span.first - before.end) / acted.rate
            way = between(before, span, margin, frames)
            items.append(_item("->", TRANSITIONS[number - 1], way, series, acted.rate, pause))
        items.append(_item(action.name, action.score, span, series, acted.rate))
    return Judgement(tuple(items), acted.failures)


def _item(
    name: str, score: float | None, span: Span | None, series: Series, rate: float, pause: float | None = None
) -> Item:
    if span is None:
        return Item(name, score, None)
    return Item(name, score, series.over(span, pause), (span.end - span.first) / rate)


# How it is told


def show(judgement: Judgement) -> None:
    """Print the five measures that say most, and what is worse than real; --markdown and --json have them all."""
    table = Table(title="The items of table 5.9, measured (all measures: --markdown)", box=SIMPLE_HEAD)
    for column in ("", "of 4", *(f"{_HEADS[name]}\n{UNITS[name]}" for name in _MOST), "!"):
        table.add_column(column, justify="right" if column else "left", no_wrap=True, min_width=4)
    for item in judgement.items:
        score = "-" if item.score is None else f"{item.score:.1f}"
        if item.measured is None:
            table.add_row(item.name, score, "not played", *[""] * len(_MOST))
            continue
        figures, worse = item.measured.figures, item.measured.worse
        cells = [_cell(name, figures[name], "[red]{}[/red]" if name in worse else "{}") for name in _MOST]
        table.add_row(item.name, score, *cells, str(len(worse) or ""))
    for bar in _BARS:
        table.add_row(
            f"real: {bar.clips}", "", *("" if n in BOUNDS else _cell(n, getattr(bar, n), "{}") for n in _MOST)
        )
    console = Console()
    console.print(table)
    for line in _summary(judgement):
        console.print(line, markup=False, soft_wrap=True)


def markdown(judgement: Judgement) -> str:
    """The same for the documentation; what is worse than real is bold."""
    head, *rows = _rows(judgement)
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join([*lines, "", *_summary(judgement)])


def to_json(judgement: Judgement) -> dict[str, Any]:
    """All figures, with what they are compared with."""
    return {
        "thesis_mean": MEAN,
        "units": UNITS,
        "real": {bar.clips: {name: getattr(bar, name) for name in UNITS if name not in BOUNDS} for bar in _BARS},
        "bounds": BOUNDS,
        "items": [_told(item) for item in judgement.items],
        "failures": list(judgement.failures),
    }


_BARS = (WALKING, IN_PLACE, STANDING)


def _told(item: Item) -> dict[str, Any]:
    told: dict[str, Any] = {"name": item.name, "thesis": item.score, "seconds": round(item.seconds, 2)}
    if item.measured is None:
        return told | {"played": False}
    measured = item.measured
    told |= {"played": True, "real": measured.bar.clips, **measured.figures}
    return told | {"pause_s": measured.pause, "worse": measured.worse, "where": measured.where}


def _rows(judgement: Judgement) -> list[list[str]]:
    """Head and rows: the items, then the captures that they are compared with."""
    rows = [["", "thesis", "s", *(f"{_HEADS[name]} {unit}" for name, unit in UNITS.items()), "pause s"]]
    for item in judgement.items:
        score = "-" if item.score is None else f"{item.score:.1f}"
        if item.measured is None:
            rows.append([item.name, score, "not played", *[""] * (len(UNITS) + 1)])
            continue
        worse = item.measured.worse
        cells = [
            _cell(name, value, "**{}**" if name in worse else "{}") for name, value in item.measured.figures.items()
        ]
        pause = "" if item.measured.pause is None else f"{item.measured.pause:.2f}"
        rows.append([item.name, score, f"{item.seconds:.1f}", *cells, pause])
    for bar in _BARS:
        cells = ["" if name in BOUNDS else _cell(name, getattr(bar, name), "{}") for name in UNITS]
        rows.append([f"real: {bar.clips}", "", "", *cells, ""])
    rows.append(["our own bounds", "", "", *(_cell(n, BOUNDS[n], "{}") if n in BOUNDS else "" for n in UNITS), ""])
    return rows


def _cell(name: str, value: float, marked: str) -> str:
    return marked.format(f"{value:,.{_DIGITS.get(name, 0)}f}")


def _summary(judgement: Judgement) -> list[str]:
    """How many are worse, which and where, and what went wrong."""
    played, worse = judgement.played, judgement.worse
    lines = [
        f"{len(played)} of {len(judgement.items)} items played, {len(worse)} of them worse than real capture or than "
        f"our own bounds in some measure."
    ]
    for number, item in enumerate(judgement.items):
        if item in worse and item.measured is not None:
            name = item.name if item.name != "->" else f"{judgement.items[number - 1].name} -> "
            name += judgement.items[number + 1].name if item.name == "->" else ""
            lines.append(f"- {name}: {', '.join(_reason(item.measured, measure) for measure in item.measured.worse)}")
    return [*lines, *(f"- failed: {failure}" for failure in judgement.failures)]


def _reason(measured: Measured, name: str) -> str:
    """A measure that is worse, with its bound and place."""
    digits = _DIGITS.get(name, 0)
    place = f" ({measured.where[name]})" if name in measured.where else ""
    return (
        f"{_HEADS[name]} {measured.figures[name]:,.{digits}f} > {measured.bound(name):,.{digits}f} {UNITS[name]}{place}"
    )
