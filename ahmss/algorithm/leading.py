"""What a hand that holds a part of an object does with it: it is caught where fingers close near it, and goes along.

A fist holds it in the palm, a pinch between thumb and index: whichever is nearer when it is caught leads it. When the
hand opens, or leaves it by more than a threshold, it stays. What the shipped object algorithms of parts share.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanFrame, ObjectTask
from ahmss.body.array import Array
from ahmss.body.links import INDEX

__all__ = ["led"]

_FINGERS = ("index", "middle", "ring", "little")
_BENDS = 1.0  # degrees a frame from which on fingers are closing or opening


def led(
    task: ObjectTask, way: float, limits: tuple[float, float], at: Callable[[float], Array],
    gone: Callable[[Transform, Transform], float], settled: Callable[[float], float],
) -> Iterator[float]:  # fmt: skip
    """How far the part is on its way, at each frame of the human.

    Args:
        task: of the object; its parameters say how near (`threshold`) and how closed (`closed_hand`) a hand must be.
        way: where it is at first. limits: between which it goes.
        at: where on the object the part is taken (3,), when it is so far.
        gone: how far what leads it brings it, from one place and turn to another, all in the object's frame.
        settled: where it comes to rest when it is let go.
    """
    sides = (task.hand,) if task.hand else ("right", "left")
    threshold, closed = task.parameter("threshold", 0.05), task.parameter("closed_hand", 85.0)
    leads: tuple[str, int] | None = None  # a hand, and its palm or pinch
    brought = way
    before, bent = task.object.frame, {side: _bent(task.start, side) for side in sides}
    for human in task.frames():
        points = {side: _points(task, human, side) for side in sides}
        side, apart = _nearest(points, at(way))
        now = {hand: _bent(human, hand) for hand in sides}
        bends, bent = abs(now[side] - bent[side]) > _BENDS, now  # while they close and open, fingertips go a long way
        if bends or apart.min() > threshold or now[side] < closed:
            if leads is not None:
                way = settled(way)
            leads = None
        elif leads is None:
            leads, brought = (side, int(apart.argmin())), way
            before = _leader(task, human, leads, points)
        else:
            leader = _leader(task, human, leads, points)
            brought += gone(before, leader)
            way, before = float(np.clip(brought, *limits)), leader
        yield way


def _leader(task: ObjectTask, human: HumanFrame, leads: tuple[str, int], points: dict[str, Array]) -> Transform:
    """The point that leads, turned as its palm, in the object's frame."""
    turned = task.object.frame.inverse().then(human.grip(leads[0])).rotation
    return Transform(points[leads[0]][leads[1]], turned)


def _nearest(points: dict[str, Array], end: Array) -> tuple[str, Array]:
    """The hand that is nearest to the part, and how far its palm and its pinch are from it (2,)."""
    apart = {side: np.linalg.norm(place - end, axis=1) for side, place in points.items()}
    side = min(apart, key=lambda side: float(apart[side].min()))
    return side, apart[side]


def _points(task: ObjectTask, human: HumanFrame, side: str) -> Array:
    """The palm and the middle between the tips of thumb and index (2, 3), in the object's frame."""
    pinch = 0.5 * (task.fingertip(side, "thumb") + task.fingertip(side, "index"))
    return task.object.frame.inverse().apply(np.array([human.grip(side).place, pinch]))


def _bent(human: HumanFrame, side: str) -> float:
    """How far the four fingers are bent, knuckle and middle joint together, on the average, degrees."""
    links = [INDEX[f"{side}_{finger}_{segment}"] for finger in _FINGERS for segment in ("proximal", "intermediate")]
    bent = 2.0 * np.arccos(np.clip(np.abs(human.rotations[links, 0]), 0.0, 1.0))
    return float(np.degrees(bent.sum())) / len(_FINGERS)
