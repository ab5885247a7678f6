"""Room for the whole body of who comes to stand beside things: broad from side to side, less so from front to back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.skeleton import Skeleton
from ahmss.walking.goals import Goal
from ahmss.walking.pieces import Ground

__all__ = ["Load", "Room", "with_room"]

# Of a standing body the legs, the hips, the shoulders: from what share of the stature up; the joint that is so far
# aside, how much of that their middle is; how thick they are around it, metres.
_BANDS = ((0.0, "left_upper_leg", 1.0, 0.07), (0.4, "left_upper_leg", 0.75, 0.125), (0.72, "left_upper_arm", 1.0, 0.06))
_MOST, _ROUNDS = 0.12, 12  # metres that a place is moved; times
_ENOUGH = 1e-4  # metres
_BODY = 0.2  # metres from its middle to things, with which a body has room


@dataclass(frozen=True)
class Room:
    """Where there is room: the place (2,), and beside what; "" where nothing is in the way."""

    place: Array
    beside: str = ""


@dataclass(frozen=True, eq=False)
class Load:
    """What is carried before who stands: points (n, 2) around it in the hips' floor frame, how low it is, and how far
    it is kept from things, metres.
    """

    around: Array
    low: float
    air: float

    @property
    def reach(self) -> float:
        """How far it is from the hips, metres."""
        return float(np.linalg.norm(self.around, axis=-1).max()) + self.air


def with_room(
    skeleton: Skeleton, goal: Goal, ground: Ground, load: Load | None = None, *, body: bool = True
) -> Room | None:
    """The place nearest to a goal where no part of who stands there, looking its way, is in a thing.

    Args:
        skeleton: whose. goal: where, and which way; who may come to look anywhere has room for that.
        ground: what stands on the floor.
        load: what they carry. body: whether the body counts, too; else it is no nearer to things than at the goal.

    Returns:
        None where there is none within 12 cm, or, of who carries something, as much farther as that reaches.
    """
    shapes = [shapely.Polygon(ring) if len(ring) > 2 else shapely.MultiPoint(ring) for ring in ground.outlines]
    tops = np.array([*ground.tops] or [np.inf] * len(shapes))
    place, beside = np.array(goal.place, np.float64), ""
    most = _MOST + (0.0 if load is None else load.reach)
    near = [i for i, shape in enumerate(shapes) if shapely.distance(shape, shapely.Point(place)) < 2.0 * most + 0.3]
    for _ in range(_ROUNDS):
        worst, out = _ENOUGH, np.zeros(2)
        parts = _parts(skeleton, place, goal.facing, load, body=body)
        for i in near:
            for low, part, radius in parts:
                if low >= tops[i]:
                    continue
                lack, away = _out_of(shapes[i], part, radius, place)
                if lack > worst:
                    worst, out, beside = lack, lack / max(float(np.hypot(*away)), 1e-9) * away, _named(ground, i)
        if not out.any():
            crowded = not body and _room(shapes, place) < min(_room(shapes, goal.place), _BODY)
            return None if crowded else Room(place, beside)
        place = place + out
        if np.hypot(*(place - goal.place)) > most:
            return None
    return None


def _room(shapes: Sequence[shapely.Geometry], place: Array) -> float:
    """Metres from a place (2,) to the nearest of shapes."""
    return float(min(shapely.distance(shapes, shapely.Point(place)), default=np.inf))


def _parts(
    skeleton: Skeleton, place: Array, facing: float | None, load: Load | None, *, body: bool
) -> list[tuple[float, shapely.Geometry, float]]:
    """Of each part of who stands at a place: from what height up it is, its middle, how thick it is around, metres."""
    parts: list[tuple[float, shapely.Geometry, float]] = []
    for from_height, joint, share, thick in _BANDS if body else ():
        aside = share * abs(float(skeleton.offsets[INDEX[joint], 1]))
        parts.append((from_height * skeleton.stature, *_body(place, facing, aside, thick)))
    if load is not None and facing is None:
        parts.append((load.low, shapely.Point(place), load.reach))
    elif load is not None and facing is not None:
        ahead = np.array([np.cos(facing), np.sin(facing)])
        around = place + load.around @ np.stack([ahead, [-ahead[1], ahead[0]]])
        parts.append((load.low, shapely.MultiPoint(around).convex_hull, load.air))
    return parts


def _out_of(shape: shapely.Geometry, part: shapely.Geometry, radius: float, place: Array) -> tuple[float, Array]:
    """By how much (metres) a part so thick around its middle is in a shape, and the way (2,) out of it."""
    line = shapely.get_coordinates(shapely.shortest_line(shape, part))
    lack = radius - float(np.hypot(*(line[1] - line[0])))
    if lack < radius:
        return lack, line[1] - line[0]
    if shapely.get_dimensions(part) < 2:
        return lack, place - shapely.get_coordinates(shapely.centroid(shape))[0]
    moves = shapely.get_coordinates(shape)[:, None] - shapely.get_coordinates(part)
    edge = shapely.boundary(shapely.MultiPoint(moves.reshape(-1, 2)).convex_hull)  # moved so far it only touches
    away = shapely.get_coordinates(shapely.shortest_line(shapely.Point(0.0, 0.0), edge))[1]
    return lack + float(np.hypot(*away)), away


def _body(place: Array, facing: float | None, aside: float, thick: float) -> tuple[shapely.Geometry, float]:
    """The middle of a part of a body from one side to the other, and how thick it is around that, metres."""
    if facing is None:
        return shapely.Point(place), aside + thick
    left = aside * np.array([-np.sin(facing), np.cos(facing)])
    return shapely.LineString([place - left, place + left]), thick


def _named(ground: Ground, i: int) -> str:
    return ground.names[i] if i < len(ground.names) else "something"
