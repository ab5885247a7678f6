"""The newest world as one client sees it: a scene, what a snapshot or a tick says is different, by name and by id."""

from __future__ import annotations

import msgspec
import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.world.schema import (
    POSE_WIDTH,
    WAY_SHAPE,
    HumanRecord,
    ObjectChange,
    ObjectRecord,
    Scene,
    Snapshot,
    Ticked,
)

__all__ = ["World"]

_UNKNOWN: Array = np.broadcast_to(np.nan, (1 << 20, *WAY_SHAPE))  # one number in memory
_NO_IDS: NDArray[np.uint32] = np.zeros(0, np.uint32)


class World:
    """What is where, held by whom, in which state.

    Attributes:
        revision: of the scene that it is built on; -1 before the first.
        tick, time, sequence: of the newest snapshot; time in seconds since 1970 at the server.
        objects: records by name, states and holder as they are now; the pose in it is the scene's: ask `pose`.
        humans: records by name.
        human_ids: (n,) the humans that have a pose, in the order of `human_poses` (n, 175), `human_frames` (n,) and
            `human_ways` (n, 6, 2), where each means to be (`ahmss.motion.way`), NaN where it is not told.
    """

    def __init__(self) -> None:
        self.revision = -1
        self.rate = 60.0
        self.tick = 0
        self.time = 0.0
        self.sequence = 0
        self.objects: dict[str, ObjectRecord] = {}
        self.humans: dict[str, HumanRecord] = {}
        self.human_ids = _NO_IDS
        self.human_frames = _NO_IDS
        self.human_poses: NDArray[np.float32] | Array = np.zeros((0, POSE_WIDTH), np.float32)
        self.human_ways: NDArray[np.float32] | Array = _ways(0)
        self._scene: list[ObjectRecord] = []
        self._names: dict[int, str] = {}
        self._ids: NDArray[np.uint32] = _NO_IDS
        self._order: NDArray[np.intp] = np.zeros(0, np.intp)
        self._base: Array = np.zeros((0, 7))
        self._poses: Array = self._base
        self._rows: dict[str, int] = {}
        self._changed: tuple[str, ...] = ()
        self._changes: list[ObjectChange] = []
        self._last: dict[str, list[str]] | None = None

    # What a reader asks

    @property
    def changed(self) -> tuple[str, ...]:
        """Names of the objects whose states or holder a snapshot says other than the scene."""
        return self._changed

    def pose(self, name: str) -> Array:
        """(7,) place and rotation of the object in the world, now. KeyError: no such object."""
        return self._poses[self._rows[name]]

    def poses(self) -> tuple[NDArray[np.uint32], Array]:
        """Ids (n,) and poses (n, 7) of all objects, in the scene's order."""
        return self._ids, self._poses

    def object_by_id(self, number: int) -> ObjectRecord:
        """The object with that id. KeyError: no such object."""
        return self.objects[self._names[number]]

    def human(self, name: str) -> tuple[Array, Array]:
        """Root (3,) and rotations (43, 4) of a human. KeyError: no such human, or it has no pose yet."""
        row = np.flatnonzero(self.human_ids == self.humans[name].id)
        if not len(row):
            raise KeyError(name)
        pose = self.human_poses[row[0]].astype(np.float64)
        return pose[:3], pose[3:].reshape(-1, 4)

    def way(self, name: str) -> Array | None:
        """(6, 2) where a human means to be, `ahmss.motion.way`; None where it is not told, or nobody is called so."""
        record = self.humans.get(name)
        row = np.flatnonzero(self.human_ids == (0 if record is None else record.id))
        way = self.human_ways[row[0]].astype(np.float64) if len(row) else None
        return None if way is None or np.isnan(way[0, 0]) else way

    def held_by(self, human: str) -> list[str]:
        """Names of the objects that the human holds."""
        return [name for name, record in self.objects.items() if record.holder == human]

    def called(self, last: str) -> list[str]:
        """Names of the objects that are parts of others and whose last part is this: `room/cup` for `cup`.

        An index, made when it is first asked for: a name is found as fast among 10,000 objects as among ten.
        """
        if self._last is None:
            found: dict[str, list[str]] = {}
            for name in list(self._rows):
                if "/" in name:
                    found.setdefault(name.rsplit("/", 1)[-1], []).append(name)
            self._last = found
        return list(self._last.get(last, ()))

    # What the client tells it

    def load(self, scene: Scene) -> None:
        """Build on a scene."""
        self.revision = scene.revision
        self.rate = scene.rate
        self.humans = {record.name: record for record in scene.humans}
        self._index(scene.objects)

    def show(self, snapshot: Snapshot) -> bool:
        """Show a snapshot; False where it is of another revision: then humans are shown, objects stay as they were."""
        self.tick, self.time, self.sequence = snapshot.tick, snapshot.time, snapshot.sequence
        self.human_ids = np.frombuffer(snapshot.human_ids, "<u4")
        self.human_frames = np.frombuffer(snapshot.frames, "<u4")
        self.human_poses = np.frombuffer(snapshot.poses, "<f4").reshape(-1, POSE_WIDTH)
        self.human_ways = _ways(len(self.human_ids), snapshot.ways, "<f4")
        if snapshot.revision != self.revision:
            return False
        self._poses = self._base
        if snapshot.object_ids:
            self._poses = self._base.copy()
            places = np.frombuffer(snapshot.places, "<f8").reshape(-1, 7)
            self._poses[self._rows_of(np.frombuffer(snapshot.object_ids, "<u4"))] = places
        if snapshot.changes != self._changes:
            self._change(snapshot.changes)
        return True

    def apply(self, ticked: Ticked) -> None:
        """Lockstep: add to the view what others changed in one tick."""
        self.tick = ticked.tick
        self.revision = ticked.revision
        if ticked.humans_put or ticked.humans_gone:
            kept = {r.name: r for r in self.humans.values() if r.id not in ticked.humans_gone}
            self.humans = kept | {r.name: r for r in ticked.humans_put}
            self._drop_poses(ticked.humans_gone)
        if ticked.human_ids:
            self._merge_humans(ticked)
        if ticked.put or ticked.gone:
            self._put_objects(ticked)
        if ticked.object_ids:
            places = np.frombuffer(ticked.places, "<f8").reshape(-1, 7)
            self._poses[self._rows_of(np.frombuffer(ticked.object_ids, "<u4"))] = places

    def place_own(self, numbers: NDArray[np.float64], poses: Array) -> None:
        """Lockstep: the receiver's own objects, which `Ticked` leaves out."""
        self._poses[self._rows_of(numbers.astype(np.uint32))] = poses

    # How

    def _index(self, records: list[ObjectRecord]) -> None:
        self._scene, self._last, self._changed, self._changes = records, None, (), []
        self.objects = {record.name: record for record in records}
        self._names = {record.id: record.name for record in records}
        self._rows = {record.name: row for row, record in enumerate(records)}
        self._ids = np.array([record.id for record in records], np.uint32)
        self._order = np.argsort(self._ids)
        self._base = np.array([(*r.place, *r.rotation) for r in records], float).reshape(-1, 7)
        self._poses = self._base

    def _rows_of(self, numbers: NDArray[np.uint32]) -> NDArray[np.intp]:
        return self._order[np.searchsorted(self._ids, numbers, sorter=self._order)]

    def _change(self, told: list[ObjectChange]) -> None:
        """States and holders: back to the scene's where the last snapshot had changed them, then this one's."""
        self._changes = told
        for name in self._changed:
            self.objects[name] = self._scene[self._rows[name]]
        changes = [change for change in told if change.id in self._names]
        for change in changes:
            name = self._names[change.id]
            self.objects[name] = msgspec.structs.replace(
                self._scene[self._rows[name]], states=change.states, holder=change.holder, hand=change.hand,
                attached=change.attached, moved=change.moved, keeper=change.keeper,
            )  # fmt: skip
        self._changed = tuple(self._names[change.id] for change in changes)

    def _merge_humans(self, ticked: Ticked) -> None:
        numbers = np.frombuffer(ticked.human_ids, "<u4")
        poses = np.frombuffer(ticked.poses, "<f8").reshape(-1, POSE_WIDTH)
        ways = _ways(len(numbers), ticked.ways, "<f8")
        if np.array_equal(numbers, self.human_ids):
            self.human_poses, self.human_ways = poses, ways
        else:
            kept = ~np.isin(self.human_ids, numbers)
            self.human_poses = np.concatenate([self.human_poses[kept].astype(np.float64), poses])
            self.human_ways = np.concatenate([self.human_ways[kept].astype(np.float64), ways])
            self.human_ids = np.concatenate([self.human_ids[kept], numbers])
        self.human_frames = np.full(len(self.human_ids), ticked.tick, np.uint32)

    def _drop_poses(self, gone: list[int]) -> None:
        kept = ~np.isin(self.human_ids, gone)
        self.human_ids, self.human_poses = self.human_ids[kept], self.human_poses[kept]
        self.human_frames, self.human_ways = self.human_frames[kept], self.human_ways[kept]

    def _put_objects(self, ticked: Ticked) -> None:
        """Records that changed keep their present pose unless they are new."""
        if not ticked.gone and all(record.name in self.objects for record in ticked.put):
            for record in ticked.put:
                self.objects[record.name] = record
            return
        poses = {name: self._poses[row].copy() for name, row in self._rows.items()}
        gone = set(ticked.gone)
        known = {r.name: r for r in self.objects.values() if r.id not in gone}
        new = {r.name for r in ticked.put if r.name not in known}
        self._index(list((known | {r.name: r for r in ticked.put}).values()))
        for name, row in self._rows.items():
            if name not in new:
                self._base[row] = poses[name]


def _ways(count: int, numbers: bytes = b"", kind: str = "<f8") -> Array:
    """The ways (count, 6, 2) in a message; NaN, without an array of their own, where it tells none."""
    return np.frombuffer(numbers, kind).reshape(count, *WAY_SHAPE) if numbers else _UNKNOWN[:count]
