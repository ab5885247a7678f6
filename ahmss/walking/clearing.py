"""Legs of a walk kept out of what stands beside it: the body is moved aside where a knee or a foot would be in a thing.

A way keeps the hips' middle clear of things. Who turns on the spot beside one, or sets out or arrives there, swings
knees and feet wider than that, and steps back a little while turning. So does this: it looks at how the walk's legs
would go and moves the body away, and a foot in the air a little more, until they are clear. Where feet stand first and
last they stay, and what is far from things is left as it was.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.motion.contact import runs
from ahmss.motion.easing import minimum_jerk
from ahmss.walking.fence import Fence
from ahmss.walking.leeway import Leeway, bump
from ahmss.walking.limbs import OF_FOOT, Limbs
from ahmss.walking.shaping import Shaping

__all__ = ["clearing", "swaying"]

_NEAR, _WITHIN = 0.7, 0.2  # metres from the hips, and from a leg, beyond which nothing is in its way
_LOOKED = 900  # frames that are looked at: the rest of a longer walk is not
_STEP, _AT_ONCE = 2, 120  # frames between those that are looked at, and how many are made in a part
_ROUNDS, _IN_PART = 6, 3  # how often it is moved more, at the most, and how often in a part
# The legs of who is moved are not just where their points were moved to, and between two things they may be in the
# other then: it is looked at them again, so often at the most, and at the least, as there are frames for it.
_LOOKS, _LOOKS_LEAST = 5, 3
_ENOUGH = 1e-3  # metres that may lack
_WIDTH, _SMOOTH = 32, 4.0  # frames around one for which the body is moved, and over which that is smoothed
_FADE, _ENDING = 16, 30  # frames from not moved to moved as much as it is to be, at the beginning and at the end
_MOST, _MOST_FOOT = 0.22, 0.1  # metres that the body is moved, and a foot in the air more than it
_BY_FOOT = 0.75  # of what a foot in the air lacks, what it is moved by itself
_LOW = 0.2  # of a swing's height: nearer to the ground a foot is not moved by itself
_BESIDE, _SWAYS = 0.35, 0.3  # metres from hips that stand; of a shift of weight, before which it is not looked at
_LIFTED, _SET_OUT = 9, 40  # frames after the shift that are looked at; in which one comes to where one would be


def clearing(
    skeleton: Skeleton, shaping: Shaping, made: int, outlines: Sequence[Array], tops: Sequence[float] = (),
    held: Array | None = None,
) -> Iterator[Leeway | None]:  # fmt: skip
    """By how much a walk is to be moved so that legs keep out of things: the last that comes, None before it is found.

    It may be moved otherwise the next time: it is looked how legs really go then, at every second frame, for a foot
    that swings goes 7 cm in one, and the best so far is taken. Between two things one may come into the other as one
    is moved off the first. Nothing but None comes where legs keep out of things anyway, or nothing else is better.

    Args:
        skeleton: of who walks.
        shaping: the walk as it would be, moved aside at first as `swaying` has it. made: the frame up to which it
            stays.
        outlines: (n, 2) of things, world. tops: how high they are, metres; left out: high.
        held: arms that are kept as they are, as `held_arms` gives them.
    """
    frames, near = _close(shaping.level, outlines)
    fence = Fence([outlines[i] for i in near], _WITHIN, [tops[i] for i in near] if len(tops) else ())
    if not len(frames):
        return
    last, feet = int(frames[-1]) + 1, (0, 1)
    swings = [_Swings.of(shaping.stands[:, foot], frames) for foot in feet]
    begun = shaping.leeway or Leeway.none(shaping.frames, (swings[0].count, swings[1].count))
    fade = _fade(shaping.frames, made)
    since, best, least, in_look = begun, None, np.inf, last // _AT_ONCE + _ROUNDS // _IN_PART + 1
    looks = min(_LOOKS, max(_LOOKS_LEAST, made // in_look))
    for look in range(looks):
        seen = shaping.moved(since) if look else shaping
        for end in range(_AT_ONCE, last, _AT_ONCE):
            seen.part(0, end)
            yield best
        limbs = Limbs.of(skeleton, seen.part(0, last), frames, fence, held)
        stood = [since.foot(own.bears, foot) for foot, own in enumerate(swings)]
        moved, number = since.copy(), 0
        for number in range(_ROUNDS):
            if number % _IN_PART == 0:
                yield best
            push = limbs.push(
                moved.body - since.body, [moved.foot(swings[foot].bears, foot) - stood[foot] for foot in feet]
            )
            lack = np.sqrt((push * push).sum(axis=-1))
            deep = lack.reshape(len(frames), -1)
            if number == 0 and (total := float((deep.max(axis=-1) ** 2).sum())) < least:
                best, least = since if look else None, total
            if lack.max() < _ENOUGH or look == looks - 1:
                break
            for foot, own in enumerate(swings):
                moved.swings[foot][:] = own.more(moved.swings[foot], push[:, foot], lack[:, foot])
            most = push.reshape(len(frames), -1, 2)[np.arange(len(frames)), deep.argmax(axis=-1)]
            moved.body[:] = begun.body + fade * _moved(moved.body - begun.body, frames, most)
        yield best
        if number == 0:
            break
        since = moved


def swaying(
    skeleton: Skeleton, shaping: Shaping, made: int, outlines: Sequence[Array], tops: Sequence[float] = (),
    held: Array | None = None,
) -> Leeway | None:  # fmt: skip
    """By how much who sets out shifts the weight less far, or less far ahead, than into what they stand beside.

    It is found at once, for the first frames wait for it; nobody is brought farther out of a thing than they stand.

    Args:
        skeleton: of who walks. shaping: the walk as it would be. made: frames in which the weight is shifted.
        outlines, tops, held: as for `clearing`.

    Returns:
        None where nothing is near.
    """
    near = [i for i, ring in enumerate(outlines) if Fence([ring], _BESIDE).away(shaping.level[:1])[0][0] < _BESIDE]
    if not near or made < 1:
        return None
    at = np.arange(shaping.frames)
    share = (minimum_jerk(at / made) * minimum_jerk((made + _LIFTED + _SET_OUT - at) / _SET_OUT))[:, None]
    fence = Fence([outlines[i] for i in near], _WITHIN, [tops[i] for i in near] if len(tops) else ())
    end = min(made + _LIFTED, shaping.frames - 1)
    frames = np.append(0, np.arange(end, 0, -_STEP)[::-1])
    limbs = Limbs.of(skeleton, shaping.part(0, end + 1), frames, fence, held)
    by, stays = np.zeros(2), np.zeros((shaping.frames, 2))
    for _ in range(_IN_PART):
        push = limbs.push(share * by, (stays, stays))
        lack = np.sqrt((push * push).sum(axis=-1))
        lack = (lack - lack[0]) * (share[frames, 0] > _SWAYS)[:, None, None]
        worst = np.unravel_index(int(lack.argmax()), lack.shape)
        if lack[worst] < _ENOUGH:
            break
        out = push[worst] / np.sqrt((push[worst] * push[worst]).sum())
        by += lack[worst] / share[frames[worst[0]], 0] * out
    if not by.any():
        return None
    swings = [max(len(runs(shaping.stands[:, foot])) - 1, 0) for foot in (0, 1)]
    return Leeway(share * by, Leeway.none(1, (swings[0], swings[1])).swings)


def _close(level: Array, outlines: Sequence[Array]) -> tuple[NDArray[np.intp], list[int]]:
    """The frames at which hips (F, 2) come near to outlines, and the numbers of those."""
    level = level[:_LOOKED:_STEP]
    low, high = level.min(axis=0) - _NEAR, level.max(axis=0) + _NEAR
    close = np.zeros(len(level), dtype=bool)
    near: list[int] = []
    for i, ring in enumerate(outlines):
        if (ring.max(axis=0) > low).all() and (ring.min(axis=0) < high).all():
            own = Fence([ring], _NEAR).away(level)[0] < _NEAR
            close |= own
            near += [i] if own.any() else []
    return _STEP * np.flatnonzero(close), near


@dataclass(frozen=True)
class _Swings:
    """A foot's swings.

    bears: (F,) whether it is on the ground. count: of swings. which: at the frames looked at (f,), -1: it is in none.
    height: (f,) how far the foot is moved then, of what it is moved half-way.
    """

    bears: NDArray[np.bool_]
    count: int
    which: NDArray[np.intp]
    height: Array

    @classmethod
    def of(cls, bears: NDArray[np.bool_], frames: NDArray[np.intp]) -> _Swings:
        spans = runs(bears)
        which, height = np.full(len(frames), -1), np.zeros(len(frames))
        for i, (one, other) in enumerate(pairwise(spans)):
            u = (frames - one[1] + 1) / (other[0] - one[1] + 1)
            high = (u > 0.0) & (u < 1.0)
            high[high] = bump(u[high]) > _LOW
            which[high], height[high] = i, bump(u[high])
        return cls(bears, max(len(spans) - 1, 0), which, height)

    def more(self, own: Array, push: Array, lack: Array) -> Array:
        """What swings are moved (n, 2) where a leg's points lack so much (f, P) and are to be moved (f, P, 2)."""
        out, rows = own.copy(), np.arange(len(lack))
        worst = lack[:, OF_FOOT].argmax(axis=-1)
        most = np.where(self.which >= 0, lack[:, OF_FOOT][rows, worst], 0.0)
        for i in np.unique(self.which[most > 0.0]):
            k = int(np.where(self.which == i, most, 0.0).argmax())
            out[i] += _BY_FOOT * push[k, OF_FOOT][worst[k]] / self.height[k]
        return _at_most(out, _MOST_FOOT)


def _moved(body: Array, frames: NDArray[np.intp], push: Array) -> Array:
    """How far the body is moved (F, 2) that is to be moved more, at frames (f,) by (f, 2)."""
    wanted = np.zeros((len(body), 3))
    wanted[frames, :2], wanted[frames, 2] = push, push.any(axis=-1)
    kernel = (1.0 - (np.arange(-_WIDTH, _WIDTH + 1) / (_WIDTH + 1)) ** 2) ** 3
    spread = np.stack([np.convolve(row, kernel)[_WIDTH:-_WIDTH] for row in wanted.T], axis=-1)
    body = _at_most(body + spread[:, :2] / np.maximum(spread[:, 2:], 1.0), _MOST)
    return gaussian_filter1d(body, _SMOOTH, axis=0, mode="nearest")


def _fade(frames: int, made: int) -> Array:
    """(F, 1) how far the body may be moved: in the first frames and in the last it stands where it shall."""
    at = np.arange(frames)
    return (minimum_jerk((at - made) / _FADE) * minimum_jerk((frames - 1 - at) / _ENDING))[:, None]


def _at_most(moves: Array, most: float) -> Array:
    length = np.sqrt((moves * moves).sum(axis=-1, keepdims=True))
    return moves * np.minimum(1.0, most / np.maximum(length, 1e-9))
