"""What an algorithm answers to a frame: a pose of the human, or of the object."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ahmss.algorithm.messages import OBJECT, POSE, TARGETS, WAY, size
from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.errors import ShapeError
from ahmss.motion.way import known

__all__ = ["HumanPose", "ObjectPose", "block", "importance_of", "target_rows"]

HUMAN_ROW = size(POSE)
WAY_ROW = HUMAN_ROW + size(WAY)
OBJECT_ROW = size(OBJECT)
_EVERYTHING = np.ones(len(INDEX) + 1)
_NO_TARGETS = np.zeros((len(TARGETS), 8))


@dataclass(frozen=True, slots=True)
class HumanPose:
    """A frame of a human's motion.

    rotations (43, 4) unit, parent <- child; root (3,) metres; importance (44,) >= 0, the root's last; targets (5, 8):
    right hand, left hand, right foot, left foot, gaze, each place, rotation (zeros: free), weight 0 to 1. `states` are
    states of the target object that this frame changes. way (6, 2): where the human will be, see `ahmss.motion.way`;
    None: it is not told.
    """

    rotations: Array
    root: Array
    importance: Array = field(default_factory=lambda: _EVERYTHING)
    targets: Array = field(default_factory=lambda: _NO_TARGETS)
    states: Mapping[str, Any] = field(default_factory=dict[str, Any])
    way: Array | None = None

    @property
    def width(self) -> int:
        """How many numbers its POSE row has: 260, or 272 with a way."""
        return HUMAN_ROW if self.way is None else WAY_ROW

    def pack(self, row: Array) -> None:
        """Write this into a POSE row (260,) or (272,), as wide as `width`, but for k.

        Raises:
            ShapeError: an array of another shape.
        """
        try:
            row[1:4] = self.root
            row[4:176] = np.reshape(self.rotations, 172)
            row[176:220] = self.importance
            row[220:260] = np.reshape(self.targets, 40)
            if self.way is not None:
                row[HUMAN_ROW:] = np.reshape(self.way, WAY_ROW - HUMAN_ROW)
        except ValueError:
            told = "" if self.way is None else f" and {np.shape(self.way)}"
            raise ShapeError(
                "a pose needs root (3,), rotations (43, 4), importance (44,), targets (5, 8) and, where it tells one, "
                f"a way (6, 2); these are {np.shape(self.root)}, {np.shape(self.rotations)}, "
                f"{np.shape(self.importance)}, {np.shape(self.targets)}{told}"
            ) from None

    @classmethod
    def of(cls, row: Array) -> HumanPose:
        """The pose in a POSE row (260,) or (272,), as views."""
        way = known(row[HUMAN_ROW:]) if len(row) > HUMAN_ROW else None
        return cls(row[4:176].reshape(43, 4), row[1:4], row[176:220], row[220:260].reshape(5, 8), way=way)


@dataclass(frozen=True, slots=True)
class ObjectPose:
    """A frame of an object's motion: place (3,) metres, rotation (4,) unit, and the states that this frame changes."""

    place: Array
    rotation: Array
    states: Mapping[str, Any] = field(default_factory=dict[str, Any])

    @property
    def width(self) -> int:
        """How many numbers its OBJECT row has."""
        return OBJECT_ROW

    def pack(self, row: Array) -> None:
        """Write this into an OBJECT row (8,), but for k.

        Raises:
            ShapeError: an array of another shape.
        """
        try:
            row[1:4] = self.place
            row[4:8] = self.rotation
        except ValueError:
            raise ShapeError(
                "an object's pose needs place (3,) and rotation (4,); these are "
                f"{np.shape(self.place)}, {np.shape(self.rotation)}"
            ) from None

    @classmethod
    def of(cls, row: Array) -> ObjectPose:
        """The pose in an OBJECT row (8,), as views."""
        return cls(row[1:4], row[4:8])


def importance_of(shares: Mapping[str, float], otherwise: float = 0.0) -> Array:
    """Importance (44,) from names of links, `root`, or the start of some links' names such as `right_`.

    A later name overrules an earlier one, so `{"right_": 1, "right_index": 0.5}` does what it says.

    Raises:
        KeyError: a name that is no link's beginning.
    """
    importance = np.full(len(INDEX) + 1, otherwise)
    for name, share in shares.items():
        links = [43] if name == "root" else [INDEX[name]] if name in INDEX else []
        links = links or [i for link, i in INDEX.items() if link.startswith(name)]
        if not links:
            raise KeyError(f"importance of {name!r}: no link begins so; `root` and the links are: {', '.join(INDEX)}")
        importance[links] = share
    return importance


def target_rows(targets: Mapping[str, Array]) -> Array:
    """Targets (5, 8) from rows by name: a place (3,), a place and rotation (7,), or those and a weight (8,).

    Raises:
        KeyError: a name that is none of the five. ShapeError: a row of another length.
    """
    rows = np.zeros((len(TARGETS), 8))
    for name, row in targets.items():
        if name not in TARGETS:
            raise KeyError(f"no target {name!r}; the targets are: {', '.join(TARGETS)}")
        if len(row) not in (3, 7, 8):
            raise ShapeError(f"target {name}: 3, 7 or 8 numbers (place, rotation, weight), not {len(row)}")
        place = TARGETS.index(name)
        rows[place, 7] = 1.0
        rows[place, : len(row)] = row
    return rows


def block(
    rotations: Array,
    root: Array,
    importance: Array | None = None,
    targets: Array | None = None,
    ways: Array | None = None,
) -> Array:
    """Many frames at once: POSE rows (N, 260), which the runtime sends one by one without a thought between.

    Args:
        rotations: (N, 43, 4). root: (N, 3). importance: (44,) or (N, 44), all 1 if left out.
        targets: (5, 8) or (N, 5, 8), none if left out.
        ways: (N, 6, 2) or (6, 2), where the human will be, see `ahmss.motion.way`; with them the rows are (N, 272).

    Raises:
        ShapeError: the arrays do not fit.
    """
    rows = np.zeros((len(rotations), HUMAN_ROW if ways is None else WAY_ROW))
    try:
        rows[:, 1:4] = root
        rows[:, 4:176] = np.reshape(rotations, (-1, 172))
        rows[:, 176:220] = 1.0 if importance is None else importance
        if targets is not None:
            rows[:, 220:HUMAN_ROW] = np.reshape(targets, (-1, 40))
        if ways is not None:
            rows[:, HUMAN_ROW:] = np.reshape(ways, (-1, WAY_ROW - HUMAN_ROW))
    except ValueError:
        shapes = ", ".join(
            "none" if array is None else str(array.shape) for array in (rotations, root, importance, targets, ways)
        )
        raise ShapeError(
            "a block needs rotations (N, 43, 4), root (N, 3), importance (44,) or (N, 44), targets (5, 8) or "
            f"(N, 5, 8), ways (6, 2) or (N, 6, 2); these are {shapes}"
        ) from None
    return rows
