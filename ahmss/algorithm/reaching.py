"""A reach's task: from what main says (site, goal, hand, world) to what `ahmss.reaching` plans with.

What the shipped algorithms that bring a hand to something share, and an author may use.
"""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE, LEFT_FOOT, RIGHT_FOOT
from ahmss.body.links import INDEX
from ahmss.errors import AlgorithmError
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.planting import feet
from ahmss.reaching.leaning import Stretch
from ahmss.reaching.plan import Goal
from ahmss.reaching.prism import Prism

__all__ = ["Looking", "goal_of", "prisms_of", "refuse_far", "sides_of"]

MOST_MISSING = 0.03  # metres beyond a stretched arm that are still tried for, and told of
_TOLD = 0.003  # metres
_HEAD_SECONDS = 0.3  # in which the gaze comes to its place
_HEIGHT = 2.0  # metres, of what says neither its size nor how high its sites are


def goal_of(task: HumanTask) -> Goal:
    """Where the palm shall be: at the goal's place if one is given, else at the action's site, else at the object.

    Raises:
        AlgorithmError: there is none of these.
    """
    free = task.parameter("turn", "site") == "free"
    if task.goal_place is not None:
        return Goal(task.goal_place, task.goal_rotation)
    if task.site is not None and task.object is not None:
        before = task.parameter("before", 0.03)
        if task.object.sites[task.message.site].free_axis:
            radius = 0.5 * float(task.object.properties.get("diameter", 0.0))
            return Goal(task.site.place, None, task.site.row(), before + radius)
        if free:
            return Goal(task.site.place, task.goal_rotation)
        rotation = task.site.rotation if task.goal_rotation is None else task.goal_rotation
        return Goal(task.site.place, rotation, None, before)
    if task.object is not None:
        return Goal(task.object.place, task.goal_rotation)
    raise AlgorithmError("reach where? the action names no site; add `to X Y Z`, or `to` and an object")


def sides_of(task: HumanTask) -> tuple[str, ...]:
    """The hands that may be used: the one that was said, else those that hold nothing.

    Raises:
        AlgorithmError: both hold something.
    """
    if task.hand:
        return (task.hand,)
    free = tuple(side for side in ("right", "left") if side not in getattr(task, "busy", ()))
    if not free:
        raise AlgorithmError("both hands hold something; let go of it first, or say which hand")
    return free


def prisms_of(task: HumanTask) -> list[Prism]:
    """What may be in the way: the object and its neighbours, each as high as it says."""
    things = [] if task.object is None else [task.object]
    things += [thing for thing in task.world.values() if thing.kind != "human"]
    found: list[Prism] = []
    for thing in things:
        height = _height(thing)
        low = float(thing.place[2])
        found += [Prism(ring, low, low + height) for ring in thing.occupied if len(ring) >= 3]
    return found


def refuse_far(task: HumanTask, side: str, arm: Stretch) -> None:
    """Refuse what is out of reach rather than stretch for it in the air; tell by how much the hand stops short.

    Raises:
        AlgorithmError: says by how much.
    """
    if arm.missing > MOST_MISSING:
        raise AlgorithmError(f"the {side} arm is {arm.missing:.2f} m too short for that from here; stand nearer to it")
    if arm.missing > _TOLD:
        task.note(f"the {side} hand stops {1000.0 * arm.missing:.0f} mm short of it, as far as the arm goes")


class Looking:
    """The gaze on its way to a place (3,), which it begins before anything else moves.

    frames: those that were given by `alone`.
    """

    def __init__(self, task: HumanTask, place: Array) -> None:
        self._task, self._place = task, place
        self._feet = feet(task.human, task.start.rotations, task.start.root)
        self.frames = 0

    def turned(self, frames: Array) -> Array:
        """How much of the way (n) the gaze has turned at frames (n)."""
        return minimum_jerk(frames / (_HEAD_SECONDS * self._task.rate))

    def alone(self) -> Array:
        """The next frame (1, 260), in which nothing but the head moves."""
        task = self._task
        self.frames += 1
        targets = np.zeros((1, 5, 8))
        targets[:, GAZE, :3], targets[:, GAZE, 7] = self._place, self.turned(np.array([self.frames]))
        if not task.carried:
            targets[:, RIGHT_FOOT : LEFT_FOOT + 1, :7], targets[:, RIGHT_FOOT : LEFT_FOOT + 1, 7] = self._feet, 1.0
        importance = np.zeros(44)
        importance[INDEX["head"]] = 0.05
        return task.block(task.start.rotations[None], task.start.root[None], importance, targets)


def _height(thing: WorldObject) -> float:
    """How high a thing is over its origin, metres: its `size`, or its highest site."""
    size = thing.properties.get("size")
    if isinstance(size, (list, tuple)) and len(size) == 3:
        return float(size[2])
    return max((site.position[2] for site in thing.sites.values()), default=_HEIGHT)
