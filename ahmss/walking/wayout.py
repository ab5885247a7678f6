"""How a walker makes way at the end of a step, or in it: which walk it becomes, in steps that people make."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, to_rotation_vector
from ahmss.walking.catalogue import STRAIGHT, Key, Stride
from ahmss.walking.course import Course
from ahmss.walking.journey import AtSeam, Journey, onward
from ahmss.walking.library import RATE
from ahmss.walking.makingway import SAFE, Option, least, options
from ahmss.walking.nominal import clip_of, length_of
from ahmss.walking.pacing import Paced
from ahmss.walking.planning import RADIUS, Circle, Planner, ahead
from ahmss.walking.turning_in import cut
from ahmss.walking.walkers import Walker

__all__ = ["Pace", "WayOut", "halted", "way_out"]

# The ends by which one stops, and to what share of their length.
_STOPS: tuple[tuple[Stride, float], ...] = (("small", 0.55), ("small", 0.8), ("small", 1.0), ("normal", 1.0))
_TRIED = 8  # ways out that are looked at closely
_THINGS = 0.17  # metres from things that who makes way may come
_LOWEST, _FASTEST, _HARDEST = 0.9, 2.0, 30.0  # hips' height of that in standing, m/s, m/s2: within that one makes way
_AT_EASE = 15.0  # m/s2: the same of who stops in a step, and could at its end
_JERKIEST = np.radians(6.0)  # by which a joint's turn from frame to frame may change from one frame to the next


@dataclass(frozen=True)
class Pace:
    """How fast a walker goes that makes no way.

    rate: frames of the clips that pass in one; least and most: as it may become. left: frames to take; 0: any.
    """

    rate: float = 1.0
    least: float = 1.0
    most: float = 1.0
    left: int = 0

    def hurried(self, frames: int) -> float:
        """The rate of who would take so many frames, and has these left."""
        return float(np.clip(frames / self.left * self.rate, self.least, self.most))


@dataclass(frozen=True)
class WayOut:
    """What a walk becomes: the new one, whether it stops, its rate, on which side it passes others (0: none), and how
    the walker is where it begins.
    """

    going: Journey
    stops: bool
    rate: float
    side: float
    here: AtSeam


def way_out(
    planner: Planner, going: Journey, seam: int, here: AtSeam, others: Sequence[Walker], pace: Pace, side: float,
    since: int = 0,
) -> WayOut | None:  # fmt: skip
    """The walk from a seam on that makes way best; None: going on as it is is best.

    Of what comes too near to where others tell that they will be, or will be if they go on as they do, nothing is taken
    if there is anything else.

    Args:
        planner: plans courses. going: the walk as it is. here: the walker at the seam. pace: of the walk.
        others: who is about when it has come to the seam.
        side: on which it has begun to pass them; 0: on neither.
        since: how many frames ago it came there.
    """
    on = _Onward(planner, going, seam, here, pace, since)

    def around(place: Array, heading: float, circles: Sequence[Circle]) -> Course:
        return planner.course(place, heading, [(x, y, apart - RADIUS) for x, y, apart in circles])

    ways = [way for other in others for way in (other, *other.may_walk())]
    own, tried = ahead(going, going.seams[seam]), 0
    best: WayOut | None = None
    nearest = -np.inf
    for option in options(own, on.course, on.stops, on.speed, others, around, side):
        if option.course is on.course and option.slow == 1.0:
            found, near = None, least(own, ways)
        else:
            if tried == _TRIED or (option.course is not on.course and _touches(option.course, planner.things)):
                continue
            found, tried = on.made(option), tried + 1
            near = least(ahead(found.going, 0), ways)
            if near <= nearest or not _natural(found.going, planner.standing.height):
                continue
        if near > nearest:
            best, nearest = found, near
        if near > SAFE:
            break
    return best


def halted(planner: Planner, going: Journey, seam: int, here: AtSeam, pace: Pace, since: int = 0) -> WayOut | None:
    """The walk that stops as soon as a person would after a seam; arguments as of `way_out`.

    None where nobody would stop so soon; but at a seam, where one stops somehow.
    """
    on = _Onward(planner, going, seam, here, pace, since)
    ways = [on.made(Option(cut(on.course, 0.0, length), 1.0, True, 0.0)) for length in on.stops]
    somehow, hardest = (None, _AT_EASE) if since else (ways[-1], _HARDEST)
    return next((way for way in ways if _natural(way.going, planner.standing.height, hardest)), somehow)


class _Onward:
    """What a walk may become from a seam on.

    course: what is left of it. stops: in how many metres one can stop. speed: at which one goes on, m/s.

    Args:
        planner, going, seam, here, pace, since: as of `way_out`.
    """

    def __init__(self, planner: Planner, going: Journey, seam: int, here: AtSeam, pace: Pace, since: int) -> None:
        self._planner, self._here, self._pace, self._since = planner, here, pace, since
        library = planner.library
        scale, straight = planner.standing.height / library.hip_height, clip_of(library, STRAIGHT)
        self.speed = pace.rate * scale * length_of(straight) * RATE / straight.frames
        along = float(going.line.along(going.nominal.root[going.seams[seam], :1])[0][0])
        course = going.line.course
        if isinstance(course, Paced):
            course, along = course.course, float(course.placed(along))
        self.course = cut(course, along, course.length - along)
        ends = [(clip_of(library, Key("end", 0, 0, size, here.ahead)), share) for size, share in _STOPS]
        self.stops = [share * scale * length_of(end) for end, share in ends]

    def made(self, option: Option) -> WayOut:
        """The walk that an option is, as quick as the frames that are left want it after it has been slow."""
        facing = float(option.course.heading[-1])
        if self._planner.facing is not None and not option.stops:
            facing = self._planner.facing
        rate = self._pace.rate
        new = self._walk(option, facing, rate)
        if self._pace.left and not option.stops:
            rate = self._pace.hurried(len(new.rates))
            new = self._walk(option, facing, rate)
        return WayOut(new, option.stops, rate, option.side, replace(self._here, walk=new.shaping, frame=0))

    def _walk(self, option: Option, facing: float, rate: float) -> Journey:
        planner = self._planner
        return onward(
            planner.skeleton, planner.library, planner.standing, self._here, option.course, facing, rate, option.slow,
            self._since,
        )  # fmt: skip


def _natural(going: Journey, height: float, hardest: float = _HARDEST) -> bool:
    """Whether the next steps of a walk are such as a person makes whose hips are so high in standing, metres."""
    made = going.shaping.part(0, min(going.shaping.frames, 2 * going.seams[1]))
    moved = np.diff(made.root, axis=0) * RATE
    turned = to_rotation_vector(multiply(conjugate(made.rotations[:-1]), made.rotations[1:]))
    return bool(
        made.root[:, 2].min() > _LOWEST * height
        and np.linalg.norm(moved, axis=-1).max() < _FASTEST
        and np.linalg.norm(np.diff(moved, axis=0), axis=-1).max() * RATE < hardest
        and np.linalg.norm(np.diff(turned, axis=0), axis=-1).max() < _JERKIEST
    )


def _touches(course: Course, things: NDArray[np.object_]) -> bool:
    """Whether a course comes too near to things, polygons, soon, and nearer than where it begins."""
    points = course.points[:150]
    if not len(things) or len(points) < 2:
        return False
    near = shapely.distance(things, shapely.Point(points[0]))
    return bool((shapely.distance(things, shapely.LineString(points)) < np.minimum(near, _THINGS) - 1e-6).any())
