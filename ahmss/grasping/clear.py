"""Ways of a hand onto what it takes, or off it, of which the first is gone that is clear of it."""

from __future__ import annotations

from collections.abc import Generator, Iterable

import numpy as np

from ahmss.body.array import Array
from ahmss.grasping.field import Solid
from ahmss.grasping.hand import Hand

__all__ = ["first_clear"]

_AIR = 0.003  # metres between fingers and things once the palm has moved
_MOVED = 0.005  # metres from where it holds, up to which the fingers may be as near as they are there
_SOME = 5e-4  # metres that count as none


def first_clear(
    hand: Hand, solid: Solid, ways: Iterable[tuple[Array, Array]], held: tuple[Array, Array]
) -> Generator[None, None, int]:
    """The number of the first way on which the fingers are not in a thing; where all are, of the least bad one.

    It pauses after each way that is not clear.

    Args:
        hand: that goes there.
        solid: the thing; all is in its frame.
        ways: palms (F, 7) and fingers (F, 14, 4) of each.
        held: the palm (7,) and the fingers (14, 4) that hold it: near there they may be as deep as then.

    Raises:
        ValueError: there are no ways.
    """
    palm, fist = held
    there = max(hand.depth(solid, palm[None], fist[None]), 0.0) + _SOME
    least, best = np.inf, -1
    for number, (palms, fingers) in enumerate(ways):
        moved = np.linalg.norm(palms[:, :3] - palm[:3], axis=-1) > _MOVED
        lack = -np.inf
        if moved.any():
            lack = hand.depth(solid, palms[moved], fingers[moved]) + _AIR
        if not moved.all():
            lack = max(lack, hand.depth(solid, palms[~moved], fingers[~moved]) - there)
        if lack < least - _SOME:
            least, best = lack, number
        if lack <= 0.0:
            break
        yield
    if best < 0:
        raise ValueError("there are no ways")
    return best
