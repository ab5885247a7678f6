"""All that stands still, merged: one draw for each texture instead of one for each object.

An object that begins to move is lifted out (its faces become empty), one that comes to rest is put back in its old
room in the buffers; only new objects make the buffers anew.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pyrender import Texture

from ahmss_viewer.batch import Batch, pack
from ahmss_viewer.surface import Surface

__all__ = ["Merged"]


@dataclass
class _Part:
    """One surface of one object and its room in the buffers."""

    surface: Surface
    T_world_object: NDArray[Any]
    lifted: bool = False
    first_vertex: int = 0
    first_face: int = 0


class Merged:
    """The still surfaces of one texture, all seen from both sides or none; `version` counts what changed."""

    def __init__(self, texture: Texture | None, *, two_sided: bool) -> None:
        self.texture = texture
        self.two_sided = two_sided
        self.version = 0
        self._parts: dict[tuple[int, int], _Part] = {}
        self._batch: Batch | None = None
        self._old: Batch | None = None
        self._bounds: NDArray[Any] | None = None

    def put(self, key: tuple[int, int], surface: Surface, T_world_object: NDArray[Any]) -> None:
        """Add a surface at a place, or put a known one (lifted or not) at another place."""
        self.version += 1
        self._bounds = None
        part = self._parts.get(key)
        if part is None or not _fits(part.surface, surface):
            self._parts[key] = _Part(surface, T_world_object)
            self._discard()
            return
        part.surface, part.T_world_object, part.lifted = surface, T_world_object, False
        if self._batch is not None:
            vertices = pack(surface, T_world_object)
            self._batch.update(part.first_vertex, vertices, part.first_face, surface.faces + part.first_vertex)

    def lift(self, key: tuple[int, int]) -> None:
        """Draw this surface no longer, but keep its room."""
        part = self._parts.get(key)
        if part is None or part.lifted:
            return
        self.version += 1
        self._bounds = None
        part.lifted = True
        if self._batch is not None:
            self._batch.update(part.first_vertex, None, part.first_face, np.zeros_like(part.surface.faces))

    def remove(self, key: tuple[int, int]) -> None:
        """Forget this surface."""
        if self._parts.pop(key, None) is not None:
            self.version += 1
            self._bounds = None
            self._discard()

    def batch(self) -> Batch | None:
        """What is to be drawn, made now if need be; None where there is nothing."""
        if self._old is not None:
            self._old.delete()
            self._old = None
        if self._batch is None and self._parts:
            self._batch = self._merge()
        return self._batch

    def bounds(self) -> NDArray[Any] | None:
        """Lowest and highest corner (2, 3) of what stands, in the world."""
        if self._bounds is None:
            boxes = [_corners(part) for part in self._parts.values() if not part.lifted]
            if boxes:
                corners = np.concatenate(boxes)
                self._bounds = np.array([corners.min(axis=0), corners.max(axis=0)])
        return self._bounds

    def _merge(self) -> Batch:
        """New buffers with room for every part, small things first: what they hide of large ones costs nothing."""
        vertices: list[NDArray[Any]] = []
        faces: list[NDArray[Any]] = []
        at_vertex = at_face = 0
        for part in sorted(self._parts.values(), key=lambda part: float(np.ptp(part.surface.bounds(), axis=0).sum())):
            part.first_vertex, part.first_face = at_vertex, at_face
            vertices.append(pack(part.surface, part.T_world_object))
            shown = part.surface.faces
            faces.append(np.zeros_like(shown) if part.lifted else shown + np.uint32(at_vertex))
            at_vertex += len(vertices[-1])
            at_face += len(shown)
        return Batch(np.concatenate(vertices), np.concatenate(faces), self.texture, two_sided=self.two_sided)

    def _discard(self) -> None:
        """The buffers no longer fit; they are freed at the next draw, when the context is current."""
        if self._batch is not None:
            self._old, self._batch = self._batch, None


def _fits(old: Surface, new: Surface) -> bool:
    """Whether a surface has room where another was."""
    return old is new or (len(old.positions) == len(new.positions) and len(old.faces) == len(new.faces))


def _corners(part: _Part) -> NDArray[Any]:
    """The eight corners of a part's box in the world."""
    low, high = part.surface.bounds()
    choice = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    corners = np.where(choice == 0, low, high)
    return corners @ part.T_world_object[:3, :3].T + part.T_world_object[:3, 3]
