"""What a human may be told to do, so that what it takes is read before: programs, libraries, motion data."""

from __future__ import annotations

import contextlib
from pathlib import Path

from ahmss.database.records import AlgorithmEntry
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError

__all__ = ["programs"]


def programs(workspace: Workspace) -> list[tuple[AlgorithmEntry, Path | None, int]]:
    """The algorithms of all that the workspace's objects afford, each with its motion data there, and its frames.

    A broken file hides its own kind only; who names it is told.
    """
    found: dict[tuple[Path, tuple[str, ...], Path | None, int], AlgorithmEntry] = {}
    for name in workspace.objects.names():
        with contextlib.suppress(AhmssError):
            kind = workspace.objects.get(name)
            for affordance in kind.affordances.values():
                told = (affordance.motion, affordance.frames)
                entry = workspace.algorithms.find(affordance.human_algorithm, kind.directory)
                found[entry.directory, entry.argv, *told] = entry
                if affordance.object_algorithm is not None:
                    entry = workspace.algorithms.find(affordance.object_algorithm, kind.directory)
                    found[entry.directory, entry.argv, None, 0] = entry
    return [(entry, motion, frames) for (_, _, motion, frames), entry in found.items()]
