"""Whose main has an object follow its file: one at a time, and another's when that one is gone."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ahmss.errors import WorldError
from ahmss.world.things import Thing, Things

__all__ = ["check_keeper", "hand_on", "keep"]


def keep(things: Iterable[Thing], keeper: str) -> None:
    """These were added by a human's main, which follows the files of what is contained in nothing else."""
    for thing in things:
        thing.keeper = "" if thing.parent else keeper


def check_keeper(things: Things, names: Iterable[str], keeper: str) -> None:
    """Refuse what the file of an object says where another's main follows that file now.

    Args:
        things: all. names: of objects, or of what contains those that are new. keeper: the human; "": no file says it.

    Raises:
        WorldError: says whose does.
    """
    for name in names if keeper else ():
        whole = things.get(name)
        while whole.parent in things.by_name:
            whole = things.by_name[whole.parent]
        if whole.keeper not in ("", keeper):
            raise WorldError(f"{whole.name} follows its file by {whole.keeper}'s main now, no longer by {keeper}'s")


def hand_on(things: Things, present: Sequence[str]) -> None:
    """Give what was followed for somebody who is gone to the first of the humans who are present, if there is one.

    Where there is none it stays as it is, until somebody comes.
    """
    here = set(present)
    for thing in things.by_name.values() if present else ():
        if thing.children and thing.keeper and thing.keeper not in here:
            thing.keeper = present[0]
            things.changes.put[thing.name] = None
