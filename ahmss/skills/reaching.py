"""A reach's task: from what main says (site, goal, hand, world) to what `ahmss.reaching` plans with.

What the shipped algorithms that bring a hand to something share, and an author may use.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from math import ceil
from typing import TypeVar

import numpy as np

from ahmss.algorithm.haste import hurried, least
from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE, LEFT_FOOT, RIGHT_FOOT
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, rotate, to_rotation_vector
from ahmss.errors import AlgorithmError
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.planting import feet
from ahmss.motion.steps import Steps
from ahmss.reaching.arm_on_way import AIMED, Sought
from ahmss.reaching.goal import Goal
from ahmss.reaching.leaning import looking
from ahmss.reaching.performing import Fingers, Performed, perform
from ahmss.reaching.plan import Plan, Reaching
from ahmss.reaching.prism import Prism
from ahmss.skills.box import filled

__all__ = ["HEAD", "Looking", "goal_of", "performed", "prisms_of", "sides_of"]

Worked = TypeVar("Worked")
_HEAD = INDEX["head"]
_LEADS = 0.25  # of the frames asked for, in which the head alone moves at the most
HEAD = 0.05  # the head's importance: what else looks somewhere has it
_PAUSES = 20  # of a plan that takes all its steps
_PERFORMED_IN = 4  # frames
_PLANS, _PERFORMS = 3, 2  # parts of a plan, and of what is performed, in a frame in which nothing moves any more
_AT_EASE = 45  # frames of a reach, with its pauses, however near: of a motion that is to be shorter they are counted
_BEYOND = 1  # pauses without a frame, after which it is performed anew in as many as it needs
_AS_FAST = 1.03  # of the frames that a reach has: up to so many more would be no gain
_SLOWEST = 2.0  # times as long as at ease
_GAINS = 0.97  # what a joint's speed comes to by being slower, at the most: else it is not the pace that makes it fast
_HEAD_SECONDS = 0.3  # in which the gaze comes to its place, where the head does not turn far
_HEAD_FASTEST = np.radians(240.0)  # a second: 4.0 degrees a frame at 60 Hz, which leave room for what the trunk adds
_PEAK = 1.875  # of a minimum jerk's mean speed
_GAZES_IN = 0.8  # of a motion's frames, at the most, the gaze is on its way
_THUMB = 0.02  # metres: a site deeper in a thing is pinched from farther before it, for an open thumb to come round it
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
            return Goal(task.site.place, task.goal_rotation, None, before)
        rotation = task.site.rotation if task.goal_rotation is None else task.goal_rotation
        if task.object.sites[task.message.site].grip == "precision":
            inside = _within(task.object, task.site.place, rotate(rotation, np.array([-1.0, 0.0, 0.0])))
            before += inside + _THUMB if inside > _THUMB else 0.0
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
    free = tuple(side for side in ("right", "left") if side not in task.busy)
    if not free:
        raise AlgorithmError("both hands hold something; let go of it first, or say which hand")
    return free


def prisms_of(task: HumanTask, besides: WorldObject | None = None) -> list[Prism]:
    """What may be in the way: the object and its neighbours, each as the boxes that it tells, or as high as it says.

    Args:
        task: whose object is sought. besides: what else fingers come close to, as a cradle into which it is laid.
    """
    things = [] if task.object is None else [task.object]
    things += [thing for thing in task.world.values() if thing.kind != "human"]
    found: list[Prism] = []
    for thing in things:
        sought = thing is task.object or thing is besides
        if blocks := filled(thing, sought=sought):
            found += blocks
            continue
        height = _height(thing)
        low = float(thing.place[2])
        found += [Prism(ring, low, low + height, sought) for ring in thing.occupied if len(ring) >= 3]
    return found


def performed(
    task: HumanTask, reaching: Reaching, plan: Plan, gaze: Looking, fingers: Fingers, then: Array | None = None,
    sought: Sought | None = None,
) -> Generator[Array, None, Performed]:  # fmt: skip
    """The frames of a plan, made a part in each of some more frames (1, 260) of the gaze.

    Where nobody said how many frames it takes, it takes as many as the way needs that is taken in the end, and as many
    as no joint is too fast in.

    Args:
        task: which says how many frames there are. reaching: who. plan: what `planned` found. gaze: on its way.
        fingers: links and the rotations (m, 4) that they come to.
        then: palms (m, 7) of frames that follow; the reach takes the frames before them. sought: as of `perform`.
    """
    follow = 0 if then is None else len(then)
    slower, before, within = 1.0, np.inf, _PERFORMED_IN
    while True:
        first = gaze.frames + gaze.left(within)
        length = hurried(task, round(slower * plan.seconds * task.rate), first + follow)
        plan = reaching.set_out(plan, gaze.place, float(gaze.turned(np.array([first]))[0]))
        looked = gaze.meanwhile(first, length + follow)
        time = np.arange(1, length + 1) / length
        made = yield from gaze.until_or_not(first, perform(plan, time, gaze.place, looked, fingers, then, sought))
        if made is None:
            within = gaze.to_come
            continue
        needed = max(made.plan.seconds * task.rate, length * made.fastest / AIMED) / length
        if task.length or needed < _AS_FAST or slower >= _SLOWEST or made.fastest > _GAINS * before:
            return made
        slower = min(length * needed / (made.plan.seconds * task.rate), _SLOWEST)
        before = made.fastest if slower > 1.0 else np.inf
        plan = made.plan


class Looking:
    """The gaze on its way to a place (3,), which it begins before anything else moves.

    frames: those that were given by `alone`. Once it is there, more of a plan is made in each: who sees them stand
    there has to wait. in_thought: not so; it is only thought of, by who gives the frames. after: seconds by which it is
    later than the hand, instead: of who would turn the head into what that has at it.
    """

    def __init__(self, task: HumanTask, place: Array, *, in_thought: bool = False, after: float | None = None) -> None:
        self._task, self.place, self._after = task, place, after
        self._feet = feet(task.human, task.start.rotations, task.start.root)
        self._length = max(task.length, least(task, _AT_EASE)) if task.length else 0
        self._seconds = self._needed()
        self.frames = 0
        self._pauses, self._at_once, self._in_thought = 0, 1, in_thought
        if self._length:  # a short motion has few frames for the pauses of a plan: they are spread over these
            self._at_once = ceil(_PAUSES / max(_LEADS * self._length, 1.0))

    @property
    def later(self) -> bool:
        """Whether it is later than the hand."""
        return self._after is not None

    def of(self, task: HumanTask) -> Looking:
        """The same of who has come elsewhere meanwhile, from its beginning on."""
        return Looking(task, self.place, in_thought=self._in_thought, after=self._after)

    def turned(self, frames: Array) -> Array:
        """How much of the way (n) the gaze has turned at frames (n) before the hand sets out."""
        return self._share(frames if self._after is None else np.zeros(len(frames)))

    def meanwhile(self, first: int, count: int) -> Array:
        """How much of the way (n) it has turned in so many frames of a hand that sets out after the first ones."""
        moves = np.arange(1.0, count + 1.0)
        return self._share(first + moves if self._after is None else moves - self._after * self._task.rate)

    def _share(self, frames: Array) -> Array:
        return minimum_jerk(frames / (self._seconds * self._task.rate))

    def alone(self) -> Array:
        """The next frame (1, 260), in which nothing but the head moves."""
        task = self._task
        self.frames += 1
        importance = np.zeros(44)
        importance[_HEAD] = HEAD
        rows = self.rows(np.array([self.frames]))
        return task.block(task.start.rotations[None], task.start.root[None], importance, rows)

    def left(self, most: int) -> int:
        """How many frames, of so many, there are for the gaze alone: the others are needed for the hand."""
        length = max(self._length, self._task.length)
        return max(min(most, ceil(_LEADS * length) - 1 - self.frames), 0) if length else most

    def if_there_is_time(self) -> Iterator[Array]:
        """The next frame as `alone`, unless the motion's frames are needed for the hand."""
        self._pauses += 1
        if self._pauses % (_PLANS if self._stands() else self._at_once) == 0 and self.left(1):
            yield self.alone()

    def during(self, work: Steps[Worked]) -> Generator[Array, None, Worked]:
        """What work finds; in its pauses the next frames as `alone`."""
        while True:
            try:
                next(work)
            except StopIteration as end:
                return end.value
            yield from self.if_there_is_time()

    def until(self, last: int, work: Steps[Worked]) -> Generator[Array, None, Worked]:
        """What work finds; in its pauses, and then, the frames as `alone` up to the last."""
        (found,) = yield from self._until(last, work)
        return found

    def until_or_not(self, last: int, work: Steps[Worked]) -> Generator[Array, None, Worked | None]:
        """The same; None where these frames are far too few and nobody counts them: it is given up."""
        found = yield from self._until(last, work, None if self._task.length else _BEYOND)
        return found[0] if found else None

    def _until(
        self, last: int, work: Steps[Worked], beyond: int | None = None
    ) -> Generator[Array, None, tuple[Worked, ...]]:
        """What work finds; nothing where it pauses more often without a frame than `beyond`."""
        without = 0
        while beyond is None or without <= beyond:
            try:
                next(work)
            except StopIteration as end:
                while self.frames < last:
                    yield self.alone()
                return (end.value,)
            if self._stands():
                self._pauses += 1
                if self._pauses % _PERFORMS == 0:
                    yield self.alone()
            elif self.frames < last or self._waits():
                yield self.alone()
            else:
                without += 1
        return ()

    @property
    def to_come(self) -> int:
        """How many more frames the gaze takes to the place."""
        return max(ceil(self._seconds * self._task.rate) - self.frames, 1)

    def _needed(self) -> float:
        """Seconds in which the head comes to the place: the farther it turns the more, its peak speed being limited."""
        task = self._task
        seen = looking(task.human, task.start.rotations, task.start.root, self.place)[_HEAD]
        turn = float(np.linalg.norm(to_rotation_vector(multiply(conjugate(task.start.rotations[_HEAD]), seen))))
        steepest = 4.0 * np.tan(0.25 * turn)  # along the chord, on which weights are met, the middle goes faster
        seconds = max(_HEAD_SECONDS, _PEAK * steepest / _HEAD_FASTEST)
        return min(seconds, max(_HEAD_SECONDS, _GAZES_IN * self._length / task.rate)) if self._length else seconds

    def _waits(self) -> bool:
        """Whether who looks there may do so for longer: nobody counts the frames, and no more of them turn anything."""
        still = self._after is not None or float(self.turned(np.array([self.frames]))[0]) >= 1.0
        return still and not self._length

    def _stands(self) -> bool:
        """Whether who waits so is seen to stand there."""
        return self._waits() and not self._in_thought

    def rows(self, frames: Array) -> Array:
        """Targets (n, 5, 8) at frames (n): the gaze, and the feet of who is not carried."""
        targets = np.zeros((len(frames), 5, 8))
        targets[:, GAZE, :3], targets[:, GAZE, 7] = self.place, self.turned(frames)
        if not self._task.carried:
            targets[:, RIGHT_FOOT : LEFT_FOOT + 1, :7], targets[:, RIGHT_FOOT : LEFT_FOOT + 1, 7] = self._feet, 1.0
        return targets


def _within(thing: WorldObject, place: Array, out: Array) -> float:
    """Metres from a place (3,) in a thing out of it, along a direction (3,): of what says how large it is, else 0."""
    size = thing.properties.get("size")
    if not isinstance(size, (list, tuple)) or len(size) != 3:
        return 0.0
    length = np.array(size, float)
    low, high = np.array([-0.5, -0.5, 0.0]) * length, np.array([0.5, 0.5, 1.0]) * length
    back = thing.frame.inverse()
    at, way = back.apply(place), rotate(back.rotation, out)
    if ((at <= low) | (at >= high)).any():
        return 0.0
    ends = np.where(way > 0.0, high - at, at - low) / np.maximum(np.abs(way), 1e-9)
    return float(ends.min())


def _height(thing: WorldObject) -> float:
    """How high a thing is over its origin, metres: its `size`, or its highest site."""
    size = thing.properties.get("size")
    if isinstance(size, (list, tuple)) and len(size) == 3:
        return float(size[2])
    return max((site.position[2] for site in thing.sites.values()), default=_HEIGHT)
