"""`ahmss motion`: each command calls one function, and imports what it needs only when it runs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["motion_app"]

motion_app = typer.Typer(no_args_is_help=True, help="Look at motion clips, change them, bring them in and out.")

Json = Annotated[bool, typer.Option("--json", help="One JSON object on standard output.")]


@motion_app.callback()
def _group() -> None:
    """A group even while there is one command."""


@motion_app.command()
def quality(file: Annotated[Path, typer.Argument(help="A motion clip, .npz.")], as_json: Json = False) -> None:
    """How smooth a clip is, and whether its feet stay. Example: ahmss motion quality objectdb/cup/reach.npz"""
    from ahmss.main.listing import clip_quality

    clip_quality(file, as_json=as_json)
