"""`ahmss list`, `check`, `init` and `new`: what is in a workspace. Each imports what it needs only when it runs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ahmss.cli_options import Json, Workspace

__all__ = ["check", "init", "list_", "new_app"]

new_app = typer.Typer(no_args_is_help=True, help="Write a working start of an object or an algorithm.")


def list_(
    what: Annotated[str, typer.Argument(help="objects, humans, algorithms, or the name of an object.")] = "",
    as_json: Json = False,
    workspace: Workspace = None,
) -> None:
    """What the workspace offers. Example: ahmss list cup"""
    from ahmss.main.listing import list_workspace

    list_workspace(what, workspace, as_json=as_json)


def check(as_json: Json = False, workspace: Workspace = None) -> None:
    """Read the whole workspace and say what is wrong, file by file. Example: ahmss check"""
    from ahmss.main.listing import check_workspace

    if check_workspace(workspace, as_json=as_json):
        raise typer.Exit(1)


@new_app.command("object")
def new_object(name: str, workspace: Workspace = None) -> None:
    """A new object with a box for a shape. Example: ahmss new object vase"""
    from ahmss.database.layout import new_object as write
    from ahmss.database.workspace import Workspace as Found

    typer.echo(f"wrote {write(Found.find(workspace), name)}")


@new_app.command("algorithm")
def new_algorithm(
    name: str,
    kind: Annotated[str, typer.Option(help="human or object.")] = "human",
    language: Annotated[str, typer.Option(help="python or c.")] = "python",
    workspace: Workspace = None,
) -> None:
    """A new algorithm of about ten lines. Example: ahmss new algorithm bow"""
    from ahmss.algorithm.template import new_algorithm as write
    from ahmss.database.workspace import Workspace as Found

    typer.echo(f"wrote {write(Found.find(workspace), name, kind, language)}")


@new_app.command("panel")
def new_panel(
    name: str,
    rows: Annotated[int, typer.Option(help="How many rows of controls.")] = 4,
    columns: Annotated[int, typer.Option(help="How many in a row.")] = 10,
    slope: Annotated[float, typer.Option(help="Of the plate in degrees; 0 is flat, 90 upright.")] = 60.0,
    height: Annotated[float, typer.Option(help="Of the plate's middle over the floor, in metres.")] = 1.05,
    of: Annotated[list[str] | None, typer.Option(help="A kind of control for each row, from the top.")] = None,
    workspace: Workspace = None,
) -> None:
    """A panel of controls in one file. Example: ahmss new panel console --rows 2 --of push_button --of lever"""
    from ahmss.database.panel import new_panel as write
    from ahmss.database.workspace import Workspace as Found

    file = write(Found.find(workspace), name, of or ["push_button"], rows, columns, slope, height)
    typer.echo(f"wrote {file}")


def init(directory: Annotated[Path, typer.Argument(help="Where to.")]) -> None:
    """Lay out a workspace of your own. Example: ahmss init ~/my-room"""
    from ahmss.database.layout import init as lay_out
    from ahmss.database.workspace import Workspace as Found

    lay_out(directory, Found.find())
    typer.echo(f"{directory} is ready; work in it: cd {directory} && ahmss up")
