"""How far hands are from where they are to be: from what a motion wants, and from the thing that they move."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ahmss.bench.acted import Acted, Thing
from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.quaternion import conjugate, rotate
from ahmss.motion.contact import runs

__all__ = ["off_target", "slips"]

_SETTLING = 0.5  # seconds after a change of motion in which a hand glides over to the new one's target
_ARRIVES = 0.2  # seconds that a hand may come after a target that has just come to a stand
_STILL = 0.01  # metres a second, of a palm that is wanted somewhere
_MOVES = 1e-6  # metres, or half radians, from one frame to the next


def off_target(acted: Acted) -> Array:
    """Metres (F,) by which the worse of the two palms is off its target where it counts; 0 elsewhere.

    It counts where the hand is to be at something: with the last frame of a motion that wants it somewhere, and while
    what it wants stands still. On the way a hand goes as its joints let it, and for half a second after another motion
    has taken it over it glides; neither is an error that somebody could see.
    """
    palms = grips(acted.skeleton, acted.rotations, acted.root)[..., :3]
    apart = np.linalg.norm(palms - acted.wanted[..., :3], axis=-1)
    steps = np.linalg.norm(np.diff(acted.wanted[..., :3], axis=0, prepend=np.nan), axis=-1) * acted.rate
    for hand in range(2):
        owner = acted.owner[:, hand]
        counts = (steps[:, hand] < _STILL) & (owner > 0)
        for first, end in runs(counts):
            counts[first : min(first + round(_ARRIVES * acted.rate), end)] = False
        for first in np.flatnonzero(np.diff(owner, prepend=0)):
            counts[first : first + round(_SETTLING * acted.rate)] = False
        for number in set(owner.tolist()) - {0}:
            counts[np.flatnonzero(owner == number)[-1]] = True
        apart[~counts, hand] = 0.0
    return np.nan_to_num(apart).max(axis=-1)


def slips(acted: Acted) -> Array:
    """Metres (F,) by which a thing that the human holds is elsewhere in its palm than when it began to move.

    Of two hands the one counts in which the thing keeps its place better. A door, a lever or a button is in no hand:
    who moves it may let go of it, take it with the other hand, or slide along it.
    """
    palms = grips(acted.skeleton, acted.rotations, acted.root)
    worst = np.zeros(len(acted.root))
    for thing in acted.things.values():
        for first, end in runs(_held(thing, acted.human)):
            inner = np.stack([_in_palm(thing.poses[first:end], palms[first:end, hand]) for hand in range(2)])
            apart = np.linalg.norm(inner - inner[:, :1], axis=-1)
            worst[first:end] = np.maximum(worst[first:end], apart[apart.max(axis=-1).argmin()])
    return worst


def _held(thing: Thing, human: str) -> NDArray[np.bool_]:
    """In which frames (F,) the human has it in a hand, from the first in which it moves."""
    poses = thing.poses
    steps = np.nan_to_num(np.abs(np.diff(poses, axis=0, prepend=poses[:1])).max(axis=-1))
    held = np.array([who == human and hand != "" for who, hand in zip(thing.holders, thing.hands, strict=True)])
    for first, end in runs(held):
        moving = np.flatnonzero(steps[first:end] > _MOVES)
        held[first : first + int(moving[0]) if len(moving) else end] = False
    return held


def _in_palm(poses: Array, palms: Array) -> Array:
    """The places (n, 3) of a thing (n, 7) in a palm's frame (n, 7)."""
    return rotate(conjugate(palms[:, 3:]), poses[:, :3] - palms[:, :3])
