"""A script on a server that others use too: its scene may be there already, from the run before."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from ahmss.errors import CommandError
from ahmss.main.command import Add, Remove
from ahmss.main.script import Script, Step
from ahmss.world.client import WorldClient
from ahmss.world.keys import read_client

__all__ = ["make_room"]


def make_room(script: Script, server: str, keys: Path | None, *, fresh: bool) -> None:
    """See that nothing is in the world yet that the script adds: a second cup would leave open which one it means.

    Args:
        script: what is to be played.
        server, keys: where.
        fresh: take away what is in the way, with all that it contains.

    Raises:
        CommandError: something is there already; says in which line, and what to do.
        WorldError: there is no server, or somebody holds what is to be taken away.
    """
    with WorldClient(server, keys=None if keys is None else read_client(keys), follow=False) as client:
        there = set(client.refresh().objects)
        for step, name in _in_the_way(script.steps, there):
            if not fresh:
                inside = len(_parts(name, there))
                more = f", with {inside} objects in it" if inside else ""
                raise CommandError(
                    f"{step.where}: the world at {server} has {name} already{more}, for a scene outlives its script; "
                    f"--fresh takes it away first, and without --server the script has a world of its own"
                )
            if name in there:
                client.remove(name)
            for part in _parts(name, client.refresh().objects):  # what was taken out of it stayed in the world
                client.remove(part)


def _parts(name: str, there: Iterable[str]) -> list[str]:
    """What is named as a part of an object, nothing of which is a part of another of them."""
    inside = sorted(other for other in there if other.startswith(f"{name}/"))
    return [part for part in inside if not any(part.startswith(f"{other}/") for other in inside)]


def _in_the_way(steps: Iterable[Step], there: set[str]) -> list[tuple[Step, str]]:
    """The lines that add what is there already, each with its name; what the script removes itself is not."""
    found: dict[str, Step] = {}
    gone: set[str] = set()
    for step in steps:
        match step.line:
            case Remove(name=name):
                gone.add(name)
            case Add(kind=kind, name=name):
                added = name or kind
                if added not in gone and (added in there or _parts(added, there)):
                    found.setdefault(added, step)
            case _:
                pass
    return [(step, name) for name, step in found.items()]
