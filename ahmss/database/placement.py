"""Objects made of objects: from a kind and a pose to everything in it, and what changed between two such lists."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

import msgspec
import numpy as np

from ahmss.body.quaternion import multiply, rotate
from ahmss.database.records import Contained, ObjectKind, Quaternion, Vector
from ahmss.errors import CommandError, DataError

__all__ = ["Changes", "Placed", "difference", "expand"]

_MOST = 20_000  # objects in one
_DEEPEST = 32  # objects in objects in objects


class Placed(msgspec.Struct, frozen=True, gc=False):
    """One object at its place: `name` is `panel/button_3`, `parent` is `panel` ("" for the outermost).

    position, rotation: in the world. local_position, local_rotation: in the parent's frame (the world's for the
    outermost), as the file says.
    """

    name: str
    kind: str
    parent: str
    position: Vector
    rotation: Quaternion
    local_position: Vector
    local_rotation: Quaternion


class Changes(msgspec.Struct, frozen=True):
    """What is to be done to get from one list of placed objects to another; removed are names, children first."""

    added: tuple[Placed, ...] = ()
    moved: tuple[Placed, ...] = ()
    removed: tuple[str, ...] = ()


def expand(
    kind_of: Callable[[str], ObjectKind],
    label: Callable[[Path], str],
    kind: str,
    name: str,
    position: Vector,
    rotation: Quaternion,
) -> tuple[Placed, ...]:
    """The object `name` of a kind and all it contains, parents before children (see `ObjectDatabase.place`)."""
    out: list[Placed] = []
    kind_of = cache(kind_of)  # looked up once, however often it is contained

    def visit(record: ObjectKind, placed: Placed, chain: tuple[str, ...]) -> None:
        out.append(placed)
        entries = record.contains
        if not entries:
            return
        file = label(record.directory / "object.toml")
        if len(out) + len(entries) > _MOST:
            raise DataError(file, "contains", f"more than {_MOST} objects in one")
        if len(chain) > _DEEPEST:
            raise DataError(file, "contains", f"objects in objects, more than {_DEEPEST} deep; put some side by side")
        positions, rotations = _in_world(placed, entries)
        for i, entry in enumerate(entries):
            place = f"contains[{i}].kind"
            if entry.kind in chain:
                circle = " contains ".join((*chain[chain.index(entry.kind) :], entry.kind))
                raise DataError(file, place, f"a circle: {circle}; take one of them out")
            try:
                child = kind_of(entry.kind)
            except CommandError as error:
                raise DataError(file, place, str(error)) from None
            inner = Placed(
                f"{placed.name}/{entry.name}", entry.kind, placed.name,
                positions[i], rotations[i], entry.position, entry.rotation,
            )  # fmt: skip
            visit(child, inner, (*chain, entry.kind))

    visit(kind_of(kind), Placed(name, kind, "", position, rotation, position, rotation), (kind,))
    return tuple(out)


def difference(before: Sequence[Placed], after: Sequence[Placed]) -> Changes:
    """What changed between two expansions of one object: entries added, moved by their file, removed.

    An entry whose kind changed is removed and added. A child is moved only where its own place in its parent changed;
    what its parent does carries it anyway.
    """
    old = {p.name: p for p in before}
    new = {p.name: p for p in after}
    replaced: set[str] = set()
    for n, p in new.items():  # parents come before what they contain
        if p.parent in replaced or (n in old and old[n].kind != p.kind):
            replaced.add(n)
    added = tuple(p for n, p in new.items() if n not in old or n in replaced)
    removed = tuple(n for n in reversed(list(old)) if n not in new or n in replaced)
    moved = tuple(
        p
        for n, p in new.items()
        if n in old
        and n not in replaced
        and (p.local_position, p.local_rotation) != (old[n].local_position, old[n].local_rotation)
    )
    return Changes(added, moved, removed)


def _in_world(parent: Placed, entries: Sequence[Contained]) -> tuple[list[Vector], list[Quaternion]]:
    """Where the entries of a placed object are in the world."""
    turn = np.array(parent.rotation)
    positions = parent.position + rotate(turn, np.array([entry.position for entry in entries]))
    rotations = multiply(turn, np.array([entry.rotation for entry in entries]))
    return [(x, y, z) for x, y, z in positions.tolist()], [(w, x, y, z) for w, x, y, z in rotations.tolist()]
