"""Playing a recording back into a server: its humans and objects live again, for any viewer to see."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, rotate
from ahmss.errors import DataError
from ahmss.main.pace import Pace
from ahmss.main.play import PlaySetup, running_server
from ahmss.world.client import WorldClient
from ahmss.world.keys import read_client
from ahmss.world.recording import Reader
from ahmss.world.schema import NewObject, ObjectRecord
from ahmss.world.view import World

__all__ = ["is_recording", "play_recording"]

_MAGIC = b"AHMSSREC"
_LONG_ENOUGH = 1.0  # seconds that the last frame stays, so that a viewer shows it


def is_recording(path: Path) -> bool:
    """Whether a file is a recording; False for anything else, also for what can't be read."""
    try:
        with path.open("rb") as file:
            return file.read(len(_MAGIC)) == _MAGIC
    except OSError:
        return False


def play_recording(path: Path, setup: PlaySetup, say: Callable[[str], None]) -> None:
    """Play a recording once, at its own rate (`fast`: as fast as it can).

    Raises:
        AhmssError: it can't be read, or the server refuses what is in it (a human of that name is there already).
    """
    with Reader(path) as reader:
        if not len(reader):
            raise DataError(path, "", "there is no frame in this recording")
        with running_server(PlaySetup(record=setup.record, server=setup.server), ()) as address:
            say(f"{path.name}: {len(reader)} frames, on the server at {address}")
            keys = read_client(setup.keys) if setup.keys else None
            with WorldClient(address, keys=keys, follow=False) as client:
                _Replay(reader, client).run(Pace(reader.rate, fast=setup.fast))


class _Replay:
    """Feeds one recording to one server. The first human moves all objects: the server lets only a holder do so."""

    def __init__(self, reader: Reader, client: WorldClient) -> None:
        self._reader, self._client = reader, client
        self._world = World()
        self._objects: dict[str, ObjectRecord] = {}
        self._ids: dict[str, int] = {}
        self._poses: dict[str, Array] = {}
        self._claimed: set[str] = set()
        self._humans: list[str] = []

    def run(self, pace: Pace) -> None:
        """Play all frames, then take all away again."""
        try:
            for tick in range(len(self._reader)):
                time.sleep(max(pace.left(), 0.0))
                pace.advance()
                self._reader.show(tick, self._world)
                self._show(tick + 1)
            time.sleep(_LONG_ENOUGH if pace.period else 0.0)
        finally:
            for human in self._humans:
                self._client.leave(human)

    def _show(self, frame: int) -> None:
        world = self._world
        self._join_new()
        if self._objects.keys() != world.objects.keys():
            self._meet_objects()
        self._set_states()
        moved = self._moved()
        for human in self._humans:
            root, rotations = world.human(human)
            self._client.publish(human, frame, root, rotations, moved if human == self._humans[0] else None)
        self._client.poll()

    def _join_new(self) -> None:
        for name, record in self._world.humans.items():
            if name in self._humans or record.id not in self._world.human_ids:
                continue
            root, rotations = self._world.human(name)
            texture = self._reader.asset(record.texture) if record.texture else b""
            shape = self._reader.asset(record.shape) if record.shape else b""
            skeleton = self._reader.skeleton(record)
            self._client.join(name, record.body, root, rotations, skeleton=skeleton, shape=shape, texture=texture)
            self._humans.append(name)

    def _meet_objects(self) -> None:
        """Add what is new in the recording and remove what has gone."""
        gone = [name for name in self._objects if name not in self._world.objects]
        for name in gone:
            if not any(name.startswith(f"{parent}/") for parent in gone):  # it goes with its parent
                self._client.remove(name)
            self._claimed.discard(name)
        new = [record for name, record in self._world.objects.items() if name not in self._objects]
        for asset in {asset for record in new for asset in (record.shape, record.texture) if asset}:
            self._client.put_asset(self._reader.asset(asset))
        if new:
            added = self._client.add([self._local(record) for record in new])
            self._ids.update({record.name: record.id for record in added})
        self._objects = dict(self._world.objects)
        self._poses = {name: self._world.pose(name).copy() for name in self._objects}

    def _local(self, record: ObjectRecord) -> NewObject:
        """An object as it is to be added: its pose in its parent's frame."""
        pose = self._world.pose(record.name)
        place, rotation = pose[:3], pose[3:]
        if record.parent:
            parent = self._world.pose(record.parent)
            back = conjugate(parent[3:])
            place, rotation = rotate(back, place - parent[:3]), multiply(back, rotation)
        x, y, z = place.tolist()
        return NewObject(
            record.name, record.kind, (x, y, z), tuple(rotation.tolist()), record.parent, record.shape, record.texture,
            dict(record.states), record.movable,
        )  # fmt: skip

    def _set_states(self) -> None:
        for name, record in self._world.objects.items():
            before = self._objects[name]
            if record.states != before.states:
                for state, value in record.states.items():
                    if before.states.get(state) != value:
                        self._client.set_state(name, state, value)
                self._objects[name] = record

    def _moved(self) -> Array | None:
        rows: list[Array] = []
        for name, before in self._poses.items():
            pose = self._world.pose(name)
            if (pose == before).all() or not self._humans:
                continue
            if name not in self._claimed:
                self._client.claim(self._humans[0], [name])
                self._claimed.add(name)
            self._poses[name] = pose.copy()
            rows.append(np.concatenate([[self._ids[name]], pose]))
        return np.array(rows) if rows else None
