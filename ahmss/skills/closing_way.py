"""How a hand that closes comes to where it holds: its fingers first open, its palm out on the way, round a corner."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import rotate, slerp
from ahmss.grasping.field import Solid
from ahmss.grasping.hand import Hand
from ahmss.motion.easing import minimum_jerk

__all__ = ["THERE_BY", "fingers_at", "moved_at", "out_by", "palms_at", "there_by"]

THERE_BY = 0.75
"""The share of the time by which the palm is at the wall, where it does not turn far."""

_PEAK = 1.875  # of a minimum jerk's mean speed
_TURNS = np.radians(5.0)  # in a frame, by which a palm turns at the most where there is time

# Where the hand has to open first: open by then, closing from then on; and where its palm takes all of the time.
_WIDE_BY, _CLOSES_FROM = (0.5, 0.56), (0.55, 0.6)
_OUT = (0.0, 0.02, 0.04, 0.06, 0.08, 0.1)  # metres by which the palm goes out on its way, the least first
_LOOKS = np.linspace(0.1, 1.0, 16)  # shares of the time at which the hand is looked at
_DEEP, _SOME = 0.001, 5e-4  # metres that skin may be in the thing; that a longer way must gain


def fingers_at(time: Array, present: Array, shape: Array, wide: Array | None, by: float = THERE_BY) -> Array:
    """The fingers (n, 14, 4) at shares of the time (n), from present ones to a shape, by way of wide ones if given.

    by: the share of the time at which the palm is there.
    """
    if wide is None:
        return slerp(present, shape, minimum_jerk(time)[:, None])
    wide_by, closes_from = (np.interp(by, (THERE_BY, 1.0), ends) for ends in (_WIDE_BY, _CLOSES_FROM))
    opens = slerp(present, wide, minimum_jerk(time / wide_by)[:, None])
    late = minimum_jerk((time - closes_from) / (1.0 - closes_from))[:, None]
    return np.where(late[..., None] > 0.0, slerp(wide, shape, late), opens)


def there_by(start: Array, end: Array, frames: int) -> float:
    """The share of the time of a motion of so many frames by which a palm (7,) is at another: all, if it turns far."""
    turn = 2.0 * float(np.arccos(min(abs(float(start[3:] @ end[3:])), 1.0)))
    return float(np.clip(_PEAK * turn / (_TURNS * max(frames, 1)), THERE_BY, 1.0))


def moved_at(time: Array, by: float) -> Array:
    """How much of its way (n) a palm has done at shares of the time (n), that is there by one of them.

    Where it turns so far that all of the time is needed it keeps its speed for longer: 1.5 times the mean at the most.
    """
    share = np.clip(time / by, 0.0, 1.0)
    return minimum_jerk(share) if by < 1.0 else share * share * (3.0 - 2.0 * share)


def palms_at(time: Array, start: Array, end: Array, out: float = 0.0, by: float = THERE_BY) -> Array:
    """Palms (n, 7) at shares of the time (n), between two (7,), so many metres out on the way: off along its own x.

    by: the share of the time at which it is there.
    """
    done = moved_at(time, by)
    moved, turned = done[:, None], slerp(start[3:], end[3:], done)
    off = rotate(turned, np.array([-1.0, 0.0, 0.0]))
    return np.concatenate([start[:3] + moved * (end - start)[:3] + 4.0 * moved * (1.0 - moved) * out * off, turned], -1)


def out_by(
    hand: Hand, solid: Solid, palms: tuple[Array, Array], fingers: tuple[Array, Array, Array], by: float = THERE_BY
) -> float:
    """Metres by which a palm goes out on its way for no finger to pass through a thing; the least that does.

    Args:
        hand: that closes. solid: the thing; all is in its frame.
        palms: (7,) where it is and where it holds. fingers: (14, 4) as they are, hold, and are wide before.
        by: the share of the time at which the palm is there.
    """
    present, shape, wide = fingers
    way = fingers_at(_LOOKS, present, shape, wide, by)
    ends = (hand.depth(solid, palm[None], some[None]) for palm, some in zip(palms, (present, shape), strict=True))
    enough, best, least = max(_DEEP, *ends) + _SOME, 0.0, np.inf
    for out in _OUT:
        depth = hand.depth(solid, palms_at(_LOOKS, *palms, out, by), way)
        if depth < least - _SOME:
            best, least = out, depth
        if depth < enough:
            break
    return best
