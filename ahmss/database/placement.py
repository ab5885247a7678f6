"""Objects made of objects: from a kind and a pose to everything in it, and what changed between two such lists."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import msgspec
import numpy as np

from ahmss.body.quaternion import multiply, rotate
from ahmss.database.records import ObjectKind, Quaternion, Vector
from ahmss.errors import CommandError, DataError

__all__ = ["Changes", "Placed", "difference", "expand"]

_MOST = 20_000  # objects in one


class Placed(msgspec.Struct, frozen=True):
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

    def visit(record: ObjectKind, placed: Placed, chain: tuple[str, ...]) -> None:
        out.append(placed)
        if len(out) > _MOST:
            raise DataError(label(record.directory / "object.toml"), "contains", f"more than {_MOST} objects in one")
        for i, entry in enumerate(record.contains):
            place = f"contains[{i}].kind"
            file = label(record.directory / "object.toml")
            if entry.kind in chain:
                circle = " contains ".join((*chain[chain.index(entry.kind) :], entry.kind))
                raise DataError(file, place, f"a circle: {circle}; take one of them out")
            try:
                child = kind_of(entry.kind)
            except CommandError as error:
                raise DataError(file, place, str(error)) from None
            local = (entry.position, entry.rotation)
            at, turn = _compose(placed.position, placed.rotation, *local)
            inner = Placed(f"{placed.name}/{entry.name}", entry.kind, placed.name, at, turn, *local)
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
    replaced = {n for n, p in new.items() if n in old and old[n].kind != p.kind}
    replaced |= {n for n in new if any(n.startswith(f"{r}/") for r in replaced)}
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


def _compose(
    position: Vector, rotation: Quaternion, local_position: Vector, local_rotation: Quaternion
) -> tuple[Vector, Quaternion]:
    """The world pose of a local pose in a frame."""
    q = np.array(rotation)
    at = np.array(position) + rotate(q, np.array(local_position))
    turn = multiply(q, np.array(local_rotation))
    return (float(at[0]), float(at[1]), float(at[2])), (float(turn[0]), float(turn[1]), float(turn[2]), float(turn[3]))
