"""The command line: each command calls one function, and imports what it needs only when it runs."""

from __future__ import annotations

import json
import logging
import os
import sys
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer

from ahmss.cli_capture import capture_app
from ahmss.cli_motion import motion_app
from ahmss.cli_walk import walk_app
from ahmss.errors import AhmssError

__all__ = ["app", "main"]

app = typer.Typer(
    name="ahmss", no_args_is_help=True, add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False,
    help="Virtual humans that act on objects which know how.",
)  # fmt: skip
new_app = typer.Typer(no_args_is_help=True, help="Write a working start of an object or an algorithm.")
app.add_typer(new_app, name="new")
app.add_typer(motion_app, name="motion")
app.add_typer(capture_app, name="capture")
app.add_typer(walk_app, name="walk")

Server = Annotated[str, typer.Option("--server", metavar="HOST[:PORT]", help="The server; left out: this machine's.")]
Keys = Annotated[Path | None, typer.Option("--keys", metavar="DIR", help="Keys for a server on another machine.")]
Workspace = Annotated[
    Path | None, typer.Option("--workspace", metavar="DIR", help="The folder with objectdb/; left out: found.")
]
Port = Annotated[
    str, typer.Option("--port", metavar="[HOST:]PORT", help="Let human models in here, as at 7427; left out: nowhere.")
]
Json = Annotated[bool, typer.Option("--json", help="One JSON object on standard output.")]


_DEBUG = "AHMSS_DEBUG"


def main() -> None:
    """Run the command that was typed; an error is one sentence and exit code 1."""
    debug = "--debug" in sys.argv
    if debug:
        sys.argv.remove("--debug")
        os.environ[_DEBUG] = "1"  # the processes of this one tell as much
    if os.environ.get(_DEBUG):
        logging.basicConfig(format="debug: %(message)s")
        logging.getLogger("ahmss").setLevel(logging.DEBUG)
    try:
        app()
    except AhmssError as error:
        if debug:
            raise
        _fail(str(error))
    except KeyboardInterrupt:
        sys.exit(130)
    except Exception as error:
        if debug:
            raise
        _fail(f"a fault of the program itself: {type(error).__name__}: {error}; --debug shows where")


def _version(asked: bool) -> None:
    if asked:
        from ahmss import __version__

        typer.echo(f"ahmss {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", help="Say which version this is.", callback=_version, is_eager=True)
    ] = False,
    debug: Annotated[
        bool,
        typer.Option(
            "--debug",
            help="Show where an error came from, and which algorithm gave up at which frame; stands anywhere.",
        ),
    ] = False,
) -> None:
    """Virtual humans that act on objects which know how."""
    del version, debug  # told already, and taken out by `main`


@app.command()
def demo(
    out: Annotated[Path, typer.Option(help="Where the recording, the film and the sheet go.")] = Path("out"),
    window: Annotated[
        bool, typer.Option("--window/--no-window", help="Open a window where there is a display.")
    ] = True,
    workspace: Workspace = None,
) -> None:
    """Play examples/scenario.txt with every kind of process, and film it meanwhile. Example: ahmss demo"""
    from ahmss.main.demo import run_demo

    if run_demo(out, workspace, window=window, say=typer.echo):
        raise typer.Exit(1)


@app.command()
def up(
    human: Annotated[str, typer.Option(help="The human's name.")] = "ken",
    body: Annotated[str, typer.Option(help="Which body of humandb; left out: of that name.")] = "",
    scene: Annotated[str, typer.Option(help="A kind of object to add at first; empty: none.")] = "room",
    address: Annotated[str, typer.Option(metavar="HOST:PORT", help="Where the server listens.")] = "",
    port: Port = "",
    workspace: Workspace = None,
) -> None:
    """Server, viewer and main on this machine, with the console. Example: ahmss up --human aiko --body aiko"""
    from ahmss.main.up import run_up

    if run_up(human, body, scene, address, workspace, port):
        raise typer.Exit(1)


@app.command()
def server(
    address: Annotated[str, typer.Option(metavar="HOST[:PORT]", help="Where to listen; other machines: 0.0.0.0.")] = "",
    record: Annotated[Path | None, typer.Option(help="A file that every tick is written to.")] = None,
    directory: Annotated[Path | None, typer.Option(help="Where the world stays over a restart.")] = None,
    keys: Keys = None,
    lockstep: Annotated[str, typer.Option(metavar="NAMES", help="Wait for these humans each tick (for --fast).")] = "",
    rate: Annotated[float, typer.Option(help="Ticks a second.")] = 60.0,
) -> None:
    """The virtual-space server. Example: ahmss server --directory world"""
    from ahmss.world.__main__ import main as serve

    options: dict[str, Any] = {
        "--address": address, "--record": record, "--directory": directory, "--keys": keys, "--lockstep": lockstep,
        "--rate": rate,
    }  # fmt: skip
    code = serve([word for option, value in options.items() if value for word in (option, str(value))])
    raise typer.Exit(code)


@app.command("main")
def main_process(
    human: Annotated[str, typer.Option(help="The human's name in the world.")] = "ken",
    body: Annotated[str, typer.Option(help="Which body of humandb; left out: of that name.")] = "",
    at: Annotated[tuple[float, float], typer.Option(metavar="X Y", help="Where it stands, metres.")] = (0.0, 0.0),
    facing: Annotated[float, typer.Option(help="Its heading, degrees.")] = 0.0,
    server: Server = "",
    keys: Keys = None,
    script: Annotated[Path | None, typer.Option(help="Carry out this human's part of a script, and end.")] = None,
    group: Annotated[str, typer.Option(hidden=True)] = "",
    fast: Annotated[bool, typer.Option(help="As fast as it can, in lockstep.")] = False,
    seed: Annotated[int, typer.Option(help="For whatever is random.")] = 0,
    lockstep: Annotated[bool, typer.Option(hidden=True)] = False,
    stay: Annotated[bool, typer.Option(help="Leave the body standing when the script is over.")] = False,
    scene: Annotated[str, typer.Option(help="A kind of object to add at first; left out: none.")] = "",
    port: Port = "",
    port_keys: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Keys of the port, for human models on other machines.")
    ] = None,
    console: Annotated[
        bool, typer.Option("--console/--no-console", help="Without: moved through its port alone, until interrupted.")
    ] = True,
    as_json: Json = False,
    workspace: Workspace = None,
) -> None:
    """One virtual human and its console. Example: ahmss main --human aiko --server 192.168.0.7"""
    from ahmss.main.start import start_main

    failures = start_main(
        human,
        body,
        at,
        facing,
        server,
        keys,
        script,
        group,
        workspace,
        fast=fast,
        lockstep=lockstep,
        seed=seed,
        stay=stay,
        as_json=as_json,
        port=port,
        port_keys=port_keys,
        console=console,
        scene=scene,
    )
    raise typer.Exit(1 if failures else 0)


@app.command()
def play(
    file: Annotated[Path, typer.Argument(help="A script, or a recording.")],
    fast: Annotated[bool, typer.Option(help="As fast as it can, the same at each run.")] = False,
    seed: Annotated[int, typer.Option(help="For whatever is random.")] = 0,
    record: Annotated[Path | None, typer.Option(help="Record the run into this file.")] = None,
    server: Annotated[
        str, typer.Option(metavar="HOST[:PORT]", help="A server that runs; left out: one of its own, just for this.")
    ] = "",
    fresh: Annotated[
        bool, typer.Option(help="With --server: take away first what the script adds and is there already.")
    ] = False,
    keys: Keys = None,
    workspace: Workspace = None,
) -> None:
    """Play a script or a recording. Example: ahmss play examples/table.txt"""
    from ahmss.main.play import PlaySetup, play_script
    from ahmss.main.replay import is_recording, play_recording

    setup = PlaySetup(fast, seed, record, server, keys, workspace, fresh=fresh)
    if is_recording(file):
        play_recording(file, setup, typer.echo)
        return
    report = play_script(file, setup, lambda address: typer.echo(f"on the server at {address}", err=True))
    typer.echo(str(report))
    if report.failures:
        raise typer.Exit(1)


@app.command()
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
    camera: Annotated[str, typer.Option(help="auto, front, back, left, right, top or close.")] = "auto",
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


@app.command()
def mcp(
    port: Annotated[
        str, typer.Option("--port", metavar="[HOST:]PORT", help="The port of a main; left out: 7427 of this machine.")
    ] = "",
    keys: Annotated[Path | None, typer.Option(metavar="DIR", help="Keys for a main on another machine.")] = None,
    scene: Annotated[
        str, typer.Option(metavar="KIND", help="Start a world of its own with this in it, as room; left out: --port.")
    ] = "",
    human: Annotated[str, typer.Option(help="With --scene: the human's name.")] = "ken",
    body: Annotated[str, typer.Option(help="With --scene: which body of humandb; left out: of that name.")] = "",
    at: Annotated[tuple[float, float], typer.Option(metavar="X Y", help="With --scene: where it stands.")] = (0.0, 0.0),
    facing: Annotated[float, typer.Option(help="With --scene: its heading, degrees.")] = 0.0,
    address: Annotated[
        str, typer.Option(metavar="HOST:PORT", help="With --scene: where its server listens; left out: a free port.")
    ] = "127.0.0.1:0",
    server: Annotated[
        str, typer.Option(metavar="HOST[:PORT]", help="The world, for pictures; left out: where the main says.")
    ] = "",
    server_keys: Annotated[Path | None, typer.Option(metavar="DIR", help="Keys for that server.")] = None,
    workspace: Workspace = None,
) -> None:
    """Let a language model move a human, by the Model Context Protocol. Example: ahmss mcp --scene room"""
    from ahmss.mind.serve import Own, serve

    own = Own(scene, human, body, at, facing, address, workspace) if scene else None
    serve(port, keys, server, server_keys, own)


@app.command("list")
def list_(
    what: Annotated[str, typer.Argument(help="objects, humans, algorithms, or the name of an object.")] = "",
    as_json: Json = False,
    workspace: Workspace = None,
) -> None:
    """What the workspace offers. Example: ahmss list cup"""
    from ahmss.main.listing import list_workspace

    list_workspace(what, workspace, as_json=as_json)


@app.command()
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


@app.command()
def init(directory: Annotated[Path, typer.Argument(help="Where to.")]) -> None:
    """Lay out a workspace of your own. Example: ahmss init ~/my-room"""
    from ahmss.database.layout import init as lay_out
    from ahmss.database.workspace import Workspace as Found

    lay_out(directory, Found.find())
    typer.echo(f"{directory} is ready; work in it: cd {directory} && ahmss up")


@app.command()
def keys(
    directory: Annotated[Path, typer.Argument(help="Where the keys are kept.")] = Path("keys"),
    name: Annotated[str, typer.Option(help="The client's name.")] = "client",
) -> None:
    """Make the keys that a server needs which other machines reach. Example: ahmss keys"""
    from ahmss.world.keys import make

    made = make(directory, name)
    typer.echo("\n".join(f"made {path}" for path in made) or f"{directory}: all keys are there already")


@app.command()
def doctor(as_json: Json = False) -> None:
    """What this machine lacks for windows, pictures and trackers, and how to mend it. Example: ahmss doctor"""
    from ahmss.main.doctor import examine

    if examine(as_json=as_json):
        raise typer.Exit(1)


@app.command()
def bench(
    what: Annotated[
        list[str] | None,
        typer.Argument(
            help="start, compute, display, server, latency, body, lookup, memory, polygons, starts, shown; "
            "left out: all."
        ),
    ] = None,
    as_json: Json = False,
    markdown: Annotated[bool, typer.Option("--markdown", help="A table for the documentation.")] = False,
    scale: Annotated[bool, typer.Option("--scale", help="How the cost grows, with a plot.")] = False,
    picture: Annotated[Path, typer.Option(help="Where the plot goes.")] = Path("out/scale.png"),
    judge: Annotated[
        bool, typer.Option("--judge", help="Measure the actions of the thesis's table 5.9 beside real capture.")
    ] = False,
    script: Annotated[Path | None, typer.Option(help="What --judge plays; left out: the scenario.")] = None,
) -> None:
    """Measure start times and rates, or how natural motions are. Example: ahmss bench --json start compute"""
    from ahmss.bench.run import main as measure

    flags = {"--json": as_json, "--markdown": markdown, "--scale": scale, "--judge": judge}
    given = [flag for flag, asked in flags.items() if asked]
    given += ["--script", str(script)] if script is not None else []
    raise typer.Exit(measure([*(what or []), *given, "--picture", str(picture)]))


def _size(text: str) -> tuple[int, int]:
    """WIDTHxHEIGHT."""
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise typer.BadParameter(f'"{text}" is no size; write it as 1280x720', param_hint="--size")
    return int(width), int(height)


def _fail(sentence: str) -> NoReturn:
    if "--json" in sys.argv:
        print(json.dumps({"error": sentence}))
    print(f"ahmss: {sentence}", file=sys.stderr)
    sys.exit(1)
