"""`ahmss view`: the viewer; drawing a recording shows how far it is, by a bar on a terminal and by lines elsewhere."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Generator
from contextlib import contextmanager

from ahmss_viewer.app import ViewOptions, ViewReport, view

__all__ = ["draw", "progressing", "watch"]

_YIELDS = 10  # of priority


def watch(options: ViewOptions, *, as_json: bool) -> None:
    """View, and tell what was shown. Pictures of a running world yield to those who make it, where both are here."""
    if options.draws_files and options.replay is None and hasattr(os, "nice"):
        os.nice(_YIELDS)
    report = draw(options, "drawing")
    if as_json:
        print(json.dumps(report.to_json()), flush=True)
    else:
        print(report)
    for file in report.files:
        print(f"wrote {file}", file=sys.stderr)
    for problem in report.problems:
        print(f"ahmss: {problem}", file=sys.stderr)


def draw(options: ViewOptions, what: str) -> ViewReport:
    """View; a recording drawn into files shows how far it is. A window or a live view has no end to be near to."""
    if options.replay is None or not options.draws_files:
        return view(options)
    with progressing(what) as progress:
        return view(options, progress)


@contextmanager
def progressing(what: str) -> Generator[Callable[[int, int], None]]:
    """What is told the pictures drawn and all of them."""
    if not sys.stderr.isatty():
        yield _Lines(what)
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


class _Lines:
    """A line at each tenth, where there is no terminal."""

    def __init__(self, what: str) -> None:
        self._what, self._tenth = what, 0

    def __call__(self, done: int, total: int) -> None:
        tenth = 10 * done // max(total, 1)
        if tenth > self._tenth:
            self._tenth = tenth
            print(f"{self._what}: {done} of {total}", file=sys.stderr, flush=True)
