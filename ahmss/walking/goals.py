"""Where one goes when one goes to a thing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import shapely

from ahmss.body.array import Array
from ahmss.body.quaternion import rotate
from ahmss.errors import AlgorithmError
from ahmss.walking.obstacles import Obstacles

__all__ = ["FARTHEST", "REACH", "Goal", "beside", "check_distance", "check_floor", "facing_of"]

REACH = 0.42  # metres from a thing that has no place of its own to stand at
# Metres that one walks at once: half an hour, planned in a tenth of a second; time and memory grow with it.
FARTHEST = 2000.0
_EDGE = 1e-6  # metres: who stands so near to a floor is on it
_NEAR = 0.20  # metres that one comes to things to use them
_DIRECTIONS = 24
_ROOM = 0.34  # metres that other things should be away: half the shoulders' width, and an arm
_FARTHER = (
    0.0,
    0.05,
    0.1,
    0.15,
)  # metres than the reach that one may stand from a thing, where there is no room nearer
_LEANS, _SHOULDER, _APART = 0.2, 0.2, 0.06  # metres that shoulders come forward, that they are aside, and stay away
_SQUEEZED = 20.0  # what each metre costs that a shoulder would be nearer than that to other things
_BETWEEN = 5.0  # what it costs that one of them is between, where a metre of reach too far costs three


@dataclass(frozen=True)
class Goal:
    """A place (2,) on the floor, metres, and a heading in radians; None: as one arrives."""

    place: Array
    facing: float | None


def check_distance(goal: Array, human: Array) -> None:
    """Refuse a goal (2,) that is further from a human (2,) than one walks at once; both in metres.

    Raises:
        AlgorithmError: says how far it is, and how far one goes.
    """
    away = float(np.linalg.norm(goal - human))
    if away > FARTHEST:
        x, y = goal.tolist()
        raise AlgorithmError(
            f"{x:g} {y:g} is {away / 1000.0:.4g} km away; name a place within {FARTHEST / 1000.0:g} km of the walker"
        )


def check_floor(goal: Array, floors: Sequence[Array], name: str) -> None:
    """Refuse a goal (2,) that is on none of these floors, outlines (n, 2), metres; without any it may be anywhere.

    Raises:
        AlgorithmError: says where the floor ends, `name` being the one that was meant.
    """
    if not floors:
        return
    ground, place = shapely.union_all([shapely.Polygon(ring) for ring in floors]), shapely.Point(goal)
    if shapely.dwithin(ground, place, _EDGE):
        return
    nearest = shapely.get_coordinates(shapely.shortest_line(ground, place))[0]
    said, ends = (" ".join(f"{x:.2f}" for x in each.tolist()) for each in (goal, nearest))
    raise AlgorithmError(f"{said} is beyond {name}, which ends at {ends}; name a place on it")


def facing_of(rotation: Array) -> float:
    """The heading of a frame's x axis (4,), radians."""
    ahead = rotate(rotation, np.array([1.0, 0.0, 0.0]))
    return float(np.arctan2(ahead[1], ahead[0]))


def beside(thing: Array, human: Array, outlines: Sequence[Array], reach: float = REACH) -> Goal:
    """Where to stand to use a thing at a place (2,): within reach, clear of footprints, facing it, not far to go.

    Nothing is to be between, as a wall is behind a table, nor close behind one, nor beside the shoulders of who leans
    towards it; what the thing stands on may be close.

    Args:
        thing: the place of what is used, metres, world.
        human: (2,) who comes.
        outlines: (n, 2) of what stands on the floor.
        reach: how far from the thing, metres; a little nearer or further where that is needed.
    """
    angles = np.linspace(0.0, 2.0 * np.pi, _DIRECTIONS, endpoint=False)
    around = Obstacles.of(outlines, _NEAR)
    others = around.shapes[shapely.distance(around.shapes, shapely.Point(thing)) > 0.0]
    best: tuple[float, float, Array] | None = None
    for farther, angle in product(_FARTHER, angles.tolist()):
        if angle == 0.0 and best is not None and best[1] <= 0.0:
            break  # there is room: one stands no farther away
        squeezed = 0.0
        wanted = thing + (reach + farther) * np.array([np.cos(angle), np.sin(angle)])
        free = around.nearest_free(wanted)
        cost = 3.0 * abs(float(np.linalg.norm(free - thing)) - reach) + 0.3 * float(np.linalg.norm(free - human))
        if len(others):
            cost += 3.0 * max(_ROOM - float(shapely.distance(others, shapely.Point(free)).min()), 0.0)
            near = shapely.distance(others[:, None], shapely.points(_shoulders(free, thing))).min()
            squeezed = _SQUEEZED * max(_APART - float(near), 0.0)
            cost += squeezed + _BETWEEN * bool(shapely.intersects(others, shapely.LineString([free, thing])).any())
        if best is None or cost < best[0]:
            best = cost, squeezed, free
    assert best is not None
    place = best[2]
    way = thing - place
    return Goal(place, float(np.arctan2(way[1], way[0])))


def _shoulders(place: Array, thing: Array) -> Array:
    """Where shoulders are (2, 2) of who stands at a place (2,) and leans towards a thing (2,)."""
    ahead = (thing - place) / max(float(np.linalg.norm(thing - place)), 1e-9)
    aside = _SHOULDER * np.array([[ahead[1], -ahead[0]], [-ahead[1], ahead[0]]])
    return place + _LEANS * ahead + aside
