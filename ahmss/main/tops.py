"""Where on a thing what is in a hand is put down, and how high, where only the thing or a place in plan is said.

A thing that others stand on has the site `top`, the middle of a surface as wide as the property `size` says.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, rotate
from ahmss.database.records import ObjectKind
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError, CommandError
from ahmss.main.afforded import Actor
from ahmss.main.description import Scene

__all__ = ["height_of_what_is_under", "place_on_top"]

_AHEAD, _BESIDE = 0.42, 0.18  # metres from the hips to where a hand puts things at ease
_EDGE = 0.06  # metres that a thing stands from the edge
_APART = 0.05  # metres between things: fingers that let go have room
_GRID = 0.02  # metres between the places that are looked at
_ON_IT = 0.05  # metres above or below a top: what stands on it


@dataclass(frozen=True, slots=True)
class _Top:
    """The upper side of a thing: its middle (3,), its turn (4,), and half its width along x and y (2,), metres."""

    name: str
    middle: Array
    rotation: Array
    half: Array

    def across(self, places: Array) -> Array:
        """Places (..., 3) of the world as seen from the middle."""
        return rotate(conjugate(self.rotation), places - self.middle)

    def holds(self, place: Array) -> bool:
        """Whether a place is over it in plan."""
        return bool((np.abs(self.across(place)[:2]) <= self.half).all())


def place_on_top(workspace: Workspace, scene: Scene, held: str, onto: str, actor: Actor, hand: str) -> Array:
    """A free place (3,) on a thing for what is in the hand: as near as may be to where the hand comes at ease.

    Raises:
        CommandError: nothing can be put on it, or it is full.
    """
    top = _top(workspace, scene, onto)
    if top is None:
        raise CommandError(f"{onto} has no top that things are put on; say a place: to X Y Z")
    radius = _radius(workspace.objects.get(scene.objects[held].kind))
    inner = np.maximum(top.half - radius - _EDGE, 0.0)
    axes = [np.linspace(-reach, reach, 1 + 2 * int(np.ceil(reach / _GRID))) for reach in inner]
    x, y = (axis.ravel() for axis in np.meshgrid(*axes))
    at_ease = top.across(_at_ease(actor, hand))[:2]
    away = np.hypot(x - at_ease[0], y - at_ease[1])
    for place, wide in _standing_on(workspace, scene, top, held):
        seen = top.across(place)
        away[np.hypot(x - seen[0], y - seen[1]) < wide + radius + _APART] = np.inf
    best = int(np.argmin(away))
    if not np.isfinite(away[best]):
        raise CommandError(f"there is no room left on {onto}; say another place: to X Y Z")
    return top.middle + rotate(top.rotation, np.array([x[best], y[best], 0.0]))


def height_of_what_is_under(workspace: Workspace, scene: Scene, held: str, place: tuple[float, ...]) -> float:
    """Metres: of the highest top at a place in plan (x, y), or of the floor."""
    tops = [top for name in scene.objects if name != held and (top := _top(workspace, scene, name)) is not None]
    return max((float(top.middle[2]) for top in tops if top.holds(np.array([*place[:2], top.middle[2]]))), default=0.0)


def _top(workspace: Workspace, scene: Scene, name: str) -> _Top | None:
    """The top of a thing; None: it has none, or its file is broken, which who names it is told."""
    try:
        kind = workspace.objects.get(scene.objects[name].kind)
    except AhmssError:
        return None
    site = kind.sites.get("top")
    if site is None:
        return None
    pose = scene.pose(name)
    size = kind.properties.get("size", (0.0, 0.0))
    middle = pose[:3] + rotate(pose[3:], np.array(site.position))
    return _Top(name, middle, pose[3:], 0.5 * np.array(size[:2], dtype=float))


def _at_ease(actor: Actor, hand: str) -> Array:
    """Where the hand comes at ease (3,), in plan: the hips' z axis points back, their y to the left."""
    side = {"right": -_BESIDE, "left": _BESIDE}.get(hand, 0.0)
    ahead, left = (rotate(actor.rotations[0], np.array(axis)) for axis in ([0.0, 0.0, -1.0], [0.0, 1.0, 0.0]))
    ahead[2] = left[2] = 0.0
    return actor.root + _AHEAD * ahead / np.linalg.norm(ahead) + side * left / np.linalg.norm(left)


def _standing_on(workspace: Workspace, scene: Scene, top: _Top, held: str) -> Iterator[tuple[Array, float]]:
    """Place (3,) and radius of all that stands on a top, but for what is in the hand."""
    for name, record in scene.objects.items():
        if name in (held, top.name) or record.holder:
            continue
        place = scene.pose(name)[:3]
        if abs(float(top.across(place)[2])) < _ON_IT and top.holds(place):
            try:
                yield place, _radius(workspace.objects.get(record.kind))
            except AhmssError:  # a broken file hides its own kind only; who names it is told
                continue


def _radius(kind: ObjectKind) -> float:
    """Metres from its middle within which a thing is, in plan."""
    size = kind.properties.get("size", (0.0, 0.0))
    return 0.5 * float(max(kind.properties.get("diameter", 0.0), np.hypot(size[0], size[1])))
