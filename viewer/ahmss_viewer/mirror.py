"""Keeps a stage like the world: what came and went, what moved."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.errors import AhmssError, ProtocolError
from ahmss.states.behaviour import Behaviour, decode_behaviour
from ahmss.world.schema import HumanRecord, ObjectRecord
from ahmss.world.view import World
from ahmss_viewer.dressing import Wardrobe
from ahmss_viewer.figure import plain_figure
from ahmss_viewer.glb import read_glb
from ahmss_viewer.stage import Stage
from ahmss_viewer.surface import Surface

__all__ = ["Mirror"]

_PATIENCE_S = 3.0
_LOOK = ("id", "name", "shape", "texture")
_OBJECT = (*_LOOK, "behaviour")


class Mirror:
    """Shows a world on a stage.

    Args:
        stage: what is drawn.
        asset: the bytes of a shape or texture by hash; raises an AhmssError where it is not to be had.
        skeleton: a human's skeleton record.

    `problems` holds one sentence for each thing that can't be shown as it should: an object without a readable shape
    is left out, a human without one is drawn as a plain figure.
    """

    def __init__(
        self, stage: Stage, asset: Callable[[str], bytes], skeleton: Callable[[HumanRecord], dict[str, Any]]
    ) -> None:
        self.stage = stage
        self.problems: list[str] = []
        self._asset, self._skeleton = asset, skeleton
        self._surfaces: dict[tuple[str, str], tuple[Surface, ...]] = {}
        self._behaviours: dict[str, Behaviour | None] = {}
        self._wardrobe = Wardrobe(stage)
        self._changed: tuple[str, ...] = ()
        self._objects: dict[int, tuple[Any, ...]] = {}
        self._humans: dict[int, tuple[Any, ...]] = {}
        self._poses: Array | None = None
        self._revision = -1
        self._missing: set[int] = set()  # ids of what lacks its shape because nobody gave it
        self._again = 0.0

    def show(self, world: World) -> None:
        """Bring the stage to what the world is now; what could not be had is asked for again after a while."""
        again = bool(self._missing) and time.monotonic() > self._again
        changed: Iterable[str] = (*self._changed, *world.changed)
        if world.revision != self._revision or again:
            self._revision = world.revision
            self._objects = {n: look for n, look in self._objects.items() if n not in self._missing}
            self._humans = {n: look for n, look in self._humans.items() if n not in self._missing}
            self._missing.clear()
            self._again = time.monotonic() + _PATIENCE_S
            self._follow_objects(world)
            self._follow_humans(world)
            changed = world.objects
        self._changed = world.changed
        self._wardrobe.follow((name, world.objects[name].states) for name in changed if name in world.objects)
        self._place_objects(world)
        for number, pose in zip(world.human_ids, world.human_poses, strict=True):
            if int(number) in self.stage.actors:
                self.stage.pose_human(int(number), pose[3:].reshape(43, 4), pose[:3])

    def _follow_objects(self, world: World) -> None:
        """Objects that are new, gone, or look another way than before."""
        wanted = {r.id: tuple(getattr(r, key) for key in _OBJECT) for r in world.objects.values()}
        for number in [n for n, look in self._objects.items() if wanted.get(n) != look]:
            self.stage.remove_object(number)
            self._wardrobe.remove(number)
            del self._objects[number]
        for record in world.objects.values():
            if record.id not in self._objects:
                pose = world.pose(record.name)
                surfaces, behaviour = self._load(record), self._behaviour(record)
                shape = self._wardrobe.add(record.id, record.name, behaviour, surfaces, record.states)
                self.stage.add_object(record.id, record.name, shape, pose[:3], pose[3:])
                self._objects[record.id] = wanted[record.id]
        self._poses = None

    def _place_objects(self, world: World) -> None:
        """Move what is not where it was at the last picture."""
        ids, poses = world.poses()
        known = self._poses
        changed = np.arange(len(ids)) if known is None else np.flatnonzero((poses != known).any(axis=1))
        for row in changed:
            if int(ids[row]) in self.stage.things:
                self.stage.move_object(int(ids[row]), poses[row, :3], poses[row, 3:])
        self._poses = poses.copy()

    def _follow_humans(self, world: World) -> None:
        """Humans that are new, gone, or look another way than before."""
        wanted = {r.id: (*(getattr(r, key) for key in _LOOK), r.skeleton) for r in world.humans.values()}
        for number in [n for n, look in self._humans.items() if wanted.get(n) != look]:
            self.stage.remove_human(number)
            del self._humans[number]
        for record in world.humans.values():
            if record.id not in self._humans:
                self._add_human(record)
                self._humans[record.id] = wanted[record.id]

    def _add_human(self, record: HumanRecord) -> None:
        try:
            skeleton = Skeleton.from_record(self._skeleton(record))
        except (AhmssError, KeyError, ValueError, TypeError) as error:
            self._note(f"{record.name} is drawn with usual proportions: its skeleton can't be had ({error})")
            skeleton = Skeleton.of()
        surfaces = self._load(record)
        if not any(surface.skin is not None for surface in surfaces):
            surfaces = plain_figure(skeleton)
        self.stage.add_human(record.id, record.name, skeleton.offsets, surfaces, skeleton.eye)

    def _load(self, record: ObjectRecord | HumanRecord) -> tuple[Surface, ...]:
        """Surfaces of a shape with its texture, read once for all that share them; none where there is no shape."""
        key = (record.shape, record.texture)
        if not record.shape:
            return ()
        if key not in self._surfaces:
            try:
                surfaces = read_glb(self._asset(record.shape), record.name)
                if record.texture:
                    image = self._asset(record.texture)
                    surfaces = tuple(surface.textured(image) for surface in surfaces)
            except ProtocolError as error:
                self._note(str(error))
                self._surfaces[key] = ()
            except AhmssError as error:
                self._note(str(error))
                self._missing.add(record.id)
                return ()
            else:
                self._surfaces[key] = surfaces
        return self._surfaces[key]

    def _behaviour(self, record: ObjectRecord) -> Behaviour | None:
        """How its kind looks by its states, read once for all objects of the kind; None where nothing says so."""
        name = record.behaviour
        if not name:
            return None
        if name not in self._behaviours:
            try:
                self._behaviours[name] = decode_behaviour(self._asset(name))
            except AhmssError as error:
                self._note(f"{record.name} is shown as in its first states: {error}")
                if not isinstance(error, ProtocolError):
                    self._missing.add(record.id)
                    return None
                self._behaviours[name] = None
        return self._behaviours[name]

    def _note(self, problem: str) -> None:
        """Say each problem once."""
        if problem not in self.problems:
            self.problems.append(problem)
