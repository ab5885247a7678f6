"""Whether something stands already where what is in a hand is to be put, and where there is room beside it.

What is meant are things on the same surface, be it a top or the floor, by their outlines seen from above. What has a
top of its own is not: one puts things on it, or under it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import shapely

from ahmss.body.array import Array
from ahmss.body.quaternion import about_z, rotate
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError, CommandError
from ahmss.main.company import KIND
from ahmss.main.description import Scene
from ahmss.main.tops import height_of_what_is_under

__all__ = ["FLAT", "TOUCHES", "outlines", "refuse_occupied"]

_SAME = 0.05  # metres by which the bottoms of two things differ at most that stand on one surface
FLAT = 0.002
"""Metres: what is no higher over the surface is in nothing's way."""

TOUCHES = 0.001
"""Metres: what goes no farther into another only touches it."""

_APART = 0.03  # metres beside what stands there: fingers that hold and let go have room
_WITHIN, _GRID = 0.4, 0.02  # metres from the place within which others are looked at, and between these
_THERE = 0.3  # what a metre to the place costs who puts it, where one from the place that was said costs 1


def refuse_occupied(workspace: Workspace, scene: Scene, title: str, held: str, place: Array, here: Array) -> None:
    """Refuse to put a thing where it would be in another; a kind whose shape can't be had is in nothing's way.

    Args:
        title: of the action. held: the thing's name. here: (3,) who puts it, metres.
        place: (3,) where its origin is to be.

    Raises:
        CommandError: names what stands there, and the nearest place where there is room.
    """
    low, radius = _size(workspace, scene.objects[held].kind)
    standing = dict(_standing(workspace, scene, held, place[2] + low))
    inside = [name for name, shape in standing.items() if _gap(shape, place[None, :2])[0] < radius - TOUCHES]
    if not inside:
        return
    steps = np.arange(-_WITHIN, _WITHIN + 0.5 * _GRID, _GRID)
    x, y = (axis.ravel() for axis in np.meshgrid(steps, steps))
    near = np.round(place[:2], 2) + np.stack([x, y], axis=1)
    far = np.linalg.norm(near - place[:2], axis=1) + _THERE * np.linalg.norm(near - here[:2], axis=1)
    near = near[np.argsort(far, kind="stable")]
    gap = np.min([_gap(shape, near) for shape in standing.values()], axis=0)
    free = (at for at in near[gap >= radius + _APART] if _is_on(workspace, scene, held, at, place[2], radius))
    found = next(free, None)
    room = "say another place" if found is None else f"there is room at {found[0]:.2f} {found[1]:.2f}"
    raise CommandError(f"{title}: {inside[0]} stands there; {room}, or move it first")


def _is_on(workspace: Workspace, scene: Scene, held: str, at: Array, height: float, radius: float) -> bool:
    """Whether all of a thing of a radius is over the same surface at a place (2,)."""
    around = at + radius * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    under = [height_of_what_is_under(workspace, scene, held, tuple(point)) for point in around.tolist()]
    return bool(np.ptp([*under, height]) < _SAME)


def _standing(workspace: Workspace, scene: Scene, held: str, level: float) -> Iterator[tuple[str, Any]]:
    """The names and outlines of what stands on the surface of a height, but for what is held by somebody."""

    def stands_on_it(kind: str, low: float, high: float) -> bool:
        same = abs(low - level) <= _SAME and high >= level + FLAT
        return same and "top" not in workspace.objects.get(kind).sites

    return outlines(workspace, scene, held, stands_on_it)


def outlines(
    workspace: Workspace, scene: Scene, held: str, meant: Callable[[str, float, float], bool]
) -> Iterator[tuple[str, Any]]:
    """The names of what is not held, and their outlines seen from above; of such as are meant.

    Args:
        held: what is not looked at. meant: tells it of a kind, and from what to what height it is there, metres.
    """
    for name, record in scene.objects.items():
        if name == held or name.startswith(f"{held}/") or record.holder or record.kind == KIND:
            continue
        pose = scene.pose(name)
        try:
            shape = workspace.objects.shape(record.kind)
            if shape is None or not meant(record.kind, *(float(pose[2] + bound[2]) for bound in shape.bounds)):
                continue
            rings = workspace.objects.footprint(record.kind, float(pose[2]), pose[3:])
        except AhmssError:  # a broken file hides its own kind only; who names it is told
            continue
        turn = about_z(pose[3:])
        if rings:
            rows = [pose[:2] + rotate(turn, np.pad(np.array(ring), ((0, 0), (0, 1))))[:, :2] for ring in rings]
            yield name, shapely.union_all([shapely.make_valid(shapely.Polygon(row)) for row in rows])


def _gap(shape: Any, places: Array) -> Array:
    """Metres (n) from places (n, 2) to an outline; 0 within it."""
    return np.asarray(shapely.distance(shape, shapely.points(places)))


def _size(workspace: Workspace, kind: str) -> tuple[float, float]:
    """Metres from its origin down to its bottom, and to its side where that is nearest to its middle."""
    try:
        shape = workspace.objects.shape(kind)
    except AhmssError:
        return 0.0, 0.0
    if shape is None:
        return 0.0, 0.0
    low, high = np.array(shape.bounds)
    return float(low[2]), 0.5 * float((high - low)[:2].min())
