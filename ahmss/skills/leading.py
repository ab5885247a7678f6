"""What a hand that holds a part of an object does with it: it is caught where fingers close near it, and goes along.

A fist holds it in the palm, a pinch between thumb and index: whichever is nearer when it is caught leads it. A fist is
closed when its fingers are bent, a pinch when thumb and index finger have come together since they came near, however
bent a hand at ease has the others. It is held while the thumb and the nearest of the fingers that closed with it are as
near as when they took hold: where one rolls off, the next holds it. Meanwhile the place where the part is taken goes
with the palm: where thumb and fingers roll on it their tips go this way and that, though it stays between them. When
the hand opens, or leaves it by more than a threshold, it stays. What the shipped object algorithms of parts share.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanFrame, ObjectTask
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate

__all__ = ["is_taken", "led", "stays_held"]

_FINGERS = ("index", "middle", "ring", "little")
_BENDS = 1.0  # degrees a frame from which on fingers are closing or opening
_PINCHED = 0.8  # of the opening that thumb and index finger came with: so near to each other they have closed,
_CLOSER = 0.012  # metres, or by so much nearer, about what is thick
_STILL = 0.001  # metres that they go in a frame when they have closed
_OPENED = 0.006  # metres that thumb and the nearest finger that closed with it go apart when they let go
_ROLLS = 0.0006  # metres that they go apart in a frame as they roll on what they hold
_LONG = 0.25  # metres: no fingertip is so far from the palm
_FALLS = 6.0  # of its way, a second, that a part goes by itself to where it rests: radians
_PALM = 0  # of the two points of a hand that may lead
_TIPS = ("thumb", *_FINGERS)
_FIRST = 0  # of the fingers: the index finger, which closes a pinch


def led(
    task: ObjectTask, way: float, limits: tuple[float, float], at: Callable[[float], Array],
    gone: Callable[[Transform, Transform], float], settled: Callable[[float], float], *, falls: bool = False,
) -> Iterator[float]:  # fmt: skip
    """How far the part is on its way, at each frame of the human.

    Args:
        task: of the object; its parameters say how near (`threshold`) and how closed (`closed_hand`) a hand must be.
        way: where it is at first. limits: between which it goes.
        at: where on the object the part is taken (3,), when it is so far.
        gone: how far what leads it brings it, from one place and turn to another, all in the object's frame.
        settled: where it comes to rest when it is let go. falls: it does so once no finger can be under it any more.
    """
    sides = (task.hand,) if task.hand else ("right", "left")
    threshold, closed = task.parameter("threshold", 0.05), task.parameter("closed_hand", 85.0)
    hands = {side: _Fingers(_bent(task.start, side)) for side in sides}
    leads: tuple[str, int] | None = None  # a hand, and its palm or pinch
    brought, rests, step = way, way, _FALLS / task.rate
    held = before = task.object.frame
    for human in task.frames():
        if leads is None and _far(task, human, sides, at(way), threshold):
            way += float(np.clip(rests - way, -step, step))
            for side, hand in hands.items():
                hand.far(_bent(human, side))
            yield way
            continue
        tips = _tips(task, human, sides)
        points = {side: _points(task, human, side, tips[side]) for side in sides}
        for side, hand in hands.items():
            apart = np.linalg.norm(points[side] - at(way), axis=1)
            openings = np.linalg.norm(tips[side][1:] - tips[side][0], axis=1)
            hand.seen(_bent(human, side), openings, near=bool(apart.min() <= threshold))
        if leads is not None:
            apart = float(np.linalg.norm(points[leads[0]] - at(way), axis=1).min())
            if apart > threshold or not hands[leads[0]].holds(leads[1], closed):
                rests, leads = settled(way), None
            else:
                leader = _palm(task, human, leads[0]).then(held)
                brought += gone(before, leader)
                way, before = float(np.clip(brought, *limits)), leader
        else:
            side, found = _nearest(points, at(way))
            which = int(found.argmin())
            if found.min() <= threshold and hands[side].closes(which, closed):
                leads, brought = (side, which), way
                palm = _palm(task, human, side)
                before = Transform(at(way), palm.rotation)
                held = palm.inverse().then(before)
            elif not falls or found.min() > threshold:
                way += float(np.clip(rests - way, -step, step))
        yield way


def is_taken(opening: float, widest: float) -> bool:
    """Whether thumb and index finger so far apart have closed on what they take, that were so far apart before."""
    return opening <= max(_PINCHED * widest, widest - _CLOSER)


def stays_held(openings: Array, frames: Array) -> bool:
    """Whether what is taken is not lost while the thumb is so far from each finger (n, 4), in those frames (n)."""
    least = np.interp(np.arange(frames[0], frames[-1] + 1), frames, openings.min(axis=1)).tolist()
    caught = least[0]
    for opening in least:
        if opening > caught + _OPENED:
            return False
        caught = _rolled(caught, opening)
    return True


def _rolled(caught: float, opening: float) -> float:
    """How far apart fingers hold something by now: those that roll on it come apart slowly."""
    return min(max(opening, caught), caught + _ROLLS)


class _Fingers:
    """Whether a hand is closed: how bent its fingers are, and how far the thumb is from each of them."""

    def __init__(self, bent: float) -> None:
        self._bent, self._bends = bent, 0.0  # degrees, and by how many more than in the frame before
        self._openings: Array | None = None  # metres (4,)
        self._goes = 0.0  # metres that the index finger's became in this frame
        self._widest = np.zeros(len(_FINGERS))  # since the hand came near, or let go
        self._hold = np.ones(len(_FINGERS), bool)  # those that closed with the thumb when it took hold
        self._caught = 0.0  # the least of theirs then

    def seen(self, bent: float, openings: Array, *, near: bool) -> None:
        self._bends, self._bent = abs(bent - self._bent), bent
        self._goes = 0.0 if self._openings is None else abs(float(openings[_FIRST] - self._openings[_FIRST]))
        self._openings = openings
        self._widest = np.maximum(self._widest, openings) if near else openings

    def far(self, bent: float) -> None:
        """It is nowhere near: of its fingers no more is asked than how bent they are."""
        self._bends, self._bent = abs(bent - self._bent), bent
        self._openings, self._goes = None, 0.0

    def closes(self, which: int, bent: float) -> bool:
        """Whether it takes hold now, in the palm or between thumb and index finger."""
        assert self._openings is not None
        if which == _PALM:
            return self._fist(bent)
        openings = zip(self._openings.tolist(), self._widest.tolist(), strict=True)
        closed = np.array([is_taken(*opening) for opening in openings])
        if not closed[_FIRST] or self._goes > _STILL:
            return False
        self._hold, self._caught = closed, float(self._openings[closed].min())
        return True

    def holds(self, which: int, bent: float) -> bool:
        """Whether it still does; where it does not, it has to close again."""
        assert self._openings is not None
        opening = float(self._openings[self._hold].min())
        still = self._fist(bent) if which == _PALM else opening <= self._caught + _OPENED
        if still:
            self._caught = _rolled(self._caught, opening)
        else:
            self._widest = self._openings
        return still

    def _fist(self, bent: float) -> bool:
        """While fingers close and open, their tips go a long way."""
        return self._bent >= bent and self._bends <= _BENDS


def _palm(task: ObjectTask, human: HumanFrame, side: str) -> Transform:
    """A palm in the object's frame."""
    return task.object.frame.inverse().then(human.grip(side))


def _nearest(points: dict[str, Array], end: Array) -> tuple[str, Array]:
    """The hand that is nearest to the part, and how far its palm and its pinch are from it (2,)."""
    apart = {side: np.linalg.norm(place - end, axis=1) for side, place in points.items()}
    side = min(apart, key=lambda side: float(apart[side].min()))
    return side, apart[side]


def _far(task: ObjectTask, human: HumanFrame, sides: Sequence[str], end: Array, threshold: float) -> bool:
    """Whether neither palm nor fingertips of any hand can be as near as that to the part (3,)."""
    place = task.object.frame.apply(end)
    return all(math.dist(human.grip(side).place, place) > threshold + _LONG for side in sides)


def _tips(task: ObjectTask, human: HumanFrame, sides: Sequence[str]) -> dict[str, Array]:
    """The tips of thumb and fingers of each hand (5, 3), in the world."""
    places, world = forward(human.rotations, human.root, task.human.offsets)
    found: dict[str, Array] = {}
    for side in sides:
        links = [INDEX[f"{side}_{tip}_distal"] for tip in _TIPS]
        found[side] = places[links] + rotate(world[links], task.human.tips[links])
    return found


def _points(task: ObjectTask, human: HumanFrame, side: str, tips: Array) -> Array:
    """The palm and the middle between the tips of thumb and index finger (2, 3), in the object's frame."""
    return task.object.frame.inverse().apply(np.array([human.grip(side).place, 0.5 * (tips[0] + tips[1])]))


def _bent(human: HumanFrame, side: str) -> float:
    """How far the four fingers are bent, knuckle and middle joint together, on the average, degrees."""
    links = [INDEX[f"{side}_{finger}_{segment}"] for finger in _FINGERS for segment in ("proximal", "intermediate")]
    bent = 2.0 * np.arccos(np.clip(np.abs(human.rotations[links, 0]), 0.0, 1.0))
    return float(np.degrees(bent.sum())) / len(_FINGERS)
