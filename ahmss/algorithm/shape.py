"""The shape of the target as an algorithm sees it: read when it is looked at, its distances kept on disk."""

from __future__ import annotations

import contextlib
import hashlib
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.database import store
from ahmss.database.footprint import parts_of
from ahmss.errors import DataError, ProtocolError
from ahmss.grasping.field import Field

__all__ = ["REACH", "TargetShape"]

REACH = 0.14  # metres around a place that the hand which is there can meet
_GRAIN = 0.01  # metres: places this near to each other share a field
_VERSION = 1  # of what is made: a new one leaves what was kept aside


class TargetShape:
    """A shape in the object's frame, metres.

    Args:
        path: of its GLB, as START names it.
        digest: SHA-256 of that file.
        only: the part of it, which states move or hide; "": what none does; None: all of it.
    """

    def __init__(self, path: str, digest: str, *, only: str | None = None) -> None:
        self.path, self.digest, self._only = path, digest, only
        self._fields: dict[tuple[int, int, int], Field] = {}
        self._own: dict[str, TargetShape] = {}

    @property
    def _triangles(self) -> Array:
        """(T, 3, 3) of it."""
        none = np.zeros((0, 3, 3))
        if self._only is not None:
            return self._parts.get(self._only, none)
        return np.concatenate([none, *self._parts.values()])

    @cached_property
    def _parts(self) -> dict[str, Array]:
        """(T, 3, 3) of each part in the file.

        Raises:
            DataError: it is not where main keeps shapes (its cache may be another than ours), is gone, or has other
                bytes than START says.
        """
        path = Path(self.path)
        if path.resolve().parts[-3:] != ("ahmss", "meshes", f"{self.digest}.glb"):
            raise DataError(self.path, "", "is no shape that is kept; those are ahmss/meshes/SHA-256.glb in the cache")
        data = store.take(path)
        if data is None:
            raise DataError(self.path, "", "is gone; begin the action again, and it is made anew")
        if hashlib.sha256(data).hexdigest() != self.digest:
            raise DataError(self.path, "", "is not the shape that was named; delete it and begin the action again")
        try:
            return parts_of(data)
        except (ProtocolError, LookupError, ValueError) as error:
            raise DataError(self.path, "", f"has no triangles that can be read ({error})") from None

    @property
    def vertices(self) -> Array:
        """(V, 3) corners of the faces, metres; a corner of several faces is there several times."""
        return self._triangles.reshape(-1, 3)

    @property
    def faces(self) -> NDArray[np.intp]:
        """(T, 3) numbers of vertices, counter-clockwise from outside."""
        return np.arange(3 * len(self._triangles)).reshape(-1, 3)

    @cached_property
    def rest(self) -> TargetShape | None:
        """What of it stays as its parts are moved, a tap without its lever; None where it has none, or nothing else.

        Raises:
            DataError: the shape can't be read.
        """
        fixed = self._of("")
        return fixed if 0 < len(fixed._triangles) < len(self._triangles) else None

    def part(self, place: Array) -> TargetShape | None:
        """The part of it nearest to a place (3,) in its frame, of those that states may move; None where it has none.

        Raises:
            DataError: the shape can't be read.
        """
        from ahmss.grasping.distance import distances

        moved = {name: own for name, own in self._parts.items() if name}
        off = {name: float(distances(np.tile(place, (len(own), 1)), own).min()) for name, own in moved.items()}
        return self._of(min(off, key=lambda name: off[name])) if off else None

    def _of(self, only: str) -> TargetShape:
        """That part of it; the file is not read again."""
        if only not in self._own:
            self._own[only] = TargetShape(self.path, self.digest, only=only)
            self._own[only].__dict__["_parts"] = self._parts
        return self._own[only]

    def field(self, place: Array) -> Field:
        """How far points are from what of the shape is within a hand's reach of a place (3,) in the object's frame.

        It takes a second or two where it was never asked for, then a millisecond.

        Raises:
            DataError: the shape can't be read.
            ValueError: nothing of the shape is there.
        """
        x, y, z = np.round(place / _GRAIN).astype(int).tolist()
        found = self._fields.get((x, y, z))
        if found is None:
            found = self._fields[x, y, z] = self._field((x, y, z))
        return found

    def _field(self, cell: tuple[int, int, int]) -> Field:
        kept = Path(self.path).parent.with_name("fields") / self._named(cell)
        data = store.take(kept)
        if data is not None:
            with contextlib.suppress(DataError):  # what was kept is broken: it is made anew
                return Field.from_bytes(data)
        from ahmss.grasping.distance import build  # it brings scipy, which a field that is kept does without

        middle = _GRAIN * np.array(cell)
        made = build(self.vertices, self.faces, middle - REACH, middle + REACH)
        store.keep(kept, made.to_bytes())
        return made

    def _named(self, cell: tuple[int, int, int]) -> str:
        """What the file of the distances around a place is called."""
        return "_".join([self.digest, *self._what(), *map(str, cell), str(_VERSION)])

    def _what(self) -> list[str]:
        """What of the shape it is, in a file's name."""
        if not self._only:
            return [] if self._only is None else ["fixed"]
        return [hashlib.sha256(self._only.encode()).hexdigest()[:12]]
