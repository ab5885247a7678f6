"""`ahmss walk`: each command calls one function, and imports what it needs only when it runs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ahmss.cli_options import Json

__all__ = ["walk_app"]

walk_app = typer.Typer(no_args_is_help=True, help="Make walk libraries, and look at what is in them.")

Library = Annotated[
    Path | None,
    typer.Argument(metavar="LIBRARY", help="A walk library; left out: the floor's, objectdb/floor/walk.npz."),
]
Workspace = Annotated[
    Path | None, typer.Option("--workspace", metavar="DIR", help="The folder with humandb/; left out: found.")
]
Force = Annotated[bool, typer.Option("--force", help="Write over a file that is there.")]


@walk_app.command()
def build(
    captures: Annotated[
        Path | None,
        typer.Argument(metavar="FOLDER", help="BVH, AMC, C3D files or clips; left out: the subject of our own walks."),
    ] = None,
    body: Annotated[str, typer.Option(metavar="NAME", help="A human of humandb: whose lengths.")] = "ken",
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE", help="What to write.")] = Path("walk.npz"),
    force: Force = False,
    as_json: Json = False,
    workspace: Workspace = None,
) -> None:
    """Make a library of all 332 clips. Example: ahmss walk build my_captures --body aiko -o objectdb/floor/me.npz"""
    from ahmss.main.walklibrary import build_library

    build_library(captures, body, out, workspace, force=force, as_json=as_json)


@walk_app.command()
def info(library: Library = None, as_json: Json = False, workspace: Workspace = None) -> None:
    """What clips a library has, and where they come from. Example: ahmss walk info"""
    from ahmss.main.walklibrary import show_library

    show_library(library, workspace, as_json=as_json)


@walk_app.command()
def export(
    name: Annotated[str, typer.Argument(metavar="CLIP", help="Its name, as `ahmss walk info` has it.")],
    library: Library = None,
    out: Annotated[Path | None, typer.Option("-o", "--out", metavar="FILE", help="A clip; left out: CLIP.npz.")] = None,
    force: Force = False,
    workspace: Workspace = None,
) -> None:
    """Write one clip of a library as a motion clip. Example: ahmss walk export start_90 -o left.npz"""
    from ahmss.main.walklibrary import export_clip

    export_clip(library, name, out or Path(f"{name}.npz"), workspace, force=force)
