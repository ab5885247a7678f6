"""Which clips a walk is made of: table A.1 of the thesis (Ichiguchi 2000), and the mixed signs that mirroring misses.

Directions and facings are in whole degrees, positive to the left. A direction is that of the way against the heading at
the start; a facing is the last heading against the way.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

__all__ = [
    "BIN",
    "ENDS",
    "MIXED",
    "ONE_STEP",
    "STARTS",
    "STRAIGHT",
    "TABLE",
    "TWO_STEP",
    "Key",
    "Kind",
    "Side",
    "Stride",
]

Kind = Literal["one_step", "two_step", "start", "straight", "end"]
Stride = Literal["normal", "small"]
Side = Literal["right", "left"]

BIN = 30  # degrees from one clip to the next
STRIDES: tuple[Stride, ...] = ("normal", "small")
SIDES: tuple[Side, ...] = ("right", "left")


@dataclass(frozen=True, order=True)
class Key:
    """A clip's place in the table.

    direction: of one_step, two_step and start. facing: of one_step, two_step and end. stride: of one_step, two_step
    and end. last: of an end, the foot that is put beside the other at last (the other landed at the goal).

    A start leads with the left foot, and a straight has the right foot ahead, about to land; mirrored, the other one.
    """

    kind: Kind
    direction: int = 0
    facing: int = 0
    stride: Stride = "normal"
    last: Side = "right"

    @property
    def name(self) -> str:
        """`two_step_60_-30_small`, as commands and reports name it."""
        match self.kind:
            case "start":
                return f"start_{self.direction}"
            case "straight":
                return "straight"
            case "end":
                return f"end_{self.facing}_{self.stride}_{self.last}"
            case _:
                return f"{self.kind}_{self.direction}_{self.facing}_{self.stride}"

    @property
    def mirrored(self) -> Key:
        """What the clip is when seen in a mirror."""
        last: Side = "left" if self.last == "right" else "right"
        return replace(
            self, direction=-self.direction, facing=-self.facing, last=last if self.kind == "end" else "right"
        )


_HALF = range(0, 181, BIN)
_INNER = range(BIN, 180, BIN)

ONE_STEP: tuple[Key, ...] = tuple(Key("one_step", d, f, s) for s in STRIDES for d in _HALF for f in _HALF)
TWO_STEP: tuple[Key, ...] = tuple(Key("two_step", d, f, s) for s in STRIDES for d in _HALF for f in _HALF)
STARTS: tuple[Key, ...] = tuple(Key("start", d) for d in _HALF)
STRAIGHT: Key = Key("straight")
ENDS: tuple[Key, ...] = tuple(Key("end", 0, f, s, last) for s in STRIDES for last in SIDES for f in _HALF)
TABLE: tuple[Key, ...] = (*ONE_STEP, *TWO_STEP, *STARTS, STRAIGHT, *ENDS)
"""Table A.1: 98 + 98 + 7 + 1 + 28 = 232."""

_NAMES: tuple[Kind, ...] = ("one_step", "two_step")
MIXED: tuple[Key, ...] = tuple(Key(k, d, -f, s) for k in _NAMES for s in STRIDES for d in _INNER for f in _INNER)
"""Steps to the left that end turned to the right: a mirror flips both, so the table has none. 100."""
