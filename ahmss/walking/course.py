"""The way on the floor that a walker takes round things: planned, smooth, asked by how far one has come on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import shapely
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.walking.bend import SAMPLE, rounded
from ahmss.walking.obstacles import NEAREST, SLOPE, Ends, NoWay, Obstacles, nearest_free
from ahmss.walking.route import shortest, walls_around

__all__ = ["Course", "NoWay", "blocked", "nearest_free", "plan"]

_NAMED = 4  # as many obstacles are named in a sentence
_STEP = 0.5  # metres: who goes no farther steps there, and does not walk
_SAME = 0.03  # metres: who is so near to the goal stands there
# By how much the clearance grows from a place that lacks it, and for how many metres first not at all: off things at
# once; out of a gap between two, along both as far as it may reach; and along things for long, for who is in a nook.
_LEAVES = ((SLOPE, 0.0), (SLOPE, 0.3), (SLOPE / 4.0, 0.0))
_NO_NEARER = 0.01  # metres that a step may come nearer to a thing than one stands before it and after it


@dataclass(frozen=True)
class Course:
    """A smooth way on the floor.

    points (n, 2) metres, evenly along the way, at most 2 cm apart; heading (n,) radians, of its tangent, without jumps;
    length in metres. A way to where one stands has one point.
    """

    points: Array
    heading: Array
    length: float

    def at(self, s: Array) -> tuple[Array, Array]:
        """Place (..., 2) and heading (...) at arc lengths s (...); before 0 and after the end it goes on straight."""
        s = np.asarray(s, dtype=np.float64)
        n = len(self.points)
        inside = np.clip(s, 0.0, self.length)
        beyond = (s - inside)[..., None]
        if n == 1:
            return self.points[0] + beyond * _along(self.heading[0]), np.broadcast_to(self.heading[0], s.shape).copy()
        step = self.length / (n - 1)
        i = np.minimum((inside / step).astype(np.intp), n - 2)
        u = inside / step - i
        first, last = self.heading[i], self.heading[i + 1]
        place = _hermite(self.points[i], self.points[i + 1], step * _along(first), step * _along(last), u[..., None])
        heading = _hermite(first, last, self._rate(i), self._rate(i + 1), u)
        return place + beyond * _along(heading), heading

    def _rate(self, i: NDArray[np.intp]) -> Array:
        """By how much the heading changes a step at the points numbered i."""
        before, after = np.maximum(i - 1, 0), np.minimum(i + 1, len(self.heading) - 1)
        return (self.heading[after] - self.heading[before]) / (after - before)


def plan(
    start: Array,
    goal: Array,
    obstacles: Sequence[Array],
    *,
    radius: float,
    turn_radius: float = 0.6,
    circles: Sequence[tuple[float, float, float]] = (),
    start_heading: float | None = None,
    names: Sequence[str] = (),
) -> Course:
    """The way from start to goal that keeps a radius from things, and bends as a person would.

    A start may be anywhere, a goal 0.12 m from a footprint or more, or where one stands; near them the way is as close
    to things as they are. A bend comes up to 8 cm nearer than the radius, but no nearer than 0.12 m. A step or two
    along what one stands at is straight: who drew back from it for so short a way would have to turn about on it.

    Args:
        start: (2,) metres, world.
        goal: (2,) metres, world.
        obstacles: the footprints, rings (k, 2) of the world.
        radius: of the walker, metres.
        turn_radius: of bends where there is room, metres.
        circles: x, y, r of other humans; r is without the walker's radius.
        start_heading: radians; of two ways about as long, the one ahead is taken.
        names: of the obstacles, for what a person is told.

    Raises:
        NoWay: the goal is within a footprint, or closed off.
    """
    start, goal = np.asarray(start, dtype=np.float64), np.asarray(goal, dtype=np.float64)
    around = Obstacles.of(obstacles, radius, circles, names)
    if not len(around.shapes):
        return _straight(start, goal, start_heading)
    line = shapely.LineString(np.stack([start, goal]))
    if (shapely.distance(around.shapes, line) >= radius).all():
        return _straight(start, goal, start_heading)
    ends = around.ends(start, goal)
    if line.length < _SAME and (ends.clearances[1] > ends.clearances[0] - _NO_NEARER).all():
        return _straight(start, goal, start_heading)  # one turns where one stands, however near to a thing
    if (ends.clearances[1] < NEAREST).any():
        raise NoWay(partial(_within, around, start, goal))
    if line.length <= _STEP and (shapely.distance(around.shapes, line) > _kept(around, ends)).all():
        return _straight(start, goal, start_heading)
    for slope, along in _LEAVES:
        ends = around.ends(start, goal, slope, along)
        floor = around.blocked(ends)
        way = shortest(start, goal, floor, start_heading)
        if way is not None:
            break
    else:
        raise NoWay(partial(_closed_off, around, start, goal))
    if len(way) == 2:
        return _straight(start, goal, start_heading)
    points, heading = rounded(way, around, ends, turn_radius)
    return Course(points, heading, float(np.linalg.norm(np.diff(points, axis=0), axis=-1).sum()))


def blocked(
    course: Course, s_from: float, s_to: float, circles: Sequence[tuple[float, float, float]], radius: float
) -> float | None:
    """The first arc length (to 1 cm) between two at which a circle x, y, r is nearer than radius + r; None: nowhere."""
    if not len(circles) or s_to < s_from:
        return None
    s = np.linspace(s_from, s_to, int(np.ceil((s_to - s_from) / (SAMPLE / 2.0))) + 1)
    table = np.asarray(circles, dtype=np.float64)
    away = np.linalg.norm(course.at(s)[0][:, None] - table[:, :2], axis=-1)
    near = (away < radius + table[:, 2]).any(axis=-1)
    return float(s[np.argmax(near)]) if near.any() else None


def _kept(around: Obstacles, ends: Ends) -> Array:
    """(m,) metres that a step keeps from each thing: the walker's radius, or as near as one stands to it at an end."""
    return np.clip(ends.clearances.min(axis=0) - _NO_NEARER, 0.0, around.radius)


def _straight(start: Array, goal: Array, start_heading: float | None) -> Course:
    way = goal - start
    length = float(np.hypot(*way))
    if length < 1e-9:
        return Course(goal[None].copy(), np.array([start_heading or 0.0]), 0.0)
    share = np.linspace(0.0, 1.0, int(np.ceil(length / SAMPLE)) + 1)
    points = start * (1.0 - share)[:, None] + goal * share[:, None]
    return Course(points, np.full(len(share), np.arctan2(way[1], way[0])), length)


def _along(heading: Array) -> Array:
    """Unit vectors (..., 2) of headings (...)."""
    return np.stack([np.cos(heading), np.sin(heading)], axis=-1)


def _hermite(a: Array, b: Array, slope_a: Array, slope_b: Array, u: Array) -> Array:
    """Between values a and b, with the slopes there per step, at the share u of the step."""
    return a + u * u * (3.0 - 2.0 * u) * (b - a) + u * (1.0 - u) * ((1.0 - u) * slope_a - u * slope_b)


def _within(around: Obstacles, start: Array, goal: Array) -> str:
    near = around.clearance(goal)
    i = int(np.argmin(near))
    if near[i] > 0.0:
        where = f"is nearer than {100 * NEAREST:.0f} cm to {around.names[i]}"
    elif around.names[i] == "another human":
        where = "is where another human stands"
    else:
        where = f"is inside {around.names[i]}"
    return f"the goal ({_spoken(goal)}) {where}; the nearest free place is {_free(around, start, goal)}"


def _closed_off(around: Obstacles, start: Array, goal: Array) -> str:
    ends = around.ends(start, goal)
    floor = around.blocked(ends)
    reached, bounds = walls_around(start, floor)
    other, others = walls_around(goal, floor)
    if other.area < reached.area:
        return (
            f"there is no way to ({_spoken(goal)}): it is closed off by {_list(around, others)}; "
            f"the nearest place that can be reached is {_free(around, start, goal)}"
        )
    return (
        f"there is no way to ({_spoken(goal)}): who walks is closed in by {_list(around, bounds)}; "
        f"the nearest place that can be reached is {_free(around, start, goal)}"
    )


def _free(around: Obstacles, start: Array, goal: Array) -> str:
    """The place nearest to a goal that is free and can be reached, as it is typed."""
    reached, _ = walls_around(start, around.blocked(around.ends(start, start, SLOPE / 4.0)))
    wide = shapely.union_all(shapely.buffer(around.shapes, 1.01 * around.radius, quad_segs=8))
    free = shapely.difference(reached, wide)
    if free.is_empty:
        free = shapely.Point(start)
    return "{:.2f} {:.2f}".format(*shapely.get_coordinates(shapely.shortest_line(free, shapely.Point(goal)))[0])


def _spoken(place: Array) -> str:
    return "{:.2f}, {:.2f}".format(*place)


def _list(around: Obstacles, which: Sequence[int]) -> str:
    names = list(dict.fromkeys(around.names[i] for i in which))
    more = len(names) - _NAMED
    return ", ".join(names[:_NAMED]) + (f" and {more} more" if more > 0 else "")
