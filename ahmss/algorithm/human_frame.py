"""The human at one frame, as an algorithm sees it."""

from __future__ import annotations

from ahmss.algorithm.place import Transform
from ahmss.body.array import Array

__all__ = ["HumanFrame"]


class HumanFrame:
    """The human at one frame: `root` (3,), `rotations` (43, 4), `right_grip` and `left_grip` (palms in the world)."""

    def __init__(self, row: Array) -> None:
        """From the first 190 numbers of a FRAME; holds views of them."""
        self.row = row
        self.root = row[1:4]
        self.rotations = row[4:176].reshape(43, 4)

    @property
    def k(self) -> int:
        """The frame, 1 for the first; 0 is where the human was at the start."""
        return int(self.row[0])

    @property
    def right_grip(self) -> Transform:
        """The right palm's frame in the world."""
        return Transform.of(self.row[176:183])

    @property
    def left_grip(self) -> Transform:
        """The left palm's frame in the world."""
        return Transform.of(self.row[183:190])

    def grip(self, hand: str) -> Transform:
        """The palm's frame of the `"right"` or `"left"` hand."""
        return self.left_grip if hand == "left" else self.right_grip
