"""How a walker turns in from the course that it is on into another one."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.walking.course import Course

__all__ = ["SHORTEST", "cut", "turned_into"]

_SHARPEST = 1.6  # 1/m, of a bend in which a walker turns in
_GENTLE = 0.9  # 1/m: a bend as gentle as that is not made gentler
_JOINS = (0.6, 0.9, 1.2, 1.6, 2.0, 2.6, 3.2)  # metres further on at which it may be on the other course
_SAMPLE = 0.02
SHORTEST = _JOINS[0]


def cut(course: Course, since: float, length: float) -> Course:
    """So much of a course from a length on; beyond its end it goes on straight."""
    points, heading = course.at(since + np.linspace(0.0, length, max(int(np.ceil(length / _SAMPLE)), 4) + 1))
    return Course(points, heading, length)


def turned_into(place: Array, heading: float, course: Course, *, soon: bool = False) -> Course | None:
    """A course that leaves a place in a heading and passes over into another one; None: it would bend too sharply.

    The curve between is a quintic whose bend begins and ends at 0; it is as short as is gentle enough, or, where one is
    to be on the other course soon, as can be walked.
    """
    best: tuple[float, Course] | None = None
    for join in _JOINS:
        if join > course.length - 0.3:
            break
        made = _joined(place, heading, course, join)
        step = made.length / (len(made.points) - 1)
        bend = float(np.abs(np.gradient(made.heading, step)).max())
        if best is None or bend < 0.9 * best[0]:
            best = bend, made
        if bend < (_SHARPEST if soon else _GENTLE):
            break
    return best[1] if best is not None and best[0] < _SHARPEST else None


def _joined(place: Array, heading: float, course: Course, join: float) -> Course:
    end, towards = course.at(np.array(join))
    reach = float(np.linalg.norm(end - place))
    u = np.linspace(0.0, 1.0, max(int(np.ceil(reach / _SAMPLE)), 8) + 1)[:, None]
    h = u**3 * (10.0 - 15.0 * u + 6.0 * u * u)
    begin = reach * np.array([np.cos(heading), np.sin(heading)])
    over = reach * np.array([np.cos(towards), np.sin(towards)])
    curve = place + h * (end - place) + begin * (u - u**3 * (6.0 - 8.0 * u + 3.0 * u * u))
    curve = curve + over * (u**3 * (-4.0 + 7.0 * u - 3.0 * u * u))
    left = course.length - join
    rest, _ = course.at(join + np.linspace(0.0, left, max(int(np.ceil(left / _SAMPLE)), 2) + 1)[1:])
    points = np.concatenate([curve, rest])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=-1))])
    even = np.linspace(0.0, along[-1], int(np.ceil(along[-1] / _SAMPLE)) + 1)
    points = np.stack([np.interp(even, along, points[:, i]) for i in range(2)], axis=-1)
    step = np.gradient(points, axis=0)
    headings = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    headings += 2.0 * np.pi * np.round((heading - headings[0]) / (2.0 * np.pi))
    return Course(points, headings, float(even[-1]))
