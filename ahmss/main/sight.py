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
from ahmss.world.schema import ObjectRecord
from ahmss.world.view import World

__all__ = ["WAITS", "WORKS", "Sight", "View", "eyes"]

WORKS, WAITS = False, True
"""What who works in pieces yields: there is more to do at once, or only in a later frame."""

_WIDEST = np.cos(np.radians(60.0))
_NEAR = 0.03  # metres before a point within which a face belongs to it: a knob on a panel
_INNER = 0.7  # of the half box: where the eight points are
_CORNERS = np.array([[0, 0, 0], *([x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1))], float)
_NOTHING = np.zeros((0, 3, 3))
_NO_BOX = (np.zeros(3), np.full(3, -1.0))
_CHUNK = 256  # objects that are indexed in one go


def eyes(actor: Actor) -> tuple[Array, Array]:
    """The point between the eyes (3,), and the unit vector (3,) of the line of sight; in the world, metres."""
    places, world = forward(actor.rotations, actor.root, actor.skeleton.offsets)
    head = INDEX["head"]
    return line_of_sight(places[head], world[head], actor.skeleton.eye)


@dataclass(frozen=True)
class View:
    """One look at the world.

    eye, ahead (3,): of the human, its line of sight. rows: of each object's name. poses (n, 7), middles and halves of
    boxes (n, 3) in the objects' frames; a negative half is of what has no shape. centres (n, 3): the middles in the
    world. shapes: the triangles (t, 3, 3) of each in its own frame.
    """

    eye: Array
    ahead: Array
    rows: dict[str, int]
    poses: Array
    middles: Array
    halves: Array
    centres: Array
    shapes: Sequence[Array]

    def sees(self, name: str) -> bool:
        """Whether an object is seen; one that came since is not."""
        row = self.rows.get(name)
        if row is None:
            return False
        place, turn = self.poses[row, :3], self.poses[row, 3:]
        half = np.maximum(self.halves[row], 0.0)
        points = place + rotate(turn, self.middles[row] + _INNER * half * _CORNERS)
        away = points - self.eye
        lengths = np.maximum(np.linalg.norm(away, axis=1), 1e-9)
        before = away @ self.ahead >= _WIDEST * lengths
        return any(
            not self._hidden(row, away[i] / lengths[i], float(lengths[i]) - _NEAR) for i in np.flatnonzero(before)
        )

    def _hidden(self, row: int, way: Array, length: float) -> bool:
        """Whether a face is in the way from the eye, but of the object itself."""
        centres = self.centres - self.eye
        along = centres @ way
        off = np.linalg.norm(centres - along[:, None] * way, axis=1)
        radii = np.linalg.norm(self.halves, axis=1)
        near = (self.halves[:, 0] >= 0.0) & (off <= radii) & (along >= -radii) & (along <= length + radii)
        return any(other != row and self._hits(int(other), way, length) for other in np.flatnonzero(near))

    def _hits(self, other: int, way: Array, length: float) -> bool:
        """Whether the ray meets a triangle of an object (Moeller and Trumbore 1997)."""
        back = conjugate(self.poses[other, 3:])
        origin, ray = rotate(back, self.eye - self.poses[other, :3]), rotate(back, way)
        triangles = self.shapes[other]
        corner = triangles[:, 0]
        side, other_side = triangles[:, 1] - corner, triangles[:, 2] - corner
        p = np.cross(ray, other_side)
        det = np.einsum("ij,ij->i", side, p)
        flat = np.abs(det) < 1e-12
        inverse = 1.0 / np.where(flat, 1.0, det)
        t = origin - corner
        u = np.einsum("ij,ij->i", t, p) * inverse
        q = np.cross(t, side)
        v = (q @ ray) * inverse
        far = np.einsum("ij,ij->i", other_side, q) * inverse
        return bool((~flat & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (far > 1e-6) & (far < length)).any())


class Sight:
    """Makes views in small pieces of work, and knows the shapes of the kinds that it has met."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace = workspace
        self._shapes: dict[tuple[str, str], Array] = {}
        self._reading: Future[dict[tuple[str, str], Array]] | None = None

    def look(self, world: World, actor: Callable[[], Actor]) -> Generator[bool, None, View]:
        """A view of the world; yields WORKS between pieces of work, and WAITS while shapes are read in a thread."""
        while missing := {_shape_of(record) for record in world.objects.values()} - self._shapes.keys():
            reading = self._reading or aside(lambda keys=tuple(missing): {key: self._read(key[0]) for key in keys})
            self._reading = reading
            while not reading.done():
                yield WAITS
            self._shapes |= reading.result()
            if self._reading is reading:
                self._reading = None
        poses = world.poses()[1].copy()
        records = list(world.objects.values())  # in the scene's order, as the poses are
        boxes = {key: _box(triangles) for key, triangles in self._shapes.items()}
        sizes: list[tuple[Array, Array]] = []
        rows: dict[str, int] = {}
        for row, record in enumerate(records):
            sizes.append(boxes.get(_shape_of(record), _NO_BOX))
            rows[record.name] = row
            if row % _CHUNK == _CHUNK - 1:
                yield WORKS
        middles = np.array([middle for middle, _ in sizes]).reshape(-1, 3)
        halves = np.array([half for _, half in sizes]).reshape(-1, 3)
        centres = poses[:, :3] + rotate(poses[:, 3:], middles)
        shapes = [self._shapes.get(_shape_of(record), _NOTHING) for record in records]
        eye, ahead = eyes(actor())
        return View(eye, ahead, rows, poses, middles, halves, centres, shapes)

    def _read(self, kind: str) -> Array:
        """The triangles of a kind; none where it has no shape, is broken, or is not known here."""
        try:
            shape = self._workspace.objects.shape(kind)
        except AhmssError:
            return _NOTHING
        return _NOTHING if shape is None else triangles_of(shape.glb)


def _shape_of(record: ObjectRecord) -> tuple[str, str]:
    """What a record's shape is known by: its kind, and the hash of what the world shows of it."""
    return record.kind, record.shape


def _box(triangles: Array) -> tuple[Array, Array]:
    """Middle and half of the box around triangles; _NO_BOX where there are none."""
    if not len(triangles):
        return _NO_BOX
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    return 0.5 * (low + high), 0.5 * (high - low)
