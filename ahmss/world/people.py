"""The humans of the world: who moves each, and what becomes of one whose main is gone."""

from __future__ import annotations

import math
from dataclasses import dataclass

import msgspec
import numpy as np

from ahmss.body.array import Array
from ahmss.errors import WorldError
from ahmss.world.changes import Changes
from ahmss.world.frame import POSE_BYTES, faulty
from ahmss.world.poses import Table
from ahmss.world.schema import POSE_WIDTH, WAY_WIDTH, HumanRecord, Join
from ahmss.world.things import check_name

__all__ = ["FRAME_NUMBER", "MOST_HUMANS", "PERSON_WIDTH", "WAY", "People", "Person"]

MOST_HUMANS = 4096

PERSON_WIDTH = POSE_WIDTH + WAY_WIDTH + 1
"""Numbers kept of one human: the pose, the way (NaN: not known), the number of the frame shown."""

WAY = slice(POSE_WIDTH, POSE_WIDTH + WAY_WIDTH)
FRAME_NUMBER = PERSON_WIDTH - 1


@dataclass(slots=True)
class Person:
    """One human; its pose is a row of the table. `owner` is the client that moves it, empty when nobody does."""

    record: HumanRecord
    owner: bytes
    group: str
    frame: int = -1
    left_at: float = 0.0
    stays: bool = False


class People:
    """All humans. A row of `poses` is a pose, the human's `WAY`, and the `FRAME_NUMBER` shown."""

    def __init__(self) -> None:
        self.changes = Changes()
        self.by_name: dict[str, Person] = {}
        self.by_id: dict[int, Person] = {}
        self.poses = Table(PERSON_WIDTH)
        self._next_id = 1

    def get(self, name: str) -> Person:
        """The human of that name."""
        person = self.by_name.get(name)
        if person is None:
            raise WorldError(f'no human "{name}" in the world')
        return person

    def owned(self, owner: bytes, name: str) -> Person:
        """The human of that name, which the client must own."""
        person = self.get(name)
        if not person.owner:
            raise WorldError(f"{name} has lost its main; join again")
        if person.owner != owner:
            raise WorldError(f"{name} is moved by another main")
        return person

    def join(self, owner: bytes, join: Join) -> Person:
        """A human enters, or its main comes back to it."""
        pose = self._pose(join)
        known = self.by_name.get(join.name)
        if known is not None and known.owner not in (b"", owner):
            raise WorldError(f"a human named {join.name} is here already; choose another name")
        if known is None:
            check_name(join.name, "a human")
            if len(self.by_name) >= MOST_HUMANS:
                raise WorldError(f"the world takes {MOST_HUMANS} humans; one must leave first")
            return self._enter(owner, join, pose)
        number = known.record.id
        known.owner, known.group, known.frame, known.stays = owner, join.group, -1, False
        known.record = HumanRecord(number, join.name, join.body, join.skeleton, join.shape, join.texture)
        self.poses[number][:POSE_WIDTH] = pose
        self.forget_way(number)
        self.changes.humans_put[join.name] = None
        self.changes.is_structural = True
        return known

    def orphan(self, name: str, now: float, leaves_s: float) -> None:
        """Nobody moves a human any more: it leaves after so many seconds, or stays (infinite), and all are told so."""
        person = self.by_name[name]
        person.owner, person.left_at, person.stays = b"", now, leaves_s == math.inf
        person.record = msgspec.structs.replace(person.record, leaves_s=leaves_s)
        self.forget_way(person.record.id)
        self.changes.humans_put[name] = None
        self.changes.is_structural = True

    def remove(self, name: str) -> None:
        """Take a human out of the world."""
        person = self.by_name.pop(name)
        del self.by_id[person.record.id]
        self.poses.remove(person.record.id)
        self.changes.humans_put.pop(name, None)
        self.changes.ways_gone.pop(person.record.id, None)
        self.changes.humans_gone.append(person.record.id)
        self.changes.is_structural = True

    def forget_way(self, number: int) -> None:
        """Nobody tells any more where the human of that id means to be."""
        way = self.poses[number][WAY]
        if not np.isnan(way[0]):
            way[:] = np.nan
            self.changes.ways_gone[number] = None

    def _enter(self, owner: bytes, join: Join, pose: Array) -> Person:
        record = HumanRecord(self._next_id, join.name, join.body, join.skeleton, join.shape, join.texture)
        self._next_id += 1
        person = Person(record, owner, join.group)
        self.by_name[join.name] = self.by_id[record.id] = person
        self.poses.add(record.id, np.concatenate([pose, np.full(WAY_WIDTH, np.nan), [0.0]]))
        self.changes.humans_put[join.name] = None
        self.changes.is_structural = True
        return person

    def _pose(self, join: Join) -> Array:
        if len(join.pose) != POSE_BYTES:
            raise WorldError(f"{join.name}: a pose is {POSE_BYTES} bytes, not {len(join.pose)}")
        pose = np.frombuffer(join.pose, "<f8")
        if faulty(pose[None, :3], pose[None, 3:].reshape(1, -1, 4))[0]:
            raise WorldError(f"{join.name}: its pose is not finite, too far away, or has rotations that are not unit")
        return pose
