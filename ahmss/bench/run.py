"""`ahmss bench`: all measurements, one after the other."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from ahmss.bench import thesis
from ahmss.bench.report import has_goals, markdown, show
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError

__all__ = ["MEASURES", "PICTURE", "main", "measure", "named"]

PICTURE = Path("out") / "scale.png"
"""Where the plot of `--scale` goes; the documentation's is drawn where it was asked for by name."""

_progress = Console(stderr=True)


def _start(workspace: Workspace) -> dict[str, Any]:
    from ahmss.bench.start import start_ms

    return {"start_ms": start_ms(workspace)}


def _compute(workspace: Workspace) -> dict[str, Any]:
    from ahmss.bench.compute import compute_fps

    return {"compute_fps": compute_fps(workspace)}


def _display(workspace: Workspace) -> dict[str, Any]:
    from ahmss.bench.display import display_fps

    return display_fps(workspace)


def _server(_: Workspace) -> dict[str, Any]:
    from ahmss.bench.server_load import most_humans

    return {"server": most_humans()}


def _latency(_: Workspace) -> dict[str, Any]:
    from ahmss.bench.server_load import latency_ms

    return {"latency_ms": latency_ms()}


def _polygons(workspace: Workspace) -> dict[str, Any]:
    from ahmss.bench.polygons import polygons

    return {"polygons": polygons(workspace)}


def _starts(workspace: Workspace) -> dict[str, Any]:
    from ahmss.bench.cases import start_ms_of

    return {"start_ms_of": start_ms_of(workspace)}


def _shown(workspace: Workspace) -> dict[str, Any]:
    from ahmss.bench.cases import shown_fps

    return {"shown_fps": shown_fps(workspace, _progress.print)}


def _body(_: Workspace) -> dict[str, Any]:
    from ahmss.bench.body import us_per_human

    return {"body_us_per_human": us_per_human()}


def _lookup(workspace: Workspace) -> dict[str, Any]:
    from ahmss.bench.crowded import lookup_us

    return {"lookup_us": lookup_us(workspace)}


def _memory(workspace: Workspace) -> dict[str, Any]:
    from ahmss.bench.crowded import memory_mb

    return {"memory_mb": memory_mb(workspace)}


MEASURES: dict[str, Callable[[Workspace], dict[str, Any]]] = {
    "start": _start,
    "compute": _compute,
    "display": _display,
    "server": _server,
    "latency": _latency,
    "body": _body,
    "lookup": _lookup,
    "memory": _memory,
    "polygons": _polygons,
    "starts": _starts,
    "shown": _shown,
}


_REPORTED = {
    "start_ms": "start", "compute_fps": "compute", "display_fps": "display", "display_fps_live": "display",
    "latency_ms": "latency", "body_us_per_human": "body", "lookup_us": "lookup", "memory_mb": "memory",
    "start_ms_of": "starts", "shown_fps": "shown",
}  # fmt: skip
"""What else they are called: by what stands in the report."""


def named(name: str) -> str:
    """The one of MEASURES that a name means: its own, or one of its report, as `compute_fps` or `compute_fps.walk`."""
    first = name.partition(".")[0]
    return _REPORTED.get(first, first)


def measure(names: Sequence[str], workspace: Workspace) -> dict[str, Any]:
    """The report of some of MEASURES; one that can't be made says why on standard error and is left out."""
    report: dict[str, Any] = {}
    for name in names:
        _progress.print(f"measuring {name} …")
        try:
            report |= MEASURES[name](workspace)
        except AhmssError as error:
            _progress.print(f"{name} could not be measured: {error}")
    return report


def main(arguments: Sequence[str]) -> int:
    """Measure what the command line asks for; 1 where something could not be measured."""
    parser = argparse.ArgumentParser(
        prog="ahmss bench",
        description="Measure start times and rates, through real processes and a real server; or how motions look.",
        epilog="Example: ahmss bench --json start compute",
    )
    parser.add_argument("what", nargs="*", help=f"some of: {', '.join(MEASURES)}; all if left out", metavar="WHAT")
    parser.add_argument("--json", action="store_true", help="one JSON object on standard output")
    parser.add_argument("--markdown", action="store_true", help="a table for the documentation")
    parser.add_argument("--scale", action="store_true", help="how the cost grows, with a plot")
    parser.add_argument("--picture", type=Path, default=PICTURE, help=f"where the plot goes; left out: {PICTURE}")
    parser.add_argument("--judge", action="store_true", help="the actions of table 5.9, measured beside real capture")
    parser.add_argument("--script", type=Path, help="what is played to be judged; left out: the scenario")
    options = parser.parse_args(arguments)
    unknown = [name for name in options.what if named(name) not in MEASURES]
    if unknown:
        parser.error(f"nothing to measure called {', '.join(unknown)}; there is: {', '.join(MEASURES)}")
    workspace = Workspace.find()
    if options.scale:
        from ahmss.bench.scale import scale

        report = scale(workspace, options.picture)
        print(json.dumps(report, indent=2))
        return 0
    if options.judge:
        return _judge(workspace, options)
    names = list(dict.fromkeys(map(named, options.what))) or list(MEASURES)
    report = measure(names, workspace)
    if options.json:
        print(json.dumps(report, indent=2))
    elif options.markdown:
        texts = [markdown(report) if has_goals(report) else "", thesis.markdown(report)]
        print("\n\n".join(text for text in texts if text))
    else:
        if has_goals(report):
            show(report)
        thesis.show(report)
    sys.stdout.flush()
    return 0 if report else 1


def _judge(workspace: Workspace, options: argparse.Namespace) -> int:
    """Play and measure the items of table 5.9; 1 where a motion failed."""
    from ahmss.bench import judge

    script = options.script or workspace.root / judge.SCRIPT
    _progress.print(f"playing and measuring {script} …")
    judgement = judge.judge(script, workspace)
    if options.json:
        print(json.dumps(judge.to_json(judgement), indent=2))
    elif options.markdown:
        print(judge.markdown(judgement))
    else:
        judge.show(judgement)
    sys.stdout.flush()
    return 1 if judgement.failures else 0
