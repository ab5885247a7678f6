"""A recording played into a server, so that viewers see it as they saw the run."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import msgspec
import numpy as np

from ahmss.states.behaviour import decode_behaviour
from ahmss.world import schema
from ahmss.world.client import WorldClient
from ahmss.world.keys import ClientKeys
from ahmss.world.recording import Reader
from ahmss.world.schema import HumanRecord, NewObject, ObjectPose, ObjectRecord
from ahmss.world.view import World

__all__ = ["replay"]

_LAST_STAYS = 1.0  # seconds


def replay(
    path: Path | str,
    address: str,
    *,
    speed: float = 1.0,
    keys: ClientKeys | None = None,
    stop: Callable[[], bool] = lambda: False,
) -> None:
    """Play a recording into a server, from its first tick to its last; what it added leaves the world again.

    Args:
        path: of the recording.
        address: of a server in real time that has no human or object of the same names.
        speed: 1 is the rate of the recording; 0 as fast as the server takes it.
        stop: asked at each tick; true ends it.

    Raises:
        DataError: no recording. WorldError: the server refuses (a name is taken), or is not there.
    """
    with Reader(path) as reader, WorldClient(address, keys=keys) as client:
        player = _Player(reader, client)
        world = World()
        begin = time.monotonic()
        try:
            for tick in range(len(reader)):
                if stop():
                    return
                player.show(reader.show(tick, world), tick)
                client.poll()
                if speed > 0:
                    time.sleep(max(0.0, begin + (tick + 1) / (reader.rate * speed) - time.monotonic()))
            time.sleep(_LAST_STAYS if speed > 0 else 0.1)  # the last tick is seen before all leaves
        finally:
            player.clear()


class _Player:
    """Makes the server's world that of the recording, tick by tick."""

    def __init__(self, reader: Reader, client: WorldClient) -> None:
        self._reader, self._client = reader, client
        self._revision = -1
        self._humans: dict[str, HumanRecord] = {}
        self._objects: dict[str, ObjectRecord] = {}
        self._poses: dict[str, bytes] = {}

    def show(self, world: World, tick: int) -> None:
        """Bring the server from the last tick to this one."""
        if world.revision != self._revision:
            self._revision = world.revision
            self._meet(world)
        moved: list[ObjectPose] = []
        for name, record in world.objects.items():
            self._follow(name, record)
            pose = world.pose(name)
            if self._poses.get(name) != pose.tobytes():
                self._poses[name] = pose.tobytes()
                x, y, z, *rotation = pose.tolist()
                moved.append(ObjectPose(name, (x, y, z), tuple(rotation)))
        if moved:
            self._client.begin(schema.Move(moved))
        for name in self._humans:
            root, rotations = world.human(name)
            rotations /= np.linalg.norm(rotations, axis=1, keepdims=True)
            self._client.publish(name, tick + 1, root, rotations, way=world.way(name))

    def clear(self) -> None:
        """Take out of the world what was put in."""
        for name in list(self._humans):
            self._client.leave(name)
        for name in [name for name in self._objects if "/" not in name]:
            self._client.remove(name)

    def _meet(self, world: World) -> None:
        """Who and what is new comes, who and what is gone goes."""
        for name in [name for name in self._humans if name not in world.humans]:
            self._client.leave(name)
            del self._humans[name]
        for name in [name for name in self._objects if name not in world.objects]:
            if self._objects[name].parent not in self._objects or self._objects[name].parent in world.objects:
                self._client.remove(name)
        self._objects = {name: record for name, record in self._objects.items() if name in world.objects}
        for name, record in world.humans.items():
            if name not in self._humans:
                root, rotations = world.human(name)
                self._client.join(
                    name, record.body, root, rotations, skeleton=self._reader.skeleton(record),
                    shape=self._asset(record.shape), texture=self._asset(record.texture),
                )  # fmt: skip
                self._humans[name] = record
        self._add([record for name, record in world.objects.items() if name not in self._objects])

    def _add(self, records: list[ObjectRecord]) -> None:
        """New objects; their poses follow, in the world's frame, with the first move."""
        news: list[NewObject] = []
        for record in sorted(records, key=lambda record: record.name.count("/")):
            for name in (record.shape, record.texture):
                self._client.put_asset(self._asset(name))
            news.append(NewObject(
                record.name, record.kind, parent=record.parent, shape=record.shape, texture=record.texture,
                states=record.states, movable=record.movable, behaviour=self._shown(record.behaviour),
            ))  # fmt: skip
            self._objects[record.name] = _free(record)
        if news:
            self._client.add(news)

    def _follow(self, name: str, record: ObjectRecord) -> None:
        """Holder and states as the recording has them."""
        before = self._objects[name]
        if before.holder != record.holder:
            if before.holder in self._humans:
                self._client.begin(schema.Release(before.holder, [name]))
            if record.holder in self._humans:
                self._client.begin(schema.Claim(record.holder, [name], record.hand))
        if before.states != record.states:
            changed = [
                schema.StateChange(name, state, value)
                for state, value in record.states.items() if before.states.get(state) != value
            ]  # fmt: skip
            self._client.begin(schema.SetState(changed))
        self._objects[name] = record

    def _shown(self, name: str) -> str:
        """The behaviour of that hash without what it does: what followed and what fell is in the recording itself."""
        if not name:
            return ""
        behaviour = decode_behaviour(self._reader.asset(name))
        return self._client.put_asset(msgspec.structs.replace(behaviour, consequences=(), falls=False).encode())

    def _asset(self, name: str) -> bytes:
        return self._reader.asset(name) if name else b""


def _free(record: ObjectRecord) -> ObjectRecord:
    """As it is just after it was added: held by nobody."""
    return msgspec.structs.replace(record, holder="", hand="")
