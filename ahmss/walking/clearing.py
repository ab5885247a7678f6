"""Legs of a walk kept out of what stands beside it: the body is moved aside where a knee or a foot would be in a thing.

A way keeps the hips' middle clear of things. Who turns on the spot beside one, or sets out or arrives there, swings
knees and feet wider than that, and steps back a little while turning. So does this: it looks at how the walk's legs
would go and moves the body away, and a foot in the air a little more, until they are clear. Where feet stand first and
last they stay, and what is far from things is left as it was.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.contact import runs
from ahmss.motion.easing import minimum_jerk
from ahmss.walking.fence import Fence
from ahmss.walking.leeway import Leeway, bump
from ahmss.walking.shaping import Shaped, Shaping

__all__ = ["clearing", "held_arms", "swaying"]

_NEAR, _WITHIN = 0.7, 0.2  # metres from the hips, and from a leg, beyond which nothing is in its way
_LOOKED = 900  # frames that are looked at: the rest of a longer walk is not
_STEP, _AT_ONCE = 3, 60  # frames between those that are looked at, and how many are made in a part
_ROUNDS, _IN_PART = 12, 3  # how often it is moved more, at the most, and how often in a part
_LOOKS = 2  # the legs of who is moved are not just where their points were moved to: it is looked at them again
_ENOUGH = 1e-3  # metres that may lack
_WIDTH, _SMOOTH = 32, 4.0  # frames around one for which the body is moved, and over which that is smoothed
_FADE, _ENDING = 16, 30  # frames from not moved to moved as much as it is to be, at the beginning and at the end
_MOST, _MOST_FOOT = 0.22, 0.1  # metres that the body is moved, and a foot in the air more than it
_BY_FOOT = 0.75  # of what a foot in the air lacks, what it is moved by itself
_LOW = 0.2  # of a swing's height: nearer to the ground a foot is not moved by itself
_UPPER, _LOWER = ([INDEX[f"{side}_{part}_leg"] for side in ("right", "left")] for part in ("upper", "lower"))
_SPINE = INDEX["spine"]
_SHOULDERS, _ELBOWS = ([INDEX[f"{side}_{part}_arm"] for side in ("right", "left")] for part in ("upper", "lower"))
_MIRROR = np.array([1.0, -1.0, 1.0])
# Hip joint, thigh, knee, shank, ankle, heel, toes; shoulder, elbow, forearm, wrist, fingers: how thick it is there in
# the stouter of the bodies that ship, and a little more, metres; by how much it goes with the foot, else with the hips.
_THICK = np.array([0.116, 0.086, 0.068, 0.072, 0.068, 0.051, 0.051, 0.06, 0.065, 0.055, 0.05, 0.05])
_WITH_FOOT = np.array([0.0, 0.3, 0.5, 0.75, 0.95, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
_OF_FOOT, _OF_ARM = slice(4, 7), 4
_BESIDE, _SWAYS = 0.35, 0.3  # metres from hips that stand; of a shift of weight, before which it is not looked at
_LIFTED, _SET_OUT = 9, 40  # frames after the shift that are looked at; in which one comes to where one would be
_THING = 0.02  # metres that a point of what is in a hand keeps


def clearing(
    skeleton: Skeleton, shaping: Shaping, made: int, outlines: Sequence[Array], tops: Sequence[float] = (),
    held: Array | None = None,
) -> Iterator[Leeway | None]:  # fmt: skip
    """By how much a walk is to be moved so that legs keep out of things: the last that comes, None before it is found.

    It may be moved a little more the next time. Nothing but None comes where legs keep out of things anyway.

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
    moved, fade = begun.copy(), _fade(shaping.frames, made)
    for look in range(_LOOKS):
        since = moved.copy()
        seen = shaping.moved(since) if look else shaping
        for end in range(_AT_ONCE, last, _AT_ONCE):
            seen.part(0, end)
            yield moved if look else None
        limbs = _Limbs.of(skeleton, seen.part(0, last), frames, fence, held)
        stood = [since.foot(own.bears, foot) for foot, own in enumerate(swings)]
        for number in range(_ROUNDS):
            if number % _IN_PART == 0:
                yield moved if look or number else None
            push = limbs.push(
                moved.body - since.body, [moved.foot(swings[foot].bears, foot) - stood[foot] for foot in feet]
            )
            lack = np.sqrt((push * push).sum(axis=-1))
            if lack.max() < _ENOUGH:
                if number == 0:
                    return
                break
            for foot, own in enumerate(swings):
                moved.swings[foot][:] = own.more(moved.swings[foot], push[:, foot], lack[:, foot])
            worst = lack.reshape(len(frames), -1).argmax(axis=-1)
            most = push.reshape(len(frames), -1, 2)[np.arange(len(frames)), worst]
            moved.body[:] = begun.body + fade * _moved(moved.body - begun.body, frames, most)
        yield moved


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
    limbs = _Limbs.of(skeleton, shaping.part(0, end + 1), frames, fence, held)
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


def held_arms(
    skeleton: Skeleton, rotations: Array, root: Array, sides: Sequence[str], things: Mapping[str, Array] | None = None
) -> Array:
    """Elbow, forearm, wrist and fingers of arms that stay as they are in a pose (43, 4), (3,), against its hips.

    Args:
        skeleton: whose. rotations, root: the pose. sides: of the arms.
        things: points (n, 3) of what is in the hand of a side, in the hand's frame.

    Returns:
        (2, 4 + n, 3) right and left, with what is in their hands; nan for an arm that is not among the sides.
    """
    places, turned = forward(rotations, root, skeleton.offsets)
    things = things or {}
    out = np.full((2, _OF_ARM + max((len(points) for points in things.values()), default=0), 3), np.nan)
    for i, side in enumerate(("right", "left")):
        if side in sides:
            elbow, wrist, finger = (INDEX[f"{side}_{name}"] for name in ("lower_arm", "hand", "middle_intermediate"))
            points = [places[elbow], 0.5 * (places[elbow] + places[wrist]), places[wrist], places[finger]]
            points += [*(places[wrist] + rotate(turned[wrist], things.get(side, np.zeros((0, 3)))))]
            out[i, : len(points)] = rotate(conjugate(turned[0]), np.array(points) - root)
    return out


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


class _Limbs:
    """Points (f, 2, P, 3) of legs and elbows at the frames that are looked at, and how clear of things they are."""

    def __init__(self, frames: NDArray[np.intp], points: Array, fence: Fence) -> None:
        self._frames, self._points, self._fence = frames, points[..., :2], fence
        more = points.shape[2] - len(_THICK)
        thick, self._with_foot = np.append(_THICK, np.full(more, _THING)), np.append(_WITH_FOOT, np.zeros(more))
        self._lows = (points[..., 2] - thick).reshape(-1)
        self._thick = np.broadcast_to(thick, points.shape[:-1]).reshape(-1)
        self._seen = self._points.reshape(-1, 2).copy()  # where points were when it was looked at how far they are
        self._away, self._out = fence.away(self._seen, self._lows)

    @classmethod
    def of(
        cls, skeleton: Skeleton, shaped: Shaped, frames: NDArray[np.intp], fence: Fence, held: Array | None
    ) -> _Limbs:
        """Of a walk."""
        hips, root = shaped.rotations[frames, :1], shaped.root[frames]
        joints = root[:, None] + rotate(hips, skeleton.offsets[_UPPER])
        thighs = multiply(hips, shaped.rotations[frames][:, _UPPER])
        knees = joints + rotate(thighs, skeleton.offsets[_LOWER])
        ankles, feet = shaped.ankles[frames], shaped.feet[frames]
        soles = np.stack([skeleton.soles, skeleton.soles * _MIRROR])
        heels, toes = soles[:, 0] * (0.5, 1.0, 0.5), soles[:, 2] * (0.82, 1.0, 0.5)
        points = np.stack([
            joints, joints + 0.65 * (knees - joints), knees, 0.5 * (knees + ankles), ankles,
            ankles + rotate(feet, heels), ankles + rotate(feet, toes),
        ], axis=2)  # fmt: skip
        count = _OF_ARM if held is None else held.shape[1]
        shoulders, elbows = _hanging(skeleton, shaped, frames)
        arms = np.repeat(elbows[:, :, None], count, axis=2)
        if held is not None:
            stay = root[:, None, None] + rotate(hips[:, :, None], held)
            arms = np.where(np.isnan(held), arms, stay)
        return cls(frames, np.concatenate([points, shoulders[:, :, None], arms], axis=2), fence)

    def push(self, body: Array, feet: Sequence[Array]) -> Array:
        """By how much the points are to be moved (f, 2, P, 2) out of things when body and feet are moved (F, 2)."""
        by_body = body[self._frames][:, None, None]
        by_foot = np.stack([foot[self._frames] for foot in feet], axis=1)[:, :, None]
        at = (self._points + by_body + self._with_foot[:, None] * (by_foot - by_body)).reshape(-1, 2)
        moved = at - self._seen
        doubtful = np.flatnonzero(self._away - np.sqrt((moved * moved).sum(axis=-1)) < self._thick)
        if len(doubtful):
            self._seen[doubtful] = at[doubtful]
            self._away[doubtful], self._out[doubtful] = self._fence.away(at[doubtful], self._lows[doubtful])
        lack = np.zeros(len(at))
        lack[doubtful] = np.maximum(self._thick - self._away, 0.0)[doubtful]
        return (lack[:, None] * self._out).reshape(self._points.shape)


def _hanging(skeleton: Skeleton, shaped: Shaped, frames: NDArray[np.intp]) -> tuple[Array, Array]:
    """Both shoulders and elbows (f, 2, 3), as they are where nothing else has the arms."""
    hips, trunk = shaped.rotations[frames, 0], shaped.rotations[frames, _SPINE]
    spine = multiply(hips, trunk)[:, None]
    shoulders = rotate(hips, skeleton.offsets[_SPINE])[:, None] + rotate(spine, skeleton.offsets[_SHOULDERS])
    arms = multiply(spine, shaped.rotations[frames][:, _SHOULDERS])
    shoulders = shaped.root[frames, None] + shoulders
    return shoulders, shoulders + rotate(arms, skeleton.offsets[_ELBOWS])


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
        worst = lack[:, _OF_FOOT].argmax(axis=-1)
        most = np.where(self.which >= 0, lack[:, _OF_FOOT][rows, worst], 0.0)
        for i in np.unique(self.which[most > 0.0]):
            k = int(np.where(self.which == i, most, 0.0).argmax())
            out[i] += _BY_FOOT * push[k, _OF_FOOT][worst[k]] / self.height[k]
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
