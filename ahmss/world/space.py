"""The virtual space: humans, objects and assets, and what a client may do to them. No socket and no clock.

`carry_out` does what a request asks, or raises WorldError having changed nothing.
"""

from __future__ import annotations

import math
import secrets

import numpy as np

from ahmss.errors import WorldError
from ahmss.world import schema
from ahmss.world.assets import Assets
from ahmss.world.behaviours import Behaviours
from ahmss.world.changes import Changes
from ahmss.world.falls import Falls
from ahmss.world.keeping import check_keeper, hand_on, keep
from ahmss.world.people import FRAME_NUMBER, PERSON_WIDTH, WAY, People, Person
from ahmss.world.schema import POSE_WIDTH, ObjectChange, Reply, Request, Scene, Snapshot, Ticked
from ahmss.world.solids import Solids
from ahmss.world.things import Thing, Things

__all__ = ["Space"]

_MOST_CHANGES = 256
"""States and holders that a snapshot tells beside its scene; more make a new scene."""

_NOBODY = np.zeros((0, PERSON_WIDTH))


class Space:
    """The world's content and its rules.

    Attributes:
        revision: of the scene. `settle` makes a new one where what exists has changed. Where they begin is drawn: who
            was connected to a server that was killed does not take the next one's scene for the one that it has.
        changes: what changed since the last `take_changes`.
    """

    def __init__(self, assets: Assets, rate: float) -> None:
        self.assets, self.rate = assets, rate
        behaviours = Behaviours(assets)
        self.people, self.things = People(), Things(behaviours, Falls(Solids(assets, behaviours)))
        self.changes = Changes()
        self.people.changes = self.things.changes = self.changes
        self._first = self.revision = secrets.randbits(32)
        self._scene = Scene(self.revision, [], [], rate)
        self._structural = False
        self._moved: dict[int, None] = {}
        self._changed: dict[str, None] = {}

    @property
    def was_empty(self) -> bool:
        """Whether nothing has ever been here."""
        return self.revision == self._first

    # Requests

    def carry_out(self, owner: bytes, request: Request, now: float) -> Reply:
        """Do what one client asks."""
        number = request.request
        match request:
            case schema.Join():
                return self._join(owner, request)
            case schema.Add():
                names = {name for new in request.objects for name in (new.shape, new.texture, new.behaviour)}
                self._check_assets(*sorted(names))
                self.things.behaviours.check({new.behaviour for new in request.objects})
                within = {new.parent for new in request.objects} & self.things.by_name.keys()
                check_keeper(self.things, sorted(within), request.keeper)
                added = self.things.add(request.objects)
                keep(added, request.keeper)
                self._hand_on()
                return schema.Added(number, [self.things.record(thing) for thing in added])
            case schema.Leave(human=name):
                self._leave(self.people.owned(owner, name), now, stays=request.stay)
            case schema.Remove(name=name):
                check_keeper(self.things, [name], request.keeper)
                self.things.remove(self.owned(owner), name)
            case schema.Move():
                check_keeper(self.things, [pose.name for pose in request.poses], request.keeper)
                self.things.move(owner, self.owned(owner), request.poses, layout=request.layout)
            case schema.Claim(human=name):
                self.people.owned(owner, name)
                self.things.claim(name, request.objects, request.hand, waits=request.waits)
            case schema.Release(human=name):
                self.people.owned(owner, name)
                self.things.release(name, request.objects)
                return schema.Done(number, self.things.falls.ticks(self.rate))
            case schema.Transfer():
                self._transfer(owner, request)
            case schema.SetState():
                self.things.set_states(self.owned(owner), request.changes)
            case _:
                raise WorldError(f"{type(request).__name__} can't be carried out here")
        return schema.Done(number)

    def owned(self, owner: bytes) -> set[str]:
        """Names of the humans that the client moves."""
        return {name for name, person in self.people.by_name.items() if person.owner == owner}

    def abandon(self, owner: bytes, now: float, grace_s: float) -> list[str]:
        """The client is gone: its humans stay for the grace time, what they hold is free; their names."""
        names = sorted(self.owned(owner))
        for name in names:
            self.people.orphan(name, now, grace_s)
            self.things.release_all(name)
        self._hand_on()
        return names

    def expire(self, now: float, grace_s: float) -> list[str]:
        """Humans that nobody came back to leave; their names."""
        names = [
            name for name, person in self.people.by_name.items()
            if not person.owner and not person.stays and now - person.left_at > grace_s
        ]  # fmt: skip
        for name in names:
            self.people.remove(name)
        return names

    def _join(self, owner: bytes, join: schema.Join) -> Reply:
        self._check_assets(join.skeleton, join.shape, join.texture)
        person = self.people.join(owner, join)
        self._hand_on()
        lost: list[str] = []
        for held in join.holds:
            hand = join.hands.get(held.name, "")
            try:
                if self.things.get(held.name).fell:
                    raise WorldError(f"{held.name} fell when nobody held it")
                self.things.claim(join.name, [held.name], hand)
                self.things.move(owner, {join.name}, [held], layout=False)
            except WorldError:  # the reply says so
                lost.append(held.name)
        return schema.Joined(join.request, person.record.id, lost=lost)

    def _leave(self, person: Person, now: float, *, stays: bool) -> None:
        name = person.record.name
        self.things.release_all(name)
        if stays:
            self.people.orphan(name, now, math.inf)
        else:
            self.people.remove(name)
        self._hand_on()

    def _hand_on(self) -> None:
        """Whose main is gone has no file to follow any more."""
        hand_on(self.things, [name for name, person in self.people.by_name.items() if person.owner])

    def _transfer(self, owner: bytes, request: schema.Transfer) -> None:
        giver, taker = self.people.get(request.giver), self.people.get(request.taker)
        if giver.owner != owner:
            raise WorldError(f"only the main of {request.giver} can give {request.object} away")
        if giver is taker:
            raise WorldError(f"{request.giver} can't give {request.object} to itself; name another human")
        self.things.transfer(request.object, request.giver, request.taker, request.hand)

    def _check_assets(self, *names: str) -> None:
        for name in names:
            if name and not self.assets.has(name):
                raise WorldError(f"the server has no asset {name[:12]}; send it first")

    def advance(self) -> None:
        """A tick of what moves by itself."""
        self.things.falls.step(self.things, 1.0 / self.rate)
        self.things.queues.step(1.0 / self.rate)

    def let_fall(self) -> None:
        """What was held, or was falling, when the server was stopped, and nobody has come back for."""
        for thing in list(self.things.by_name.values()):
            self.things.let_fall(thing)

    # What others are told

    def take_changes(self) -> Changes:
        """What changed since the last call."""
        changes = self.changes
        self._note(changes)
        if changes.is_quiet and not changes.moved:
            return changes
        self.changes = Changes()
        self.people.changes = self.things.changes = self.changes
        return changes

    def settle(self) -> None:
        """Make a new scene where what exists has changed since the last, or much else has."""
        self._note(self.changes)
        if not self._structural and len(self._changed) <= _MOST_CHANGES:
            return
        self.revision += 1
        self._structural = False
        self._moved.clear()
        self._changed.clear()
        things, people = self.things, self.people
        self._scene = Scene(
            self.revision,
            [things.record(thing) for thing in things.by_name.values()],
            [person.record for person in people.by_name.values()],
            self.rate,
        )

    def scene(self) -> Scene:
        """The scene of the present revision."""
        return self._scene

    def snapshot(self, tick: int, time: float) -> Snapshot:
        """The world now; call `settle` before."""
        self._note(self.changes)
        people, things = self.people.poses, self.things
        used = people.used
        ids = places = b""
        if self._moved:
            ids = np.fromiter(self._moved, "<u4", len(self._moved)).tobytes()
            places = things.poses.data[[things.poses.rows[number] for number in self._moved]].tobytes()
        ways = used[:, WAY]
        is_told = not np.isnan(ways[:, 0]).all()
        return Snapshot(
            tick, time, self.revision, people.ids.tobytes(), used[:, FRAME_NUMBER].astype("<u4").tobytes(),
            used[:, :POSE_WIDTH].astype("<f4").tobytes(), ids, places,
            [_change(things.by_name[name]) for name in self._changed],
            ways=ways.astype("<f4").tobytes() if is_told else b"",
        )  # fmt: skip

    def ticked(self, tick: int, receiver: bytes, changes: Changes, frames: dict[int, bytes]) -> Ticked:
        """What others than the receiver changed; `frames` are the humans that moved and their owners."""
        if changes.is_quiet and all(owner == receiver for owner in (*frames.values(), *changes.moved.values())):
            return Ticked(tick, self.revision)
        people, things = self.people, self.things
        humans = [number for number, owner in frames.items() if owner != receiver]
        humans += [number for number in changes.ways_gone if number not in frames]
        moved = [number for number, owner in changes.moved.items() if owner != receiver]
        poses = people.poses.data[[people.poses.rows[number] for number in humans]] if humans else _NOBODY
        is_told = not np.isnan(poses[:, WAY.start]).all()
        moved_rows = [things.poses.rows[number] for number in moved]
        put = [things.record(things.by_name[name]) for name in changes.put]
        humans_put = [people.by_name[name].record for name in changes.humans_put]
        return Ticked(
            tick, self.revision,
            np.array(humans, "<u4").tobytes(), poses[:, :POSE_WIDTH].tobytes(),
            np.array(moved, "<u4").tobytes(), things.poses.data[moved_rows].tobytes() if moved else b"",
            put, changes.gone, humans_put, changes.humans_gone, ways=poses[:, WAY].tobytes() if is_told else b"",
        )  # fmt: skip

    def _note(self, changes: Changes) -> None:
        """Keep in mind what differs from the scene."""
        if changes.is_structural:
            self._structural, changes.is_structural = True, False
            for number in changes.gone:
                self._moved.pop(number, None)
        for name in changes.put:
            if name in self.things.by_name:
                self._changed[name] = None
        if changes.moved:
            self._moved.update(dict.fromkeys(changes.moved))


def _change(thing: Thing) -> ObjectChange:
    """What of it may differ from its record."""
    return ObjectChange(
        thing.id, dict(thing.states), thing.holder, thing.hand, thing.attached, thing.moved, thing.keeper
    )
