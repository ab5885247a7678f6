"""`ahmss capture`: each command calls one function, and imports what it needs only when it runs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ahmss.cli_options import Json

__all__ = ["capture_app"]

capture_app = typer.Typer(no_args_is_help=True, help="Record motions with a tracker, real or simulated.")

Config = Annotated[Path, typer.Argument(help="The tracker's file; `ahmss capture config` writes a start.")]
Body = Annotated[str, typer.Option(help="The human of humandb who shall perform it.")]
Workspace = Annotated[
    Path | None, typer.Option("--workspace", metavar="DIR", help="The folder with humandb/; left out: found.")
]
Upright = Annotated[
    tuple[float, float] | None,
    typer.Option(metavar="FROM TO", help="Seconds in which the subject stands upright; left out: found."),
]
Facing = Annotated[
    str, typer.Option(metavar="DEG", help="Where they face then, from the transmitter's x to the left; or `sensors`.")
]
Mend = Annotated[bool, typer.Option("--mend", help="Put a smooth way across sensors' jumps.")]
Smooth = Annotated[float, typer.Option(metavar="HZ", help="Smooth away jitter above this; 0: leave it.")]
At = Annotated[tuple[float, float], typer.Option(metavar="X Y", help="Where it stands at first, metres.")]
Place = Annotated[tuple[float, float, float], typer.Option(metavar="X Y Z", help="Its place, metres.")]
Force = Annotated[bool, typer.Option("--force", help="Write over a take or a clip that is there.")]
Origin = Annotated[str, typer.Option(metavar="TEXT", help="What the file says of where it comes from.")]


@capture_app.command()
def config(
    kind: Annotated[str, typer.Option(help="fastrak, liberty, patriot or ultratrak.")] = "liberty",
) -> None:
    """Print a tracker's file to start from. Example: ahmss capture config --kind fastrak > tracker.toml"""
    from ahmss.capture.session import print_template

    print_template(kind)


@capture_app.command()
def doctor(config: Config = Path("tracker.toml"), as_json: Json = False) -> None:
    """Look why nothing comes from a tracker. Example: ahmss capture doctor tracker.toml"""
    from ahmss.capture.session import examine

    if examine(config, as_json=as_json):
        raise typer.Exit(1)


@capture_app.command()
def record(
    out: Annotated[Path, typer.Argument(help="The clip to write; the take goes beside it, OUT.take.npz.")],
    config: Annotated[Path, typer.Option("--tracker", help="The tracker's file.")] = Path("tracker.toml"),
    seconds: Annotated[float | None, typer.Option(help="How long; left out: until Ctrl-C.")] = None,
    wait: Annotated[float, typer.Option(help="Seconds before it begins, to walk to the place.")] = 0.0,
    body: Body = "ken",
    upright: Upright = None,
    facing: Facing = "0",
    mend: Mend = False,
    smooth: Smooth = 0.0,
    origin: Origin = "",
    force: Force = False,
    as_json: Json = False,
    workspace: Workspace = None,
) -> None:
    """Record a person: a take, and a clip made of it. Example: ahmss capture record open.npz --seconds 8"""
    from ahmss.capture.session import Wishes, record_clip

    wishes = Wishes(body, upright, facing, mend, smooth, workspace)
    record_clip(out, config, wishes, seconds=seconds, wait=wait, origin=origin, force=force, as_json=as_json)


@capture_app.command()
def calibrate(
    take: Annotated[Path, typer.Argument(help="A take, .take.npz.")],
    out: Annotated[Path | None, typer.Option(help="The clip to write; left out: named as the take.")] = None,
    body: Body = "ken",
    upright: Upright = None,
    facing: Facing = "0",
    mend: Mend = False,
    smooth: Smooth = 0.0,
    force: Force = False,
    as_json: Json = False,
    workspace: Workspace = None,
) -> None:
    """Make a clip of a take, again and otherwise. Example: ahmss capture calibrate open.take.npz --upright 0.5 1.5"""
    from ahmss.capture.session import Wishes, calibrate_take

    wishes = Wishes(body, upright, facing, mend, smooth, workspace)
    calibrate_take(take, out, wishes, force=force, as_json=as_json)


@capture_app.command()
def live(
    config: Config = Path("tracker.toml"),
    human: Annotated[str, typer.Option(help="The human's name in the world.")] = "ken",
    body: Annotated[str, typer.Option(help="Which body of humandb; left out: of that name.")] = "",
    at: At = (0.0, 0.0),
    heading: Annotated[float, typer.Option(metavar="DEG", help="Its heading at first.")] = 0.0,
    facing: Facing = "0",
    server: Annotated[str, typer.Option(metavar="HOST[:PORT]", help="The server; left out: this machine's.")] = "",
    keys: Annotated[Path | None, typer.Option(metavar="DIR", help="Keys for a server on another machine.")] = None,
    seconds: Annotated[float | None, typer.Option(help="How long; left out: until Ctrl-C.")] = None,
    as_json: Json = False,
    workspace: Workspace = None,
) -> None:
    """Drive a virtual human by a tracker as the person moves. Example: ahmss capture live tracker.toml --human ken"""
    from ahmss.capture.session import go_live

    options: dict[str, Any] = {"human": human, "body": body, "place": at, "heading": heading, "facing": facing}
    go_live(config, options, server=server, keys=keys, seconds=seconds, workspace=workspace, as_json=as_json)


@capture_app.command()
def simulate(
    subject: Annotated[str, typer.Argument(help="door_open, door_close, sit, stand_up, lift; or a clip or BVH file.")],
    body: Body = "ken",
    upright: Annotated[float, typer.Option(metavar="SECONDS", help="How long the subject stands upright first.")] = 2.0,
    kind: Annotated[str, typer.Option(help="fastrak, liberty, patriot, or ultratrak (over UDP).")] = "liberty",
    lines: Annotated[int, typer.Option(help="Units, each on its own line; 0: as many as the stations need.")] = 0,
    stations: Annotated[int, typer.Option(help="How many of the 15 links bear a sensor.")] = 15,
    rate: Annotated[float, typer.Option(help="Frames a second.")] = 60.0,
    measurements: Annotated[float | None, typer.Option(help="Of a unit, a second; left out: its own.")] = None,
    free_running: Annotated[
        bool, typer.Option("--free-running", help="Units are not synchronised: one of fewer stations runs ahead.")
    ] = False,
    baud: Annotated[int, typer.Option(help="Of every line.")] = 921_600,
    link: Annotated[list[Path] | None, typer.Option(metavar="PATH", help="A line's name; one for each.")] = None,
    address: Annotated[str, typer.Option(metavar="HOST:PORT", help="Where datagrams go.")] = "127.0.0.1:12345",
    clock: Annotated[str, typer.Option(help="real, or poll: as fast as it is read.")] = "real",
    after: Annotated[str, typer.Option(help="hold the last pose, loop, or stop.")] = "hold",
    seed: Annotated[int, typer.Option(help="Of mounting, noise and faults.")] = 0,
    straight: Annotated[bool, typer.Option("--straight", help="Sensors sit straight on the links.")] = False,
    noise: Annotated[str, typer.Option(help="none, resolution, or full (the thesis's table 5.2).")] = "none",
    drop: Annotated[float, typer.Option(help="Share of bytes that is dropped.")] = 0.0,
    double: Annotated[float, typer.Option(help="Share of bytes that comes twice.")] = 0.0,
    flip: Annotated[float, typer.Option(help="Share of bytes in which a bit is flipped.")] = 0.0,
    weak: Annotated[list[int] | None, typer.Option(metavar="STATION", help="It says that its signal is weak.")] = None,
    silent: Annotated[list[int] | None, typer.Option(metavar="STATION", help="Nothing comes from it.")] = None,
    off: Annotated[bool, typer.Option("--off", help="Nothing at all comes.")] = False,
    boot: Annotated[float, typer.Option(help="Seconds that a reinitialisation takes.")] = 10.0,
    transmitter: Place = (-1.0, 0.0, 0.0),
    facing: Annotated[float, typer.Option(help="The transmitter's heading, degrees.")] = 0.0,
    upside_down: Annotated[bool, typer.Option("--upside-down", help="The transmitter hangs from above.")] = False,
    config_out: Annotated[Path | None, typer.Option(help="Write a tracker's file that fits.")] = None,
    truth: Annotated[Path | None, typer.Option(help="Write how the sensors sit and the body really moved.")] = None,
    workspace: Workspace = None,
) -> None:
    """Be a tracker on a pseudo-terminal. Example: ahmss capture simulate door_open --config-out tracker.toml"""
    from ahmss.capture.session import simulate_tracker

    options: dict[str, Any] = {
        "kind": kind, "lines": lines, "stations": stations, "rate": rate, "measurements": measurements,
        "synchronised": not free_running, "baud": baud,
        "names": tuple(link or ()), "address": address, "clock": clock, "after": after, "seed": seed,
        "mounted": not straight, "noise": noise, "boot": boot, "config_out": config_out, "truth": truth,
    }  # fmt: skip
    faults = {
        "drop": drop, "double": double, "flip": flip, "weak": set(weak or ()), "silent": set(silent or ()), "off": off,
    }  # fmt: skip
    stand = {"position": transmitter, "facing_deg": facing, "upside_down": upside_down}
    simulate_tracker(subject, body, upright, options, faults, stand, workspace)
