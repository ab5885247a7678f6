"""`ahmss view`: a server or a recording, in a window or into files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ahmss.cli_options import Json, Keys, Server

__all__ = ["view"]


def view(
    replay: Annotated[Path | None, typer.Argument(help="A recording; left out: a server.")] = None,
    server: Server = "",
    keys: Keys = None,
    headless: Annotated[bool, typer.Option(help="Without a window.")] = False,
    record: Annotated[Path | None, typer.Option(help="An MP4 of what is shown.")] = None,
    snapshot: Annotated[Path | None, typer.Option(help="One picture, PNG.")] = None,
    sheet: Annotated[Path | None, typer.Option(help="Many frames on one page, PNG.")] = None,
    every: Annotated[int, typer.Option(help="Frames between two pictures of the sheet; 0: as fits.")] = 0,
    at: Annotated[float | None, typer.Option(help="Seconds into the recording, for the snapshot.")] = None,
    size: Annotated[str, typer.Option(metavar="WxH", help="Of the picture, in pixels.")] = "1280x720",
    camera: Annotated[str, typer.Option(help="auto, cuts, front, back, left, right, top or close.")] = "auto",
    position: Annotated[
        tuple[float, float, float] | None, typer.Option(metavar="X Y Z", help="Where the camera stands, metres.")
    ] = None,
    look_at: Annotated[
        tuple[float, float, float] | None, typer.Option(metavar="X Y Z", help="What it looks at, metres.")
    ] = None,
    follow: Annotated[str, typer.Option(metavar="HUMAN", help="Keep this human in the middle.")] = "",
    eyes: Annotated[str, typer.Option(metavar="HUMAN", help="What this human sees; in files only.")] = "",
    names: Annotated[bool, typer.Option(help="Write names into the picture.")] = False,
    request: Annotated[bool, typer.Option(help="Ask for each world, as the thesis's viewer did.")] = False,
    seconds: Annotated[float | None, typer.Option(help="Stop after so long.")] = None,
    as_json: Json = False,
) -> None:
    """Watch a server or a recording. Example: ahmss view run.rec --record film.mp4 --sheet sheet.png"""
    from ahmss_viewer.app import ViewOptions

    from ahmss.main.watching import watch

    options = ViewOptions(
        address=server, keys=keys, replay=replay, headless=headless, record=record, snapshot=snapshot, sheet=sheet,
        every=every, size=_size(size), request=request, camera=camera, position=position, look_at=look_at,
        follow=follow, eyes=eyes, at=at, seconds=seconds, names=names,
    )  # fmt: skip
    watch(options, as_json=as_json)


def _size(text: str) -> tuple[int, int]:
    """WIDTHxHEIGHT."""
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise typer.BadParameter(f'"{text}" is no size; write it as 1280x720', param_hint="--size")
    return int(width), int(height)
