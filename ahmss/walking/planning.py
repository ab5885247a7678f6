"""Walks from where a human stands, as they are planned: to its goal, or out of the way, round things and people."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import shapely
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.motion.way import AHEAD
from ahmss.walking.course import Course, NoWay, plan
from ahmss.walking.hindering import TAKEN
from ahmss.walking.journey import SPOT, Footing, Journey, Standing, journey
from ahmss.walking.library import RATE, Library
from ahmss.walking.makingway import held_up, least, met
from ahmss.walking.pacing import Paced
from ahmss.walking.pieces import Ground
from ahmss.walking.walkers import LOOKED, Walker

__all__ = ["IMPATIENT", "RADIUS", "Circle", "Planner", "ahead", "beginning"]

RADIUS = 0.27  # metres that a walker keeps from things
IMPATIENT = 0.2  # metres: how much nearer to others one goes in the end, who has waited
_APART = 0.8  # metres that two walkers' middles shall keep apart
_LEAVES, _TOUCHING = 0.03, 0.45  # metres nearer that who stands beside somebody may come on leaving; never nearer
_NEAR = 2.3  # metres: whom one goes round from the beginning
_STOPS_IN = 1.4  # seconds from the first step at which one may do otherwise until one stands
_STANDS = 0.05  # metres in the last 0.4 s of a way: who tells that will stand there
_WAITS = 1.5  # metres from one's way: who has waited long there may wait for oneself
_ASIDE = 0.85  # metres that one steps aside for who wants to be where one is
_COMING, _BETTER = 0.5, 0.1  # metres: who comes so near to one who stands is dodged, for so much more room
_AROUND = np.stack([[np.cos(a), np.sin(a)] for a in np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)])
_FARTHER, _SPOTS, _STRAIGHT = (1.0, 1.5, 2.1, 2.8), 8, 1.3  # of _ASIDE; places that are tried; ways of the straight one
_HARDLY = 0.02  # metres less than _ASIDE that serve
_ROOM, _LEFT = 0.72, 0.2  # metres: who is nearer is brushed by who passes; how far one goes until one passes
_BESIDE = 1.0  # metres: out of who stands so near one keeps as out of things, in setting out
_THICK, _THIN, _OWN = 0.37, 0.1, 0.27  # metres: how thick they are at the most, at the least; half of one's own width
_SPOT, _BACK = 0.2, np.radians(110.0)  # metres in which who turns by more doubles back
_RING = np.stack([[np.cos(a), np.sin(a)] for a in np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)])

Circle = tuple[float, float, float]
"""x, y and radius, metres, of what is gone round."""


@dataclass(frozen=True)
class Planner:
    """Plans walks of a human.

    Args:
        skeleton: of who walks.
        library: the clips.
        ground: what stands on the floor.
        goal: (2,) metres. facing: the heading there, radians; None: as one arrives.
    """

    skeleton: Skeleton
    library: Library
    ground: Ground
    goal: Array
    facing: float | None
    standing: Standing = field(init=False)
    things: NDArray[np.object_] = field(init=False)

    def __post_init__(self) -> None:  # noqa: D105 (what it sets are fields)
        things = [shapely.Polygon(ring) for ring in self.ground.outlines if len(ring) > 2]
        object.__setattr__(self, "standing", Standing.of(self.skeleton, self.library))
        object.__setattr__(self, "things", np.array(things, dtype=object))

    def walk(self, now: Footing, circles: Sequence[Circle] = (), frames: int = 0) -> Journey:
        """A walk to the goal round circles, in so many frames; 0: in as many as it takes.

        Raises:
            NoWay: there is none.
        """
        course = self.course(now.place, now.heading, circles)
        facing = float(course.heading[-1]) if self.facing is None else self.facing
        if self.facing is None and course.length < SPOT:
            facing = now.heading
        return self._journey(now, course, facing, frames)

    def free(
        self, now: Footing, others: Sequence[Walker], frames: int = 0, nearer: float = 0.0, *, tired: bool = False
    ) -> Journey | None:
        """A walk to the goal on which others do not hold one up; None: there is none now.

        Who is met on the straight way is passed on the right, else on the left.

        Args:
            now: where one stands, from where one sets out at once. others: who is about then.
            frames: to take; 0: as many as it takes.
            nearer: metres that one goes nearer to others than at first. tired: as of `held_up`.

        Raises:
            NoWay: there is none without others either.
        """
        near = [circle for circle in self.circles(now.place, others, nearer) if _away(circle, now.place) < _NEAR]
        try:
            going = self.walk(now, near, frames)
        except NoWay:
            self.course(now.place, now.heading)
            return None
        for side in (0.0, 1.0, -1.0):
            if side:
                there = met(beginning(going, 0), others, side)
                try:
                    found = self.walk(now, [*near, *((x, y, _APART - RADIUS) for x, y in there)], frames)
                except NoWay:
                    continue
            else:
                found = going
            if _doubles_back(found.line.course):
                continue
            own = beginning(found, 0)
            if found.line.course.length < SPOT or not held_up(own, others, nearer, begun=False, tired=tired):
                return found
        return None

    def aside(
        self, now: Footing, others: Sequence[Walker], *, tired: bool = False, late: bool = False
    ) -> Journey | None:
        """A step out of the way of who waits at the goal and goes first; None: there is nobody, or no room.

        To the right if there is room, else to the left, else to where there is.

        Args:
            now: where one stands. others: who is about.
            tired: whether one has waited long: then also for who waits beside the goal, or the way to it.
            late: whether there may be no room for that: then also for who would go second, and though one may not get
                to the goal afterwards.
        """
        line = shapely.LineString(np.stack([now.place, self.goal]))
        for other in others:
            way = other.place - now.place
            there = float(np.linalg.norm(other.place - self.goal)) < _APART
            there |= tired and other.stays and shapely.distance(line, shapely.Point(other.place)) < _WAITS
            if not there or other.way is None or not (other.precedes(now.place) or late):
                continue
            for spot in self._spots(now.place, way):
                with contextlib.suppress(NoWay):
                    circles = self.circles(now.place, others)
                    course = self.course(now.place, now.heading, circles, spot)
                    away = self._journey(now, course, now.heading)
                    straight = float(np.linalg.norm(spot - now.place))
                    if course.length > _STRAIGHT * straight or held_up(beginning(away, 0), others, begun=False):
                        continue
                    if not late:  # one gets to the goal from there, past who came
                        taken = (float(now.place[0]), float(now.place[1]), _APART - IMPATIENT - RADIUS)
                        self.course(spot, now.heading, [taken])
                    return away
        return None

    def _spots(self, place: Array, way: Array) -> list[Array]:
        """Places (2,) near to one's own that are off the way (2,) to who wants to be there, and free; the best first.

        Those at one's right and left hand, then others, the nearest first.
        """
        length = max(float(np.linalg.norm(way)), 1e-9)
        right = np.array([way[1], -way[0]]) / length
        spots = [place + _ASIDE * right, place - _ASIDE * right]
        spots += [place + (far * _ASIDE) * turned for far in _FARTHER for turned in _AROUND]
        theirs = shapely.LineString(np.stack([place, place + way]))
        points = shapely.points(np.array(spots))
        away = np.asarray(shapely.distance(theirs, points)) > _ASIDE - _HARDLY
        if len(self.things):
            away &= np.asarray(shapely.distance(self.things[:, None], points)).min(axis=0) > RADIUS
        return [spots[i] for i in np.flatnonzero(away)[:_SPOTS]]

    def dodge(self, now: Footing, others: Sequence[Walker]) -> Journey | None:
        """A step out of the way of who comes to where one stands; None: nobody does, or there is no better place.

        Args:
            now: where one stands. others: who is about.
        """
        stands = np.repeat(now.place[None], len(LOOKED), axis=0)
        coming = [other for other in others if other.way is not None and least(stands, [other]) < _COMING]
        if not coming:
            return None
        first = min(coming, key=lambda other: float(np.linalg.norm(other.place - now.place)))
        way = first.after(AHEAD[-1]) - first.place
        right = np.array([way[1], -way[0]]) / max(float(np.linalg.norm(way)), 1e-9)
        best, room = None, least(stands, others) + _BETTER
        for side in (_ASIDE * right, -_ASIDE * right):
            with contextlib.suppress(NoWay):
                course = self.course(now.place, now.heading, self.circles(now.place, others), now.place + side)
                away = self._journey(now, course, now.heading)
                near = least(beginning(away, 0), others)
                if course.length < 1.2 * _ASIDE and near > room:
                    best, room = away, near
        return best

    def retreat(self, now: Footing, going: Journey, others: Sequence[Walker]) -> Journey | None:
        """A step back from who stands so near that one would brush past them; None: there is nobody, or no room.

        Args:
            now: where one stands. going: how one would go. others: who is about.
        """
        own = beginning(going, 0)
        left = np.linalg.norm(own - own[0], axis=-1) > _LEFT
        for other in others:
            if not other.stays or not left.any():
                continue
            away = now.place - other.place
            length = max(float(np.linalg.norm(away)), 1e-9)
            if np.linalg.norm(own[left] - other.place, axis=-1).min() > min(_ROOM, length) or length > _ROOM:
                continue
            with contextlib.suppress(NoWay):
                place = now.place + (_APART - length) / length * away
                course = self.course(now.place, now.heading, self.circles(now.place, others), place)
                back = self._journey(now, course, now.heading)
                if not held_up(beginning(back, 0), others, begun=False):
                    return back
        return None

    def course(self, place: Array, heading: float, circles: Sequence[Circle] = (), goal: Array | None = None) -> Course:
        """The way from a place (2,) and heading to the goal, or another, round things and circles.

        Raises:
            NoWay: there is none.
        """
        return plan(
            place, self.goal if goal is None else goal, self.ground.outlines, radius=RADIUS, circles=circles,
            start_heading=heading, names=self.ground.names,
        )  # fmt: skip

    def circles(self, place: Array, others: Sequence[Walker], nearer: float = 0.0) -> list[Circle]:
        """Others as circles where they stand, or tell that they will; one may pass nearer to them by so many metres.

        Who stands nearer to somebody already may leave from there, but goes no nearer.
        """
        circles: list[Circle] = []
        for other in others:
            if other.way is not None and np.linalg.norm(other.way[-1] - other.way[-2]) > _STANDS:
                continue
            x, y = other.place if other.way is None else other.after(AHEAD[-1])
            away = float(np.hypot(x - place[0], y - place[1])) - _LEAVES
            circles.append((float(x), float(y), max(min(_APART - nearer, away), _TOUCHING) - RADIUS))
        return circles

    def crowded(self, place: Array, others: Sequence[Walker]) -> Ground:
        """What stands on the floor, and who stands beside a place (2,): legs and elbows keep out of them in leaving."""
        rings: list[Array] = []
        for other in others:
            away = float(np.linalg.norm(other.place - place))
            if other.stays and away < _BESIDE:
                rings.append(other.place + max(min(_THICK, away - _OWN), _THIN) * _RING)
        if not rings:
            return self.ground
        tops = [*self.ground.tops] or [np.inf] * len(self.ground.outlines)
        names = [*self.ground.names, *[""] * len(rings)]
        return Ground([*self.ground.outlines, *rings], names, [*tops, *[np.inf] * len(rings)])

    def taken(self, others: Sequence[Walker]) -> bool:
        """Whether somebody who goes nowhere stands so near to the goal that one can't stand there."""
        return any(o.way is None and o.stays and np.linalg.norm(o.place - self.goal) < TAKEN for o in others)

    def _journey(self, now: Footing, course: Course, facing: float, frames: int = 0) -> Journey:
        return journey(self.skeleton, self.library, self.standing, now, course, facing, frames)


def _doubles_back(course: Course | Paced) -> bool:
    """Whether a way turns round almost on the spot, which nobody walks who can wait instead."""
    _, heading = course.at(np.arange(0.0, course.length, _SPOT))
    return len(heading) > 1 and bool(np.abs(np.diff(heading)).max() > _BACK)


def ahead(going: Journey, made: int, seconds: float = LOOKED[-1]) -> Array:
    """Where the hips will be (n, 2) at the times LOOKED from a frame on, or longer; at its end they stay."""
    frames = made + round(RATE * LOOKED[1]) * np.arange(round(seconds / LOOKED[1]) + 1)
    return going.shaping.level[np.minimum(frames, len(going.shaping.level) - 1)]


def beginning(going: Journey, made: int) -> Array:
    """Where the hips will be (n, 2) from a frame before the first step on until one could have stopped after it."""
    return ahead(going, made, max(LOOKED[-1], (going.seams[1] - made) / RATE + _STOPS_IN))


def _away(circle: Circle, place: Array) -> float:
    return float(np.hypot(circle[0] - place[0], circle[1] - place[1]))
