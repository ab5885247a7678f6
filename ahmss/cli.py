"""The command line: each command calls one function, and imports what it needs only when it runs."""

from __future__ import annotations

import json
import logging
import os
import sys
from pathlib import Path
from typing import Annotated, NoReturn

import typer

from ahmss.cli_capture import capture_app
from ahmss.cli_motion import motion_app
from ahmss.cli_options import Json
from ahmss.cli_running import demo, main_process, mcp, play, server, up
from ahmss.cli_view import view
from ahmss.cli_walk import walk_app
from ahmss.cli_workspace import check, init, list_, new_app
from ahmss.errors import AhmssError

__all__ = ["app", "main"]

app = typer.Typer(
    name="ahmss", no_args_is_help=True, add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False,
    help="Virtual humans that act on objects which know how.",
)  # fmt: skip
app.add_typer(new_app, name="new")
app.add_typer(motion_app, name="motion")
app.add_typer(capture_app, name="capture")
app.add_typer(walk_app, name="walk")

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


# In the order in which help lists them; the others are below.
for _name, _command in {
    "demo": demo, "up": up, "server": server, "main": main_process, "play": play, "view": view, "mcp": mcp,
    "list": list_, "check": check, "init": init,
}.items():  # fmt: skip
    app.command(_name)(_command)


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


def _fail(sentence: str) -> NoReturn:
    if "--json" in sys.argv:
        print(json.dumps({"error": sentence}))
    print(f"ahmss: {sentence}", file=sys.stderr)
    sys.exit(1)
