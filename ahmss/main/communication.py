"""The communication part: the one human's line to the virtual-space server, and the world as it is seen from here."""

from __future__ import annotations

import contextlib
import re
from collections import ChainMap
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence

import msgspec
import numpy as np

from ahmss.algorithm import messages
from ahmss.body.array import Array
from ahmss.body.quaternion import normalize
from ahmss.body.skeleton import Skeleton
from ahmss.database.placement import Placed
from ahmss.database.shape import Shape
from ahmss.database.workspace import Workspace
from ahmss.errors import Unreachable, WorldError
from ahmss.main import people
from ahmss.main.body_parts import Body
from ahmss.main.command import Add
from ahmss.main.company import Everything, Humans, place_of
from ahmss.main.delivery import deliver
from ahmss.world.client import WorldClient
from ahmss.world.link import Pending
from ahmss.world.schema import (
    Claim,
    Hello,
    HumanRecord,
    ObjectRecord,
    Release,
    SetState,
    StateChange,
    StateValue,
    Transfer,
    Welcome,
)
from ahmss.world.view import World

__all__ = ["Communication"]

_PATIENCE = 60.0  # seconds that lockstep waits for an answer: the others may have to finish a frame
_AGAIN = 600  # frames after which the same refusal is told again
_NUMBER = re.compile(r"\d+")
_SEEN = 2  # frames after which the world shows a state that was set, or it was refused


class Communication:
    """Sends what main's human does and knows what the others do.

    A snapshot is some frames old when it comes; of what this human moved last its own word is newer and counts.
    """

    def __init__(self, client: WorldClient, human: str, *, lockstep: bool = False, fast: bool = False) -> None:
        self.client, self.human = client, human
        self.lockstep, self.fast = lockstep, fast
        self.frame = 0
        self._own: dict[str, tuple[int, Array]] = {}
        self._complained: dict[str, int] = {}
        self._lost: set[str] = set()
        self._said: dict[str, tuple[int, dict[str, StateValue]]] = {}
        self._skeletons: dict[str, Skeleton] = {}

    @property
    def objects(self) -> Mapping[str, ObjectRecord]:
        """The records of the world's objects, with the states that this human has changed last, and of its humans."""
        return Everything(self._things, Humans(self.world), self.world.called)

    @property
    def _things(self) -> Mapping[str, ObjectRecord]:
        records = self.world.objects
        if not self._said:
            return records
        changed = {
            name: msgspec.structs.replace(records[name], states={**records[name].states, **states})
            for name, (_, states) in self._said.items()
            if name in records
        }
        return ChainMap(changed, records)  # no copy: there may be very many

    @property
    def world(self) -> World:
        """The newest world."""
        return self.client.world

    def join(self, body: str, skeleton: Skeleton, shape: Shape, root: Array, rotations: Array, group: str) -> None:
        """Enter the world in a pose."""
        texture = shape.texture.data if shape.texture else b""
        self.client.join(
            self.human, body, root, rotations,
            skeleton=skeleton.to_record(), shape=shape.glb, texture=texture, group=group,
        )  # fmt: skip
        self.client.refresh()

    def update(self, *, complete: bool) -> World:
        """Take in what has come; in lockstep wait for the world: `complete` for all frames that were sent."""
        if self.lockstep:
            return self.client.collect(0 if complete else 1)
        world = self.client.poll()
        if self._own or self._said:
            self._forget()
        return world

    def publish(self, root: Array, rotations: Array, moved: Array | None, way: Array) -> None:
        """One world frame: the human, its way (6, 2), and what it moves, (m, 8) rows of id, place, rotation."""
        self.frame += 1
        self.client.publish(self.human, self.frame, root, rotations, moved, way)
        if self.lockstep and not self.fast:  # at the pace of the clock each frame is to be seen at once
            self.client.collect()

    def pose(self, name: str) -> Array:
        """Where an object is (7,): where this human put it last, or where the world has it; of a human on the floor."""
        own = self._own.get(name)
        if own:
            return own[1]
        return self.world.pose(name) if name in self.world.objects else place_of(self.world, name)

    def poses(self, names: Iterable[str]) -> Iterator[tuple[int, Skeleton, list[float]]]:
        """The world's number, skeleton and pose (175) of each of these humans that is there, and that no object hides.

        Raises:
            WorldError: the server has no such skeleton, or does not answer.
        """
        world = self.world
        rows = {number: row for row, number in enumerate(world.human_ids.tolist())}
        for name in names:
            record = world.humans.get(name)
            if record is not None and record.id in rows and name not in world.objects:
                yield record.id, self._skeleton(record), world.human_poses[rows[record.id]].tolist()

    def body(self, name: str) -> Body:
        """A human of the world, as it is shown now. Asks the server for its skeleton where it is met first.

        Raises:
            WorldError: the server has no such skeleton, or does not answer.
        """
        root, rotations = self.world.human(name)
        return Body(self._skeleton(self.world.humans[name]), normalize(rotations), root)

    def _skeleton(self, record: HumanRecord) -> Skeleton:
        if record.skeleton not in self._skeletons:
            self._skeletons[record.skeleton] = Skeleton.from_record(self.client.skeleton(record))
        return self._skeletons[record.skeleton]

    def others(self) -> list[messages.ObjectRecord]:
        """The other humans, as algorithms are told of them."""
        return people.records(self.world, self.human)

    def way(self, name: str) -> Array | None:
        """(6, 2) where a human means to be; None where they tell nothing of it, or are gone."""
        return self.world.way(name)

    def put(self, name: str, pose: Array) -> None:
        """This human has moved an object it holds, in the frame that is published next."""
        if not self.lockstep:  # there the world itself is as new as this
            self._own[name] = (self.frame + 1, pose)

    def held(self) -> frozenset[str] | None:
        """The objects that the server says this human has now; None where it can't be asked."""
        try:
            world = self.client.refresh()
        except WorldError:
            return None
        return frozenset(name for name, record in world.objects.items() if record.holder == self.human)

    @property
    def connected(self) -> bool:
        """Whether the server hears; it is called again and again until it does."""
        return self.client.connected

    def lose(self, name: str) -> None:
        """This human has the object no longer. Frames with it that are on their way are refused, which is no news."""
        self._lost.add(name)

    @property
    def refused(self) -> bool:
        """Whether the server has refused something since `complaints` was asked."""
        return bool(self.client.refusals)

    def complaints(self) -> list[str]:
        """What the server refused since the last time; what it says again and again comes once in `_AGAIN` frames."""
        said: list[str] = []
        known = tuple(f"it does not hold {name}" for name in self._lost)
        for reason in self.client.refusals:
            if reason.endswith(known):
                continue
            kind = _NUMBER.sub("", reason)
            if self.frame >= self._complained.get(kind, 0):
                self._complained[kind] = self.frame + _AGAIN
                said.append(reason)
        self.client.refusals.clear()
        return said

    @contextlib.contextmanager
    def errand(self) -> Generator[WorldClient]:
        """The connection for what waits for its answers: in real time one of its own, to be used in a thread."""
        if self.lockstep:
            yield self.client
            return
        with self.client.another() as client:
            yield client

    def free_name(self, add: Add) -> str:
        """The name that an object is to have: the one asked for, or its kind's with a number where that is taken."""
        name, number = add.name or add.kind, 2
        while not add.name and name in self.world.objects:
            name, number = f"{add.kind}_{number}", number + 1
        return name

    def add(self, add: Add, name: str, workspace: Workspace) -> tuple[Placed, ...]:
        """Add an object and all that it contains, with their shapes. May take seconds, in real time in a thread.

        Raises:
            AhmssError: a file is wrong, or the server refused; says why.
        """
        half = np.radians(add.facing_deg) / 2.0
        x, y, z = (float(v) for v in (*add.place, 0.0)[:3])
        rotation = (float(np.cos(half)), 0.0, 0.0, float(np.sin(half)))
        placed = workspace.objects.place(add.kind, name, (x, y, z), rotation)
        with self.errand() as client:
            deliver(client, placed, workspace, self.human)
            if self.lockstep:
                client.refresh()
        return placed

    def claim(self, name: str, hand: str) -> Pending:
        """Ask that only this human moves an object from now on."""
        self._lost.discard(name)
        pending = self.client.begin(Claim(self.human, [name], hand))
        if self.lockstep:  # the others' frames wait for this one: nothing is held up that does not wait anyway
            with contextlib.suppress(WorldError):  # `pending` keeps the reason
                self.client.finish(pending, _PATIENCE)
        return pending

    def wait_for(self, name: str) -> None:
        """Say that this human waits for an object that another has: it has it before those who come later."""
        self.client.begin(Claim(self.human, [name], waits=True))

    def transfer(self, name: str, taker: str, hand: str) -> Pending:
        """Give an object from this human's hand into another's; frames that come after this move it no more."""
        pending = self.client.begin(Transfer(name, self.human, taker, hand))
        if self.lockstep:
            with contextlib.suppress(WorldError):
                self.client.finish(pending, _PATIENCE)
        return pending

    def release(self, name: str) -> Pending:
        """Let an object go; it falls onto what is under it."""
        pending = self.client.begin(Release(self.human, [name]))
        if self.lockstep:  # how long it falls is known before the next frame
            with contextlib.suppress(WorldError):
                self.client.finish(pending, _PATIENCE)
        return pending

    def set_state(self, name: str, state: str, value: StateValue) -> Pending:
        """Set an object's state."""
        return self.set_states(name, {state: value})

    def set_states(self, name: str, values: Mapping[str, StateValue]) -> Pending:
        """Set states of an object in one step, so that what follows from one does not overrule another."""
        if not self.lockstep:
            _, states = self._said.get(name, (0, {}))
            self._said[name] = (self.frame + _SEEN, {**states, **values})
        return self.client.begin(SetState([StateChange(name, state, value) for state, value in values.items()]))

    def sync(self, line: str, names: Sequence[str]) -> Pending:
        """Come to a line of the script."""
        return self.client.sync(self.human, line, names)

    def news(self) -> Callable[[], bool]:
        """Whether the world as the server has it at the first call is still under way; in lockstep each tick brings it.

        What others have done before a `sync` is so seen by all after it.
        """
        asked: list[Pending] = []

        def missing() -> bool:
            if self.lockstep:
                return False
            if not asked:
                asked.append(self.client.begin(Hello()))
            if not asked[0].done:
                return True
            try:
                welcome = asked[0].result()
            except Unreachable:  # the connection broke before the answer: ask again
                asked.clear()
                return True
            assert isinstance(welcome, Welcome)
            return self.world.tick <= welcome.tick or not self.client.is_current

        return missing

    def leave(self, *, stay: bool) -> None:
        """Leave the world; with `stay` the body stays standing."""
        try:
            self.client.leave(self.human, stay=stay)
        except WorldError:  # a server that is gone has nobody to say goodbye to
            return

    def _forget(self) -> None:
        """Forget the own word on objects once the world shows the frame in which they were put there."""
        world = self.world
        if self.human not in world.humans:
            return
        row = np.flatnonzero(world.human_ids == world.humans[self.human].id)
        if len(row):
            shown = int(world.human_frames[row[0]])
            self._own = {name: own for name, own in self._own.items() if own[0] > shown}
            self._said = {name: said for name, said in self._said.items() if said[0] > shown}
