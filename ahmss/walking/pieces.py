"""Pieces of a planned walk, as they are handed out, and how one stands before and after it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.motion.way import staying, ways_of
from ahmss.walking.clearing import clearing, swaying
from ahmss.walking.journey import Footing, Journey
from ahmss.walking.leeway import Leeway
from ahmss.walking.library import RATE
from ahmss.walking.shaping import Shaping

__all__ = [
    "LOOKS", "Clearing", "Ground", "Piece", "footing_at", "part", "piece", "repeated", "setting_out",
    "standing_piece",
]  # fmt: skip

LOOKS = 3, 6, 9, 12, 15, 18, 21
"""Frames of a piece after which one may look whether to go on with it."""


@dataclass(frozen=True)
class Ground:
    """What stands on the floor: outlines (n, 2) in the world, whose they are, and up to what height, metres."""

    outlines: Sequence[Array] = ()
    names: Sequence[str] = ()
    tops: Sequence[float] = ()


@dataclass(frozen=True)
class Piece:
    """Frames of a trip to be made next: rotations (n, 15, 4), root (n, 3), ankles (n, 2, 3), feet (n, 2, 4).

    ways: (n, 6, 2) where the hips will be, told with each frame, as `ahmss.motion.way` has it.
    meanwhile: what is to be thought of before the next piece, of which a part may be done with each frame.
    look: asked after each of `LOOKS` of its frames whether the piece is over with that one, as one suddenly goes
    otherwise; who shows all of it need not ask.
    """

    rotations: Array
    root: Array
    ankles: Array
    feet: Array
    ways: Array
    meanwhile: Clearing | None = field(default=None, kw_only=True)
    look: Callable[[int], bool] | None = field(default=None, kw_only=True)


def piece(going: Journey, first: int, last: int) -> Piece:
    """The frames after `first` up to `last`."""
    shaped = going.shaping.part(first + 1, last + 1)
    ways = ways_of(going.shaping.level, first + 1, last + 1, RATE)
    return Piece(shaped.rotations, shaped.root, shaped.ankles, shaped.feet, ways)


def part(step: Piece, first: int, end: int) -> Piece:
    """The frames of a piece from `first` to the one before `end`."""
    own = slice(first, end)
    return Piece(step.rotations[own], step.root[own], step.ankles[own], step.feet[own], step.ways[own])


def repeated(stands: Piece, count: int) -> Piece:
    """A piece of one frame so many times."""
    parts = (stands.rotations, stands.root, stands.ankles, stands.feet, stands.ways)
    return Piece(*(np.repeat(part, count, axis=0) for part in parts))


def standing_piece(going: Journey, end: int) -> Piece:
    """The frame in which a walk begins, where `end` is 0, or ends, where it is -1."""
    stands = piece(going, going.seams[end] - 1, going.seams[end])
    return replace(stands, ways=staying(stands.root[0, :2])[None])


def footing_at(going: Journey, end: int) -> Footing:
    """How the walker stands before a walk, where `end` is 0, or after it, where it is -1."""
    prints = [going.shaping.footprint(foot, going.seams[end]) for foot in (0, 1)]
    ankles, headings = np.array([one[0] for one in prints]), np.array([one[1] for one in prints])
    heading = float(np.arctan2(np.sin(headings).sum(), np.cos(headings).sum()))
    return Footing(ankles, headings, going.line.course.points[end], heading)


def setting_out(skeleton: Skeleton, going: Journey, made: int, ground: Ground, held: Array | None) -> Journey:
    """A walk from standing, its first frames, in which weight is shifted, kept out of what one stands beside.

    Args:
        skeleton: of who walks. going: the walk as it would be. made: how many frames these are.
        ground: what stands on the floor. held: arms that are kept as they are.
    """
    assert isinstance(going.shaping, Shaping)
    leeway = swaying(skeleton, going.shaping, made, ground.outlines, ground.tops, held)
    return going if leeway is None else replace(going, shaping=going.shaping.moved(leeway))


class Clearing:
    """A walk from standing whose legs are to be kept out of things: thought of a part at a time.

    Args:
        skeleton: of who walks.
        going: the walk as it would be; its frames up to `made` stay.
        ground: what stands on the floor.
        held: arms that are kept as they are, as `held_arms` gives them.
    """

    def __init__(self, skeleton: Skeleton, going: Journey, made: int, ground: Ground, held: Array | None) -> None:
        assert isinstance(going.shaping, Shaping)  # from standing nothing is handed over
        self._going, self._shaping, self._leeway = going, going.shaping, None
        self._parts = clearing(skeleton, going.shaping, made, ground.outlines, ground.tops, held)

    def part(self) -> bool:
        """Think of the next part; whether there was one."""
        for found in self._parts:
            self._leeway = found
            return True
        return False

    def walk(self) -> Journey:
        """The walk, once all is thought of; what is left of that is done now."""
        while self.part():
            pass
        leeway: Leeway | None = self._leeway
        return self._going if leeway is None else replace(self._going, shaping=self._shaping.moved(leeway))
