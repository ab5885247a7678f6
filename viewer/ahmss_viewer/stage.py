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
from ahmss.body.links import INDEX
from ahmss.body.quaternion import to_matrix
from ahmss_viewer.batch import Batch, open_image
from ahmss_viewer.still import Merged
from ahmss_viewer.surface import Surface
from ahmss_viewer.thing import Piece, Thing, box_of

__all__ = ["Actor", "Piece", "Stage", "Thing"]

_TRUNK = [INDEX["hips"], INDEX["spine"], INDEX["head"]]
_REST = 30  # pictures without a movement after which an object is merged again


@dataclass
class Actor:
    """A human on the stage.

    offsets (43, 3), eye (3,): as its skeleton has them. head (4,): the rotation of its head, world <- head.
    places (43, 3): its joints in the world. facing (3,): where its hips point, level. limbs: what it sees of itself.
    """

    id: int
    name: str
    offsets: Array
    batches: tuple[Batch, ...]
    inverse_binds: Array
    node: pyrender.Node
    places: Array = field(default_factory=lambda: np.zeros((43, 3)))
    facing: Array = field(default_factory=lambda: np.array([1.0, 0.0, 0.0]))
    eye: Array = field(default_factory=lambda: np.zeros(3))
    head: Array = field(default_factory=lambda: np.array([1.0, 0.0, 0.0, 0.0]))
    limbs: tuple[Batch, ...] = ()


class Stage:
    """Objects and humans by their ids; `scene` is what the painter draws."""

    def __init__(self) -> None:
        self.scene = pyrender.Scene()
        self.things: dict[int, Thing] = {}
        self.actors: dict[int, Actor] = {}
        self._merged: dict[tuple[bytes | None, bool], Merged] = {}
        self._textures: dict[bytes, pyrender.Texture | None] = {}
        self._lifted: dict[int, Thing] = {}
        self._batches: dict[int, tuple[Surface, Batch]] = {}
        self._seer: int | None = None

    # objects

    def add_object(
        self,
        number: int,
        name: str,
        shape: Sequence[Surface | Piece],
        place: Array,
        rotation: Array,
    ) -> None:
        """Put a new object on the stage; surfaces shared with other objects (one kind) are uploaded once."""
        self.remove_object(number)
        pieces = tuple(one if isinstance(one, Piece) else Piece(one) for one in shape)
        pieces = tuple(piece for piece in pieces if len(piece.surface.faces))
        thing = Thing(number, name, pieces, np.array(place, float), np.array(rotation, float), box_of(pieces))
        self.things[number] = thing
        self._settle(thing)

    def remove_object(self, number: int) -> None:
        """Take an object off the stage."""
        thing = self.things.pop(number, None)
        if thing is None:
            return
        self._put_down(thing)
        for merged in self._merged.values():
            for index in range(len(thing.pieces)):
                merged.remove((number, index))

    def move_object(self, number: int, place: Array, rotation: Array) -> None:
        """Put an object elsewhere; one that is already there stays merged."""
        thing = self.things[number]
        if np.array_equal(thing.place, place) and np.array_equal(thing.rotation, rotation):
            return
        thing.place, thing.rotation = np.array(place, float), np.array(rotation, float)
        self._lift(thing)

    def dress_object(self, number: int, pieces: Sequence[Piece]) -> None:
        """Give an object another look: as many pieces as it was added with, their surfaces as large as those."""
        thing = self.things[number]
        before, thing.pieces = thing.pieces, tuple(piece for piece in pieces if len(piece.surface.faces))
        turned = any(not _same(a.matrix, b.matrix) for a, b in zip(before, thing.pieces, strict=True))
        for index, piece in enumerate(before):
            if piece.surface is not thing.pieces[index].surface:
                self._merge_of(piece.surface).lift((number, index))
        if thing.node is not None:
            self._put_down(thing)
            self._lift(thing)
        elif turned:
            self._lift(thing)
        else:
            self._settle(thing)

    def tick(self) -> None:
        """Call after each picture: what has not moved for a while is merged again."""
        for thing in list(self._lifted.values()):
            thing.rested += 1
            if thing.rested >= _REST:
                self._put_down(thing)
                self._settle(thing)

    # humans

    def add_human(
        self, number: int, name: str, offsets: Array, surfaces: Sequence[Surface], eye: Array | None = None
    ) -> None:
        """Put a human on the stage: surfaces with skins, offsets (43, 3) and eye (3,) of its skeleton."""
        self.remove_human(number)
        skins = [surface.skin for surface in surfaces if surface.skin is not None]
        batches = tuple(Batch.of(s, self._texture(s.image)) for s in surfaces if s.skin is not None)
        binds = skins[0].inverse_binds if skins else np.broadcast_to(np.eye(4), (43, 4, 4))
        node = self.scene.add(pyrender.Mesh(list(batches), name=name))
        actor = Actor(number, name, np.asarray(offsets, float), batches, np.asarray(binds, float), node)
        actor.eye = np.zeros(3) if eye is None else np.asarray(eye, float)
        self.actors[number] = actor

    def remove_human(self, number: int) -> None:
        """Take a human off the stage."""
        actor = self.actors.pop(number, None)
        if actor is not None:
            self.scene.remove_node(actor.node)
            for batch in (*actor.batches, *actor.limbs):
                batch.delete()

    def pose_human(self, number: int, rotations: Array, root: Array) -> None:
        """Pose a human: rotations (43, 4), root (3,), as everywhere."""
        actor = self.actors[number]
        actor.places, world = forward(np.asarray(rotations, float), np.asarray(root, float), actor.offsets)
        actor.head = world[INDEX["head"]]
        T_world_link = np.zeros((43, 4, 4))
        T_world_link[:, :3, :3], T_world_link[:, :3, 3], T_world_link[:, 3, 3] = to_matrix(world), actor.places, 1.0
        ahead = -T_world_link[0, :3, 2] * np.array([1.0, 1.0, 0.0])
        actor.facing = ahead / max(float(np.linalg.norm(ahead)), 1e-9)
        links = (T_world_link @ actor.inverse_binds)[:, :3].astype(np.float32)
        for batch in (*actor.batches, *actor.limbs):
            batch.links = links

    def see_by(self, number: int) -> None:
        """Show what a human sees: of its own body the limbs alone, for its collar would fill the picture."""
        actor, self._seer = self.actors[number], number
        if not actor.limbs:
            actor.limbs = tuple(_without_trunk(batch) for batch in actor.batches)

    # what the painter asks

    def still(self) -> Iterator[Batch]:
        """The merged batches."""
        for merged in self._merged.values():
            batch = merged.batch()
            if batch is not None:
                yield batch

    def moving(self, *, seen: bool = False) -> Iterator[tuple[Batch, Array]]:
        """What moves, each with T_world_model: humans first, then objects. seen: as whom it is seen by sees it."""
        for actor in self.actors.values():
            for batch in actor.limbs if seen and actor.id == self._seer else actor.batches:
                yield batch, np.eye(4)
        for thing in self._lifted.values():
            yield from thing.drawn()

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
        for thing in self._lifted.values():
            reach = float(np.linalg.norm(thing.box, axis=1).max())
            boxes.append(np.array([thing.place - reach, thing.place + reach]))
        return _union(boxes)

    def faces(self) -> int:
        """How many triangles a picture has."""
        objects = sum(len(p.surface.faces) for thing in self.things.values() for p in thing.pieces if p.shown)
        return objects + sum(len(batch.faces) for actor in self.actors.values() for batch in actor.batches)

    # inside

    def _settle(self, thing: Thing) -> None:
        """Merge an object that stands still; what of it is hidden keeps its room there."""
        for index, piece, matrix in thing.placed():
            merged = self._merge_of(piece.surface)
            merged.put((thing.id, index), piece.surface, matrix)
            if not piece.shown:
                merged.lift((thing.id, index))

    def _lift(self, thing: Thing) -> None:
        """Draw an object by itself from now on."""
        thing.rested = 0
        if thing.node is not None:
            self.scene.set_pose(thing.node, thing.matrix)
            return
        for index, piece in enumerate(thing.pieces):
            self._merge_of(piece.surface).lift((thing.id, index))
        thing.batches = [self._batch(piece.surface) for piece in thing.pieces]
        thing.node = self.scene.add(pyrender.Mesh(list(thing.batches)), pose=thing.matrix)
        self._lifted[thing.id] = thing

    def _put_down(self, thing: Thing) -> None:
        """Draw it by itself no longer."""
        if thing.node is not None:
            self.scene.remove_node(thing.node)
            thing.node = None
            del self._lifted[thing.id]

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

    def _batch(self, surface: Surface) -> Batch:
        """The batch of a surface, shared by all objects that have it."""
        known = self._batches.get(id(surface))
        if known is None:  # holds the surface, so that its id stays its own
            known = self._batches[id(surface)] = (surface, Batch.of(surface, self._texture(surface.image)))
        return known[1]


def _without_trunk(batch: Batch) -> Batch:
    """The faces of a human that neither head nor trunk move."""
    held: NDArray[Any] = (batch.vertices["weights"] * np.isin(batch.vertices["joints"], _TRUNK)).max(axis=1)
    faces = batch.faces[np.equal(held[batch.faces].max(axis=1), 0)]
    limbs = Batch(batch.vertices, faces, batch.texture, influences=batch.influences)
    limbs.links = batch.links
    return limbs


def _same(a: Array | None, b: Array | None) -> bool:
    """Whether two matrices are the same, None being the identity."""
    return a is b or (a is not None and b is not None and np.array_equal(a, b))


def _union(boxes: Sequence[Array | None]) -> Array | None:
    """The box around boxes (2, 3)."""
    known: list[NDArray[Any]] = [box for box in boxes if box is not None]
    if not known:
        return None
    return np.array([np.min([b[0] for b in known], axis=0), np.max([b[1] for b in known], axis=0)])
