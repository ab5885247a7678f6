"""Starting one main: with a script's part to carry out, or with its console."""

from __future__ import annotations

import dataclasses
import json
import signal
import sys
from collections import deque
from pathlib import Path

from ahmss.errors import CommandError
from ahmss.main.command import Add, Line
from ahmss.main.process import MainProcess, Setup
from ahmss.main.report import Report
from ahmss.main.script import Step, read_script
from ahmss.port.address import address_of

__all__ = ["start_main"]


def start_main(
    human: str, body: str, place: tuple[float, float], facing_deg: float, server: str, keys: Path | None,
    script: Path | None, group: str, workspace: Path | None, *, fast: bool, lockstep: bool, seed: int,
    stay: bool, as_json: bool, port: str = "", port_keys: Path | None = None, console: bool = True,
    scene: str = "",
) -> int:  # fmt: skip
    """Run one main to its end; returns how many things went wrong.

    Raises:
        AhmssError: the script or the body is wrong, or there is no server.
    """
    client_keys = None
    if keys is not None:
        from ahmss.world.keys import read_client

        client_keys = read_client(keys)
    setup = Setup(
        human, body, place, facing_deg, server, workspace, fast, lockstep, seed, group=group, keys=client_keys,
        port=address_of(port) if port else None, port_keys=port_keys,
    )  # fmt: skip
    if fast and port:
        raise CommandError("--fast has no clock for a human model to go by; leave it out, or --port")
    first: list[Line] = [Add(scene)] if scene else []
    if script is None and not console:
        return _serve(setup, first, as_json=as_json)
    if script is None:
        from ahmss.main.console import run_console

        return run_console(setup, first)
    steps, setup = _part(script, setup)
    report = _carry_out(setup, steps, stay=stay or len(setup.names) > 1)
    if as_json:
        print(json.dumps(dataclasses.asdict(report)), flush=True)
    return report.failures


def _serve(setup: Setup, first: list[Line], *, as_json: bool) -> int:
    """A main without a console, moved through its port until it is interrupted or terminated."""
    if setup.port is None:
        raise CommandError("a main without a console is moved through its port; name one: --port 7427")

    def say(text: str) -> None:
        print(text, file=sys.stderr, flush=True)

    signal.signal(signal.SIGTERM, signal.default_int_handler)
    main = MainProcess(setup, say)
    assert main.port is not None
    main.agenda.said = say
    try:
        _set_the_scene(main, first)
    except BaseException:
        main.close()
        raise
    said = {"human": setup.human, "port": str(main.port.address), "server": str(main.communication.client.address)}
    print(json.dumps(said) if as_json else f"human models reach {said['human']} at {said['port']}", flush=True)
    try:
        main.run(lambda: False)
    except KeyboardInterrupt:
        say("stopped")
    finally:
        main.close()
    return 0


def _set_the_scene(main: MainProcess, first: list[Line]) -> None:
    """Carry these lines out before anybody is let in. CommandError: one can't be."""
    main.agenda.set_the_scene(first)
    main.run(lambda: main.agenda.done)
    if main.report.failures:
        raise CommandError(main.report.messages[-1])


def _part(path: Path, setup: Setup) -> tuple[deque[Step], Setup]:
    """The human's part of a script, and the setup with what the script says of it."""
    script = read_script(path)
    for human in script.humans:
        if human.name == setup.human:
            names = tuple(h.name for h in script.humans)
            said = dataclasses.replace(
                setup, body=human.body, place=human.place, facing_deg=human.facing_deg, names=names
            )
            return deque(script.part_of(human.name)), said
    raise CommandError(f'{path}: no human "{setup.human}" in it; it has: {", ".join(h.name for h in script.humans)}')


def _carry_out(setup: Setup, steps: deque[Step], *, stay: bool) -> Report:
    """A script's part; Ctrl-C ends it in good order."""
    several = len(setup.names) > 1

    def say(text: str) -> None:
        print(f"{setup.human}: {text}" if several else text, file=sys.stderr, flush=True)

    signal.signal(signal.SIGTERM, signal.default_int_handler)
    main = MainProcess(setup, say)
    try:
        return main.play(steps)
    except KeyboardInterrupt:
        say("stopped")
        main.report.failures += 1
        return main.report
    finally:
        main.close(stay=stay)
