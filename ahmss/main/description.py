"""What START tells of the world: the objects and humans that an algorithm asks for, each as algorithms see it."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from typing import Any, Protocol

import msgspec
import numpy as np

from ahmss.algorithm import messages
from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, rotate
from ahmss.database.footprint import Rings
from ahmss.database.records import AlgorithmEntry, ObjectKind
from ahmss.database.statefile import ONESELF
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError
from ahmss.main.body_parts import Body, Parts
from ahmss.main.company import KIND, site_number
from ahmss.world.schema import ObjectRecord

__all__ = ["Description", "Scene", "describe", "describe_human", "four", "triple"]

_NEAR = 5.0  # metres: what an algorithm that asks for the near world is told of
_AT_HAND = 2.5  # metres: whose arms are told to an algorithm that asks for arms


class Scene(Protocol):
    """What is in the world, as one main sees it."""

    @property
    def objects(self) -> Mapping[str, ObjectRecord]:
        """Records by name."""
        ...

    def pose(self, name: str) -> Array:
        """(7,) place and rotation of an object, now."""
        ...

    def others(self) -> list[messages.ObjectRecord]:
        """The other humans, now."""
        ...

    def body(self, name: str) -> Body:
        """A human's body, now."""
        ...

    def way(self, name: str) -> Array | None:
        """(6, 2) where a human means to be, now; None: it is not told."""
        ...


def describe(
    kind: ObjectKind, record: ObjectRecord, pose: Array, footprint: list[list[messages.Point]] | None = None
) -> messages.ObjectRecord:
    """An object of a kind in a pose (7,) as algorithms are told of it."""
    sites = {
        n: messages.SiteRecord(s.position, s.rotation, _free(s.free_axis), _grip(s.grip)) for n, s in kind.sites.items()
    }
    return messages.ObjectRecord(
        record.id, record.name, record.kind, triple(pose[:3]), four(pose[3:]), sites, kind.properties,
        dict(record.states), footprint or [],
    )  # fmt: skip


def describe_human(workspace: Workspace, scene: Scene, name: str) -> messages.ObjectRecord:
    """A human as an object: the sites that belong to parts of its body have numbers, as they move by themselves.

    Raises:
        AhmssError: its kind is broken, or its skeleton can't be had.
    """
    record, pose = scene.objects[name], scene.pose(name)
    kind = workspace.objects.get(record.kind)
    told = describe(kind, record, pose)
    moving = [site for site in kind.sites if kind.sites[site].part]
    body = scene.body(name)
    rows = np.array(Parts(kind.sites[site] for site in moving).of(body.skeleton, body.pose))
    back = conjugate(pose[3:])
    sites = dict(told.sites)
    for site, row in zip(moving, rows, strict=True):
        place, rotation = rotate(back, row[:3] - pose[:3]), multiply(back, row[3:])
        number = site_number(-record.id, list(kind.sites).index(site))
        sites[site] = messages.SiteRecord(triple(place), four(rotation), id=number)
    return msgspec.structs.replace(told, sites=sites)


class Description:
    """What one algorithm is told. The file of a kind is looked at once, however many objects are of it.

    Args:
        entry: the algorithm, which says what it asks for.
        holds: what the acting human holds, and in which hand; that has no footprint, being in nobody's way.
        acting: the acting human's name: of whom the state `oneself` is told.
    """

    def __init__(
        self, workspace: Workspace, scene: Scene, entry: AlgorithmEntry, holds: Mapping[str, str], acting: str = ""
    ) -> None:
        self._workspace, self._scene, self._entry, self._acting = workspace, scene, entry, acting
        self._held = tuple(name for name, hand in holds.items() if hand)
        self._within = tuple(f"{name}/" for name in self._held)
        self._objects = scene.objects
        self._kinds: dict[str, ObjectKind] = {}
        self._footprints: dict[tuple[str, bytes], list[list[messages.Point]]] = {}

    def object(self, name: str) -> messages.ObjectRecord:
        """The target object.

        Raises:
            AhmssError: its kind is broken.
        """
        told = self._with_way(self._object(name))
        return msgspec.structs.replace(told, shape=self._shape(told.kind)) if self._entry.shape else told

    def _object(self, name: str) -> messages.ObjectRecord:
        """An object without its shape."""
        record, pose = self._objects[name], self._scene.pose(name)
        if record.kind == KIND:
            return self._known(describe_human(self._workspace, self._scene, name))
        kind = self._kinds.get(record.kind)
        if kind is None:
            kind = self._kinds[record.kind] = self._workspace.objects.get(record.kind)
        return describe(kind, record, pose, self._footprint(name, record.kind, pose))

    def _known(self, told: messages.ObjectRecord) -> messages.ObjectRecord:
        """A human, with whether it is oneself."""
        if told.name != self._acting:
            return told
        return msgspec.structs.replace(told, states={**told.states, ONESELF: "yes"})

    def _with_shape(self, told: messages.ObjectRecord) -> messages.ObjectRecord:
        """Another object than the target, with its shape where those of what occupies the floor are asked for."""
        if not self._entry.shapes or not told.footprint:
            return told
        return msgspec.structs.replace(told, shape=self._shape(told.kind))

    def _shape(self, kind: str) -> messages.ShapeRecord | None:
        """Where the shape of a kind is kept; None where it has none, or one that is broken or can't be kept."""
        try:
            kept = self._workspace.objects.kept_shape(kind)
        except AhmssError:
            return None
        return messages.ShapeRecord(str(kept[0]), kept[1]) if kept is not None else None

    def goal(self, goal: messages.Goal) -> messages.Goal:
        """The goal, with its object's footprint, or the way of who it is."""
        target = goal.object
        if target is not None and target.kind == KIND:
            return msgspec.structs.replace(goal, object=self._with_way(self._known(target)))
        if target is None or not self._entry.footprints:
            return goal
        footprint = self._footprint(target.name, target.kind, np.array([*target.place, *target.rotation]))
        return msgspec.structs.replace(goal, object=msgspec.structs.replace(target, footprint=footprint))

    def world(self, target: str, root: Array) -> list[messages.ObjectRecord]:
        """The other objects than the target, near the human at `root` (3,) or all, and the other humans."""
        found: list[messages.ObjectRecord] = []
        asked = self._entry.world
        for name in self._objects if asked != "none" else ():
            if name == target or self._objects[name].kind == KIND:  # humans come as `humans` asks
                continue
            if asked == "all" or float(np.linalg.norm(self._scene.pose(name)[:3] - root)) <= _NEAR:
                try:
                    found.append(self._with_shape(self._object(name)))
                except AhmssError:  # another object's broken file does not concern this motion
                    continue
        others = self._scene.others() if self._entry.humans else ()
        return found + [self._with_way(self._with_arms(human, root)) for human in others]

    def _with_arms(self, told: messages.ObjectRecord, root: Array) -> messages.ObjectRecord:
        """A human with its sites, where arms are asked for and it is near a root (3,)."""
        near = _NEAR if self._entry.carries else _AT_HAND  # who goes there comes near to others
        if not self._entry.arms or float(np.linalg.norm(np.array(told.place)[:2] - root[:2])) > near:
            return told
        if told.name not in self._objects or self._objects[told.name].kind != KIND:
            return told  # an object that is called like a human hides it
        with contextlib.suppress(AhmssError, KeyError):  # somebody whose body is not known yet is told of as before
            return describe_human(self._workspace, self._scene, told.name)
        return told

    def _with_way(self, told: messages.ObjectRecord) -> messages.ObjectRecord:
        """A human with where they mean to be now, where that is asked and they tell it."""
        way = self._scene.way(told.name) if self._entry.ways and told.kind == KIND else None
        return told if way is None else msgspec.structs.replace(told, way=[(x, y) for x, y in way.tolist()])

    def _footprint(self, name: str, kind: str, pose: Array) -> list[list[messages.Point]]:
        """What an object in a pose (7,) occupies on the floor, where that is asked; nothing if its shape is broken."""
        if not self._entry.footprints or name in self._held or name.startswith(self._within):
            return []
        key = kind, pose[2:].tobytes()
        if key not in self._footprints:
            rings: Rings = ()
            with contextlib.suppress(AhmssError):
                rings = self._workspace.objects.footprint(kind, float(pose[2]), pose[3:])
            self._footprints[key] = [list(ring) for ring in rings]
        return self._footprints[key]


def triple(v: Array) -> tuple[float, float, float]:
    """A place (3,) for a message."""
    x, y, z = v.tolist()
    return (x, y, z)


def four(q: Array) -> tuple[float, float, float, float]:
    """A rotation (4,) for a message."""
    w, x, y, z = q.tolist()
    return (w, x, y, z)


def _free(axis: str) -> Any:
    return "z" if axis == "z" else ""


def _grip(grip: str) -> Any:
    return grip
