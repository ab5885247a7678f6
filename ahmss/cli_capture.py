"""`ahmss capture`: each command calls one function, and imports what it needs only when it runs."""

from __future__ import annotations

import typer

__all__ = ["capture_app"]

capture_app = typer.Typer(no_args_is_help=True, help="Record motions with a tracker, real or simulated.")


@capture_app.callback()
def _group() -> None:
    """A group even while there are few commands."""
