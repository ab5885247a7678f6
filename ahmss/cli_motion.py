"""`ahmss motion`: each command calls one function, and imports what it needs only when it runs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ahmss.cli_options import Json

__all__ = ["motion_app"]

motion_app = typer.Typer(no_args_is_help=True, help="Look at motion clips, change them, bring them in and out.")

Clip = Annotated[Path, typer.Argument(help="A motion clip, .npz.")]
Any = Annotated[Path, typer.Argument(metavar="FILE", help="A clip, a BVH, AMC or C3D file, or a recording.")]
Human = Annotated[str, typer.Option(metavar="NAME", help="Of a recording: only this human.")]
Body = Annotated[str, typer.Option(metavar="NAME", help="A human of humandb; left out: whose the motion is.")]
Workspace = Annotated[
    Path | None, typer.Option("--workspace", metavar="DIR", help="The folder with humandb/; left out: found.")
]
Out = Annotated[
    Path | None,
    typer.Option("-o", "--out", metavar="FILE", help="What to write; left out: named after the source, here."),
]
Force = Annotated[bool, typer.Option("--force", help="Write over a file that is there.")]


@motion_app.command()
def info(file: Any, human: Human = "", as_json: Json = False, workspace: Workspace = None) -> None:
    """What a file holds: length, way, contacts, targets. Example: ahmss motion info objectdb/door/open.npz"""
    from ahmss.main.clipviews import show_info

    show_info(file, human, workspace, as_json=as_json)


@motion_app.command()
def quality(file: Any, human: Human = "", body: Body = "", as_json: Json = False, workspace: Workspace = None) -> None:
    """How smooth a motion is, whether its feet stay. Example: ahmss motion quality walk.bvh --json"""
    from ahmss.main.clipviews import show_quality

    show_quality(file, human, body, workspace, as_json=as_json)


@motion_app.command()
def importance(
    clip: Clip,
    derive: Annotated[bool, typer.Option("--derive", help="Write the clip with what follows from its motion.")] = False,
    body: Body = "",
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
    workspace: Workspace = None,
) -> None:
    """How much each joint matters, shown or derived. Example: ahmss motion importance sit.npz --derive -o sit2.npz"""
    if derive:
        from ahmss.main.cliptools import Output, derive_file

        derive_file(clip, body, workspace, Output(out, force))
    elif out is not None:
        raise typer.BadParameter("nothing is written without --derive", param_hint="-o")
    else:
        from ahmss.main.clipviews import show_importance

        show_importance(clip, as_json=as_json)


@motion_app.command()
def annotate(
    clip: Clip,
    table: Annotated[Path, typer.Argument(help="A table written by hand, .toml.")],
    body: Body = "",
    out: Out = None,
    force: Force = False,
    workspace: Workspace = None,
) -> None:
    """Add importance, fingers, hands and contacts by a table. Example: ahmss motion annotate take.npz open.toml"""
    from ahmss.main.cliptools import Output, annotate_file

    annotate_file(clip, table, body, workspace, Output(out, force))


@motion_app.command()
def cut(
    clip: Clip,
    begin: Annotated[float, typer.Option("--from", metavar="S", help="The first second to keep.")] = 0.0,
    end: Annotated[float | None, typer.Option("--to", metavar="S", help="The last one; left out: to the end.")] = None,
    out: Out = None,
    force: Force = False,
) -> None:
    """Keep a part of a clip. Example: ahmss motion cut walk.npz --from 1.5 --to 4 -o stride.npz"""
    from ahmss.main.cliptools import Output, cut_file

    cut_file(clip, begin, end, Output(out, force))


@motion_app.command()
def mirror(clip: Clip, out: Out = None, force: Force = False) -> None:
    """Swap right and left. Example: ahmss motion mirror objectdb/cup/reach.npz -o reach_left.npz"""
    from ahmss.main.cliptools import Output, mirror_file

    mirror_file(clip, Output(out, force))


@motion_app.command()
def resample(
    clip: Clip,
    frames: Annotated[int | None, typer.Option(metavar="N", help="So many frames in all, at the same rate.")] = None,
    seconds: Annotated[float | None, typer.Option(metavar="S", help="So long, at the same rate.")] = None,
    rate: Annotated[float | None, typer.Option(metavar="HZ", help="As long as before, at this rate.")] = None,
    out: Out = None,
    force: Force = False,
) -> None:
    """Faster, slower, or at another rate. Example: ahmss motion resample walk.npz --seconds 3"""
    from ahmss.main.cliptools import Output, resample_file

    resample_file(clip, frames, seconds, rate, Output(out, force))


@motion_app.command()
def retarget(
    clip: Clip,
    body: Annotated[str, typer.Option(metavar="NAME", help="The human of humandb who shall perform it.")],
    performer: Annotated[str, typer.Option("--from", metavar="NAME", help="Whose it is, where it does not say.")] = "",
    out: Out = None,
    force: Force = False,
    workspace: Workspace = None,
) -> None:
    """Give a clip to another human. Example: ahmss motion retarget objectdb/door/open.npz --body aiko"""
    from ahmss.main.cliptools import Output, retarget_file

    retarget_file(clip, body, performer, workspace, Output(out, force))


@motion_app.command("import")
def import_(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A BVH, AMC (its ASF beside it) or C3D file.")],
    body: Annotated[str, typer.Option(metavar="NAME", help="The human of humandb who shall perform it.")] = "ken",
    rate: Annotated[float, typer.Option(metavar="HZ", help="Of the clip; 0: as the file has it.")] = 60.0,
    unit: Annotated[str | None, typer.Option(help="Of lengths: m, cm, mm, inch, foot, cmu; left out: guessed.")] = None,
    out: Out = None,
    force: Force = False,
    workspace: Workspace = None,
) -> None:
    """Make a clip of another maker's motion. Example: ahmss motion import walk.bvh --body aiko -o walk.npz"""
    from ahmss.main.cliptools import Output, import_file

    import_file(file, body, rate or None, unit, workspace, Output(out, force))


@motion_app.command()
def export(
    file: Any,
    out: Out = None,
    human: Human = "",
    body: Body = "",
    force: Force = False,
    workspace: Workspace = None,
) -> None:
    """Write a motion as .bvh, .glb or .npz. Example: ahmss motion export out/table.rec --human ken -o ken.glb"""
    from ahmss.main.cliptools import Output, export_file

    export_file(file, Output(out, force), human, body, workspace)
