"""`ahmss up`, `server`, `main`, `play`, `demo` and `mcp`: what runs. Each imports what it needs only when it runs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ahmss.cli_options import Json, Keys, Port, Server, Workspace

__all__ = ["demo", "main_process", "mcp", "play", "server", "up"]


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


def up(
    human: Annotated[str, typer.Option(help="The human's name.")] = "ken",
    body: Annotated[str, typer.Option(help="Which body of humandb; left out: of that name.")] = "",
    scene: Annotated[str, typer.Option(help="A kind of object to add at first; empty: none.")] = "room",
    address: Annotated[
        str, typer.Option(metavar="HOST:PORT", help="Where the server listens, and on the port after it.")
    ] = "",
    port: Port = "",
    workspace: Workspace = None,
) -> None:
    """Server, viewer and main on this machine, with the console. Example: ahmss up --human aiko --body aiko"""
    from ahmss.main.up import run_up

    if run_up(human, body, scene, address, workspace, port):
        raise typer.Exit(1)


def server(
    address: Annotated[
        str,
        typer.Option(
            metavar="HOST[:PORT]",
            help="Where to listen, and on the port after it for snapshots; other machines: 0.0.0.0.",
        ),
    ] = "",
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
    from ahmss.main.seeing import how_to_see

    setup = PlaySetup(fast, seed, record, server, keys, workspace, fresh=fresh)
    if is_recording(file):
        play_recording(file, setup, typer.echo)
        return
    report = play_script(file, setup, lambda address: typer.echo(f"on the server at {address}", err=True))
    typer.echo(str(report))
    typer.echo(how_to_see(file, setup), err=True)
    if report.failures:
        raise typer.Exit(1)


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
