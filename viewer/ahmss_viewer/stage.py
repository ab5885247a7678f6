"""What is to be seen, as a pyrender scene: objects (merged while they stand still) and skinned humans."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pyrender
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.quaternion import to_matrix
from ahmss_viewer.batch import Batch, open_image
from ahmss_viewer.still import Merged
from ahmss_viewer.surface import Surface

__all__ = ["Actor", "Stage", "Thing"]

_REST = 30  # pictures without a movement after which an object is merged again


@dataclass
class Thing:
    """An object on the stage. `box`: its lowest and highest corner (2, 3) in its own frame."""

    id: int
    name: str
    surfaces: tuple[Surface, ...]
    place: Array
    rotation: Array
    box: Array
    mesh: pyrender.Mesh
    node: pyrender.Node | None = None  # where it is drawn by itself, while it moves
    rested: int = 0

    @property
    def matrix(self) -> Array:
        """T_world_object (4, 4)."""
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = to_matrix(self.rotation), self.place
        return T

    def centre(self) -> Array:
        """The middle of its box in the world."""
        return self.matrix[:3, :3] @ self.box.mean(axis=0) + self.place


@dataclass
class Actor:
    """A human on the stage.

    offsets (43, 3): as its skeleton has them. places (43, 3): its joints in the world. facing (3,): where its hips
    point, level.
    """

    id: int
    name: str
    offsets: Array
    batches: tuple[Batch, ...]
    inverse_binds: Array
    node: pyrender.Node
    places: Array = field(default_factory=lambda: np.zeros((43, 3)))
    facing: Array = field(default_factory=lambda: np.array([1.0, 0.0, 0.0]))


class Stage:
    """Objects and humans by their ids; `scene` is what the painter draws."""

    def __init__(self) -> None:
        self.scene = pyrender.Scene()
        self.things: dict[int, Thing] = {}
        self.actors: dict[int, Actor] = {}
        self._merged: dict[tuple[bytes | None, bool], Merged] = {}
        self._textures: dict[bytes, pyrender.Texture | None] = {}
        self._meshes: dict[tuple[int, ...], tuple[tuple[Surface, ...], pyrender.Mesh]] = {}

    # objects

    def add_object(
        self,
        number: int,
        name: str,
        surfaces: Sequence[Surface],
        place: Array,
        rotation: Array,
    ) -> None:
        """Put a new object on the stage; surfaces shared with other objects (one kind) are uploaded once."""
        self.remove_object(number)
        surfaces = tuple(surface for surface in surfaces if len(surface.faces))
        boxes = np.array([surface.bounds() for surface in surfaces]) if surfaces else np.zeros((1, 2, 3))
        box = np.array([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])
        thing = Thing(
            number, name, surfaces, np.array(place, float), np.array(rotation, float), box, self._mesh(surfaces)
        )
        self.things[number] = thing
        self._settle(thing)

    def remove_object(self, number: int) -> None:
        """Take an object off the stage."""
        thing = self.things.pop(number, None)
        if thing is None:
            return
        if thing.node is not None:
            self.scene.remove_node(thing.node)
        for index, surface in enumerate(thing.surfaces):
            self._merge_of(surface).remove((number, index))

    def move_object(self, number: int, place: Array, rotation: Array) -> None:
        """Put an object elsewhere; one that is already there stays merged."""
        thing = self.things[number]
        if np.array_equal(thing.place, place) and np.array_equal(thing.rotation, rotation):
            return
        thing.place, thing.rotation, thing.rested = np.array(place, float), np.array(rotation, float), 0
        if thing.node is None:
            for index, surface in enumerate(thing.surfaces):
                self._merge_of(surface).lift((number, index))
            thing.node = self.scene.add(thing.mesh, pose=thing.matrix)
        else:
            self.scene.set_pose(thing.node, thing.matrix)

    def tick(self) -> None:
        """Call after each picture: what has not moved for a while is merged again."""
        for thing in self.things.values():
            if thing.node is not None:
                thing.rested += 1
                if thing.rested >= _REST:
                    self.scene.remove_node(thing.node)
                    thing.node = None
                    self._settle(thing)

    # humans

    def add_human(self, number: int, name: str, offsets: Array, surfaces: Sequence[Surface]) -> None:
        """Put a human on the stage: surfaces with skins, offsets (43, 3) of its skeleton."""
        self.remove_human(number)
        skins = [surface.skin for surface in surfaces if surface.skin is not None]
        batches = tuple(Batch.of(s, self._texture(s.image)) for s in surfaces if s.skin is not None)
        binds = skins[0].inverse_binds if skins else np.broadcast_to(np.eye(4), (43, 4, 4))
        node = self.scene.add(pyrender.Mesh(list(batches), name=name))
        self.actors[number] = Actor(number, name, np.asarray(offsets, float), batches, np.asarray(binds, float), node)

    def remove_human(self, number: int) -> None:
        """Take a human off the stage."""
        actor = self.actors.pop(number, None)
        if actor is not None:
            self.scene.remove_node(actor.node)
            for batch in actor.batches:
                batch.delete()

    def pose_human(self, number: int, rotations: Array, root: Array) -> None:
        """Pose a human: rotations (43, 4), root (3,), as everywhere."""
        actor = self.actors[number]
        actor.places, world = forward(np.asarray(rotations, float), np.asarray(root, float), actor.offsets)
        T_world_link = np.zeros((43, 4, 4))
        T_world_link[:, :3, :3], T_world_link[:, :3, 3], T_world_link[:, 3, 3] = to_matrix(world), actor.places, 1.0
        ahead = -T_world_link[0, :3, 2] * np.array([1.0, 1.0, 0.0])
        actor.facing = ahead / max(float(np.linalg.norm(ahead)), 1e-9)
        links = (T_world_link @ actor.inverse_binds)[:, :3].astype(np.float32)
        for batch in actor.batches:
            batch.links = links

    # what the painter asks

    def still(self) -> Iterator[Batch]:
        """The merged batches."""
        for merged in self._merged.values():
            batch = merged.batch()
            if batch is not None:
                yield batch

    def moving(self) -> Iterator[tuple[Batch, Array]]:
        """What moves, each with T_world_model: humans first, then objects."""
        for actor in self.actors.values():
            for batch in actor.batches:
                yield batch, np.eye(4)
        for node in self.scene.mesh_nodes:
            for primitive in node.mesh.primitives:
                if not primitive.influences:
                    yield primitive, node.matrix

    def still_version(self) -> int:
        """Changes when what stands still changes."""
        return sum(merged.version for merged in self._merged.values())

    def still_bounds(self) -> Array | None:
        """Lowest and highest corner (2, 3) of what stands still."""
        return _union([merged.bounds() for merged in self._merged.values()])

    def moving_bounds(self) -> Array | None:
        """Lowest and highest corner (2, 3) of humans and of objects that move, with some room around joints."""
        boxes: list[Array | None] = []
        for actor in self.actors.values():
            boxes.append(np.array([actor.places.min(axis=0) - 0.25, actor.places.max(axis=0) + 0.3]))
        for thing in self.things.values():
            if thing.node is not None:
                reach = float(np.linalg.norm(thing.box, axis=1).max())
                boxes.append(np.array([thing.place - reach, thing.place + reach]))
        return _union(boxes)

    def faces(self) -> int:
        """How many triangles a picture has."""
        objects = sum(len(s.faces) for thing in self.things.values() for s in thing.surfaces)
        return objects + sum(len(batch.faces) for actor in self.actors.values() for batch in actor.batches)

    # inside

    def _settle(self, thing: Thing) -> None:
        """Merge an object that stands still."""
        for number, surface in enumerate(thing.surfaces):
            self._merge_of(surface).put((thing.id, number), surface, thing.matrix)

    def _merge_of(self, surface: Surface) -> Merged:
        """The merged batch of this surface's texture."""
        key = (surface.image, surface.two_sided)
        if key not in self._merged:
            self._merged[key] = Merged(self._texture(surface.image), two_sided=surface.two_sided)
        return self._merged[key]

    def _texture(self, image: bytes | None) -> pyrender.Texture | None:
        """The texture of these bytes, opened once."""
        if image is None:
            return None
        if image not in self._textures:
            self._textures[image] = open_image(image)
        return self._textures[image]

    def _mesh(self, surfaces: tuple[Surface, ...]) -> pyrender.Mesh:
        """The mesh of these surfaces, shared by all objects that have the same ones."""
        key = tuple(id(surface) for surface in surfaces)
        if key not in self._meshes:
            mesh = pyrender.Mesh([Batch.of(s, self._texture(s.image)) for s in surfaces])
            self._meshes[key] = (surfaces, mesh)  # holds the surfaces, so that their ids stay theirs
        return self._meshes[key][1]


def _union(boxes: Sequence[Array | None]) -> Array | None:
    """The box around boxes (2, 3)."""
    known: list[NDArray[Any]] = [box for box in boxes if box is not None]
    if not known:
        return None
    return np.array([np.min([b[0] for b in known], axis=0), np.max([b[1] for b in known], axis=0)])
