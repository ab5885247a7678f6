"""Where one stands to use a control: before it, as its pose says, or beside it, facing it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.quaternion import rotate
from ahmss.skills.stands import stands_at
from ahmss.skills.stepping import ground_of
from ahmss.walking import goals
from ahmss.walking.obstacles import Obstacles

__all__ = ["all_before", "around_it", "before", "front_of"]

_Y = np.array([0.0, 1.0, 0.0])
_CLEAR = 0.26  # metres from things on the floor to the middle of who stands at them
_BEHIND = -0.2  # the cosine of how far round a control one may stand to use it, away from where it looks


def front_of(control: Transform) -> Array:
    """The level direction (2,), unit, in which one stands before a control."""
    y = rotate(control.rotation, _Y)
    front = np.array([y[1], -y[0]])  # y cross up
    length = float(np.linalg.norm(front))
    if length < 0.3:  # turned on its side: where it looks
        front = rotate(control.rotation, np.array([1.0, 0.0, 0.0]))[:2]
        length = float(np.linalg.norm(front))
    return front / length if length > 1e-6 else np.array([1.0, 0.0])


def before(task: HumanTask, away: float, aside: float = 0.0, front: Array | None = None) -> goals.Goal:
    """Where one stands so far before the task's control, and so far to the left of it, clear of what stands about.

    front: (2,) the level way from it to where one stands, of length 1; None: out of it.
    """
    return next(all_before(task, [(away, aside)], front))


def all_before(
    task: HumanTask, ways: Iterable[tuple[float, float]], front: Array | None = None
) -> Iterator[goals.Goal]:
    """The same for several: so far before it, and so far to the left."""
    assert task.object is not None
    front = front_of(task.object.frame) if front is None else front
    left = np.array([front[1], -front[0]])  # of who looks at it
    floor = Obstacles.of(ground_of(task).outlines, _CLEAR)
    for away, aside in ways:
        free = floor.nearest_free(task.object.place[:2] + away * front + aside * left)
        yield goals.Goal(free, float(np.arctan2(-front[1], -front[0])))


def around_it(task: HumanTask) -> list[goals.Goal]:
    """Places beside and before the control from which one faces it."""
    assert task.object is not None
    place, front = task.object.place[:2], front_of(task.object.frame)
    stands = [stand for _, stand in stands_at(task, task.object.place)]
    return [one for one in stands if (one.place - place) @ front > _BEHIND * np.linalg.norm(one.place - place)]
