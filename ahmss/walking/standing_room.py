"""Room for the whole body of who comes to stand beside things: broad from side to side, less so from front to back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.skeleton import Skeleton
from ahmss.walking.goals import Goal
from ahmss.walking.pieces import Ground

__all__ = ["Room", "with_room"]

# Of a standing body the legs, the hips, the shoulders: from what share of the stature up; the joint that is so far
# aside, how much of that their middle is; how thick they are around it, metres.
_BANDS = ((0.0, "left_upper_leg", 1.0, 0.07), (0.4, "left_upper_leg", 0.75, 0.125), (0.72, "left_upper_arm", 1.0, 0.06))
_MOST, _ROUNDS = 0.12, 12  # metres that a place is moved; times
_ENOUGH = 1e-4  # metres


@dataclass(frozen=True)
class Room:
    """Where there is room: the place (2,), and beside what; "" where nothing is in the way."""

    place: Array
    beside: str = ""


def with_room(skeleton: Skeleton, goal: Goal, ground: Ground) -> Room | None:
    """The place nearest to a goal where no part of who stands there, looking its way, is in a thing.

    Args:
        skeleton: whose. goal: where, and which way; who may come to look anywhere has room for that.
        ground: what stands on the floor.

    Returns:
        None where there is none within 12 cm.
    """
    shapes = [shapely.Polygon(ring) if len(ring) > 2 else shapely.MultiPoint(ring) for ring in ground.outlines]
    tops = np.array([*ground.tops] or [np.inf] * len(shapes))
    place, beside = np.array(goal.place, np.float64), ""
    near = [i for i, shape in enumerate(shapes) if shapely.distance(shape, shapely.Point(place)) < 2.0 * _MOST + 0.3]
    for _ in range(_ROUNDS):
        worst, out = _ENOUGH, np.zeros(2)
        for i in near:
            for from_height, joint, share, thick in _BANDS:
                if from_height * skeleton.stature >= tops[i]:
                    continue
                aside = share * abs(float(skeleton.offsets[INDEX[joint], 1]))
                body, radius = _body(place, goal.facing, aside, thick)
                line = shapely.get_coordinates(shapely.shortest_line(shapes[i], body))
                lack = radius - float(np.hypot(*(line[1] - line[0])))
                if lack > worst:
                    away = (
                        line[1] - line[0] if lack < radius else place - shapely.get_coordinates(shapes[i].centroid)[0]
                    )
                    worst, out, beside = lack, lack / max(float(np.hypot(*away)), 1e-9) * away, _named(ground, i)
        if not out.any():
            return Room(place, beside)
        place = place + out
        if np.hypot(*(place - goal.place)) > _MOST:
            return None
    return None


def _body(place: Array, facing: float | None, aside: float, thick: float) -> tuple[shapely.Geometry, float]:
    """The middle of a part of a body from one side to the other, and how thick it is around that, metres."""
    if facing is None:
        return shapely.Point(place), aside + thick
    left = aside * np.array([-np.sin(facing), np.cos(facing)])
    return shapely.LineString([place - left, place + left]), thick


def _named(ground: Ground, i: int) -> str:
    return ground.names[i] if i < len(ground.names) else "something"
