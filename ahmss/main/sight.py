"""What a human can see: what is before its eyes, and behind nothing.

An object is seen if one of nine points of it (the middle of its box, and eight more inside) lies within 60 degrees of
the line of sight (15 degrees below where the head faces), and no face of another object is between it and the point
between the eyes. Humans hide nothing; what has no shape is not seen and hides nothing. How far away and how well lit it
is does not count.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from concurrent.futures import Future
from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, rotate
from ahmss.body.sight import line_of_sight
from ahmss.database.footprint import triangles_of
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError
from ahmss.main.afforded import Actor
from ahmss.main.aside import aside
from ahmss.main.mesh import Mesh
from ahmss.world.schema import ObjectRecord
from ahmss.world.view import World

__all__ = ["WAITS", "WORKS", "Sight", "View", "eyes"]

WORKS, WAITS = False, True
"""What who works in pieces yields: there is more to do at once, or only in a later frame."""

_WIDEST = np.cos(np.radians(60.0))
_NEAR = 0.03  # metres before a point within which a face belongs to it: a knob on a panel
_INNER = 0.7  # of the half box: where the eight points are
_CORNERS = np.array([[0, 0, 0], *([x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1))], float)
_NOTHING = Mesh.of(np.zeros((0, 3, 3)))
_CHUNK = 256  # objects that are indexed in one go


def eyes(actor: Actor) -> tuple[Array, Array]:
    """The point between the eyes (3,), and the unit vector (3,) of the line of sight; in the world, metres."""
    places, world = forward(actor.rotations, actor.root, actor.skeleton.offsets)
    head = INDEX["head"]
    return line_of_sight(places[head], world[head], actor.skeleton.eye)


@dataclass(frozen=True, eq=False)
class View:
    """One look at the world.

    eye, ahead (3,): of the human, its line of sight. rows: of each object's name. poses (n, 7). centres (n, 3), radii
    (n,): of the balls around them, in the world; a radius of -1 is of what has no shape. meshes: the shape of each.
    """

    eye: Array
    ahead: Array
    rows: dict[str, int]
    poses: Array
    centres: Array
    radii: Array
    meshes: Sequence[Mesh]

    def sees(self, name: str) -> bool:
        """Whether an object is seen."""
        search = self.search(name)
        while True:
            try:
                next(search)
            except StopIteration as end:
                return bool(end.value)

    def search(self, name: str) -> Generator[bool, None, bool]:
        """Whether an object is seen, in pieces of work; one that came since is not."""
        row = self.rows.get(name)
        if row is None:
            return False
        mesh = self.meshes[row]
        points = mesh.middle + _INNER * np.maximum(mesh.half, 0.0) * _CORNERS
        away = self.poses[row, :3] + rotate(self.poses[row, 3:], points) - self.eye
        lengths = np.maximum(np.linalg.norm(away, axis=1), 1e-9)
        for point in np.flatnonzero(away @ self.ahead >= _WIDEST * lengths):
            if not self._hidden(row, away[point] / lengths[point], float(lengths[point]) - _NEAR):
                return True
            yield WORKS
        return False

    def _hidden(self, row: int, way: Array, length: float) -> bool:
        """Whether a face is in the way from the eye, but of the object itself."""
        centres = self.centres - self.eye
        along = centres @ way
        off = np.einsum("ij,ij->i", centres, centres) - along**2
        near = (off <= self.radii**2) & (self.radii >= 0.0) & (along >= -self.radii) & (along <= length + self.radii)
        return any(other != row and self._hits(int(other), way, length) for other in np.flatnonzero(near))

    def _hits(self, other: int, way: Array, length: float) -> bool:
        """Whether the ray meets another object."""
        back = conjugate(self.poses[other, 3:])
        return self.meshes[other].hit(rotate(back, self.eye - self.poses[other, :3]), rotate(back, way), length)


class Sight:
    """Makes views in small pieces of work, and knows the shapes of the kinds that it has met."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace = workspace
        self._meshes: dict[tuple[str, str], Mesh] = {}
        self._reading: Future[dict[tuple[str, str], Mesh]] | None = None

    def look(self, world: World, actor: Callable[[], Actor]) -> Generator[bool, None, View]:
        """A view of the world; yields WORKS between pieces of work, and WAITS while shapes are read in a thread."""
        records, poses, known = yield from self._indexed(world)
        while missing := known.keys() - self._meshes.keys():
            reading = self._reading or aside(lambda keys=tuple(missing): {key: self._read(key[0]) for key in keys})
            self._reading = reading
            while not reading.done():
                yield WAITS
            self._meshes |= reading.result()
            if self._reading is reading:
                self._reading = None
            records, poses, known = yield from self._indexed(world)
        meshes = [self._meshes[key] for key in known]
        which = np.zeros(len(records), int)
        for number, rows in enumerate(known.values()):
            which[rows] = number
        middles = np.array([mesh.middle for mesh in meshes]).reshape(-1, 3)[which]
        radii = np.array([_radius(mesh) for mesh in meshes])[which]
        yield WORKS
        centres = poses[:, :3] + rotate(poses[:, 3:], middles)
        yield WORKS
        eye, ahead = eyes(actor())
        names = {record.name: row for row, record in enumerate(records)}
        return View(eye, ahead, names, poses, centres, radii, [meshes[number] for number in which])

    def _indexed(
        self, world: World
    ) -> Generator[bool, None, tuple[list[ObjectRecord], Array, dict[tuple[str, str], list[int]]]]:
        """The records, their poses (n, 7), and by shape the rows of its objects."""
        poses = world.poses()[1].copy()
        records = list(world.objects.values())  # in the scene's order, as the poses are
        known: dict[tuple[str, str], list[int]] = {}
        for row, record in enumerate(records):
            known.setdefault((record.kind, record.shape), []).append(row)
            if row % _CHUNK == _CHUNK - 1:
                yield WORKS
        return records, poses, known

    def _read(self, kind: str) -> Mesh:
        """The shape of a kind; nothing where it has none, is broken, or is not known here."""
        try:
            shape = self._workspace.objects.shape(kind)
        except AhmssError:
            return _NOTHING
        return _NOTHING if shape is None else Mesh.of(triangles_of(shape.glb))


def _radius(mesh: Mesh) -> float:
    """Of the ball around a mesh's box, metres; -1 where there is nothing."""
    return -1.0 if mesh.half[0] < 0.0 else float(np.linalg.norm(mesh.half))
