"""Pieces of a planned walk, as they are handed out, and how one stands before and after it."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.walking.clearing import UNMOVED, clearing
from ahmss.walking.hesitating import last_moment
from ahmss.walking.journey import Footing, Journey
from ahmss.walking.leeway import Leeway
from ahmss.walking.shaping import Shaping

__all__ = ["Ground", "Piece", "cleared", "footing_at", "piece", "standing_piece"]


@dataclass(frozen=True)
class Ground:
    """What stands on the floor: outlines (n, 2) in the world, whose they are, and up to what height, metres."""

    outlines: Sequence[Array] = ()
    names: Sequence[str] = ()
    tops: Sequence[float] = ()


@dataclass(frozen=True)
class Piece:
    """Frames of a trip to be made next: rotations (n, 15, 4), root (n, 3), ankles (n, 2, 3), feet (n, 2, 4)."""

    rotations: Array
    root: Array
    ankles: Array
    feet: Array


def piece(going: Journey, first: int, last: int) -> Piece:
    """The frames after `first` up to `last`."""
    shaped = going.shaping.part(first + 1, last + 1)
    return Piece(shaped.rotations, shaped.root, shaped.ankles, shaped.feet)


def standing_piece(going: Journey, end: int) -> Piece:
    """The frame in which a walk begins, where `end` is 0, or ends, where it is -1."""
    return piece(going, going.seams[end] - 1, going.seams[end])


def footing_at(going: Journey, end: int) -> Footing:
    """How the walker stands before a walk, where `end` is 0, or after it, where it is -1."""
    prints = [going.shaping.footprint(foot, going.seams[end]) for foot in (0, 1)]
    ankles, headings = np.array([one[0] for one in prints]), np.array([one[1] for one in prints])
    heading = float(np.arctan2(np.sin(headings).sum(), np.cos(headings).sum()))
    return Footing(ankles, headings, going.line.course.points[end], heading)


def cleared(
    skeleton: Skeleton, going: Journey, ground: Ground, held: Array | None
) -> Generator[Piece, None, tuple[Journey, int]]:
    """A walk from standing with its legs kept out of things, and how many of its frames were made meanwhile.

    One is for each part of looking for it, so that no frame waits long; a walk that nothing comes near has none.
    """
    shaping, made = going.shaping, 0
    leeway: Leeway | None = None
    latest = min(UNMOVED, last_moment(going))
    assert isinstance(shaping, Shaping)  # from standing nothing is handed over
    for found in clearing(skeleton, shaping, ground.outlines, ground.tops, held):
        leeway = found
        if made < latest:
            yield piece(going, made, made + 1)
            made += 1
    return going if leeway is None else replace(going, shaping=shaping.moved(leeway)), made
