"""An object on the stage: its surfaces, each shown or hidden and perhaps moved within the object."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
import pyrender

from ahmss.body.array import Array
from ahmss.body.quaternion import to_matrix
from ahmss_viewer.batch import Batch
from ahmss_viewer.surface import Surface

__all__ = ["Piece", "Thing", "box_of"]


@dataclass(frozen=True, slots=True)
class Piece:
    """One surface of an object as it looks now. matrix: T_object_surface (4, 4), None where it is at rest."""

    surface: Surface
    shown: bool = True
    matrix: Array | None = None


@dataclass
class Thing:
    """An object on the stage. `box`: its lowest and highest corner (2, 3) in its own frame.

    batches: of its pieces, where it is drawn by itself (`node`), while it or a part of it moves.
    """

    id: int
    name: str
    pieces: tuple[Piece, ...]
    place: Array
    rotation: Array
    box: Array
    node: pyrender.Node | None = None
    batches: list[Batch] = field(default_factory=list[Batch])
    rested: int = 0

    @property
    def matrix(self) -> Array:
        """T_world_object (4, 4)."""
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = to_matrix(self.rotation), self.place
        return T

    def centre(self) -> Array:
        """The middle of its box in the world."""
        return self.matrix[:3, :3] @ self.box.mean(axis=0) + self.place

    def placed(self) -> Iterator[tuple[int, Piece, Array]]:
        """Its pieces with their numbers and T_world_surface."""
        matrix = self.matrix
        for index, piece in enumerate(self.pieces):
            yield index, piece, matrix if piece.matrix is None else matrix @ piece.matrix

    def drawn(self) -> Iterator[tuple[Batch, Array]]:
        """What is shown of it, where it is drawn by itself."""
        for index, piece, matrix in self.placed():
            if piece.shown:
                yield self.batches[index], matrix


def box_of(pieces: Sequence[Piece]) -> Array:
    """The box (2, 3) around surfaces at rest, shown or not."""
    boxes = np.array([piece.surface.bounds() for piece in pieces]) if pieces else np.zeros((1, 2, 3))
    return np.array([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])
