"""Whether a way out of others' way is one that a person takes: past things, and in steps that people make."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from ahmss.walking.course import Course
from ahmss.walking.journey import Journey
from ahmss.walking.library import RATE

__all__ = ["natural", "touches"]

_THINGS = 0.17  # metres from things that who makes way may come
_LOWEST, _FASTEST, _HARDEST = 0.9, 2.0, 30.0  # hips' height of that in standing, m/s, m/s2: within that one makes way


def natural(going: Journey, height: float) -> bool:
    """Whether the next steps of a walk are such as a person makes whose hips are so high in standing, metres."""
    root = going.shaping.part(0, min(going.shaping.frames, 2 * going.seams[1])).root
    moved = np.diff(root, axis=0) * RATE
    return bool(
        root[:, 2].min() > _LOWEST * height
        and np.linalg.norm(moved, axis=-1).max() < _FASTEST
        and np.linalg.norm(np.diff(moved, axis=0), axis=-1).max() * RATE < _HARDEST
    )


def touches(course: Course, things: NDArray[Any]) -> bool:
    """Whether a course comes too near to things, polygons, soon, and nearer than where it begins."""
    points = course.points[:150]
    if not len(things) or len(points) < 2:
        return False
    near = shapely.distance(things, shapely.Point(points[0]))
    return bool((shapely.distance(things, shapely.LineString(points)) < np.minimum(near, _THINGS) - 1e-6).any())
