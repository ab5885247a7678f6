"""The objects of the world and the rules for them: who may move what, and what is carried along."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, normalize, rotate
from ahmss.errors import WorldError
from ahmss.states.behaviour import Behaviour
from ahmss.states.following import follow
from ahmss.world.behaviours import Behaviours
from ahmss.world.changes import Changes
from ahmss.world.falls import Falls
from ahmss.world.frame import faulty, is_faulty_row
from ahmss.world.nesting import in_world
from ahmss.world.poses import Table
from ahmss.world.queues import Queues
from ahmss.world.schema import NewObject, ObjectPose, ObjectRecord, StateChange, StateValue

__all__ = ["MOST_OBJECTS", "Thing", "Things", "check_name"]

MOST_OBJECTS = 100_000
_MOST_STATES = 64
_LONGEST_NAME = 200
_LONGEST_VALUE = 1000
_ELSEWHERE = 1e-6  # metres, and of a quaternion: what is said to be so near is where it was
_NAME = re.compile(r"[\w.+-]+(/[\w.+-]+)*")


@dataclass(slots=True)
class Thing:
    """One object; its pose is a row of the table."""

    id: int
    name: str
    kind: str
    parent: str
    shape: str
    texture: str
    movable: bool
    behaviour: str
    states: dict[str, StateValue]
    holder: str = ""
    hand: str = ""
    attached: bool = True
    moved: bool = False
    fell: bool = False
    keeper: str = ""
    children: list[str] = field(default_factory=list[str])


def check_name(name: str, what: str) -> None:
    """Refuse a name that a script could not say."""
    if len(name) > _LONGEST_NAME or not _NAME.fullmatch(name):
        raise WorldError(f'"{name[:40]}" is no name for {what}: use letters, digits, _ . + - and / between parts')


class Things:
    """All objects.

    What each method does is noted in `changes`, which the space replaces at each tick.

    Args:
        behaviours: how the kinds behave, by the hash that their objects name. falls: what falls now.

    Every method does all that it is asked or raises WorldError with the reason, having changed nothing.
    """

    def __init__(self, behaviours: Behaviours, falls: Falls) -> None:
        self.changes = Changes()
        self.behaviours, self.falls, self.queues = behaviours, falls, Queues()
        self.by_name: dict[str, Thing] = {}
        self.by_id: dict[int, Thing] = {}
        self.poses = Table(7)
        self.next_id = 1

    def get(self, name: str) -> Thing:
        """The object of that name."""
        thing = self.by_name.get(name)
        if thing is None:
            raise WorldError(f'no object "{name}" in the world')
        return thing

    def record(self, thing: Thing, pose: Array | None = None) -> ObjectRecord:
        """What others are told of it, at its pose now or at the one given."""
        x, y, z, *rotation = (self.poses[thing.id] if pose is None else pose).tolist()
        return ObjectRecord(
            thing.id, thing.name, thing.kind, (x, y, z), tuple(rotation), thing.parent, thing.shape, thing.texture,
            dict(thing.states), thing.holder, thing.hand, thing.movable, thing.attached, thing.moved, thing.behaviour,
            thing.keeper,
        )  # fmt: skip

    def add(self, objects: Sequence[NewObject]) -> list[Thing]:
        """Add objects, parents before what they contain."""
        if len(self.by_name) + len(objects) > MOST_OBJECTS:
            raise WorldError(f"the world takes {MOST_OBJECTS} objects; remove some first")
        earlier: set[str] = set()
        for new in objects:
            self._check(new, earlier)
            earlier.add(new.name)
        poses = in_world(objects, lambda name: self.poses[self.by_name[name].id])
        return [self._insert(new, pose) for new, pose in zip(objects, poses, strict=True)]

    def restore(self, record: ObjectRecord) -> None:
        """Put a record of the journal back, or over the one of the same id."""
        known = self.by_id.get(record.id)
        pose = np.array((*record.place, *record.rotation))
        if known is None:
            self.next_id = record.id
            known = self._insert(
                NewObject(record.name, record.kind, parent=record.parent, shape=record.shape, texture=record.texture,
                          movable=record.movable, behaviour=record.behaviour), pose,
            )  # fmt: skip
            self.next_id = max(self.by_id) + 1
        known.states, known.attached, known.moved = dict(record.states), record.attached, record.moved
        known.keeper = record.keeper
        self.poses[record.id][:] = pose

    def remove(self, owned: frozenset[str] | set[str], name: str) -> None:
        """Remove an object and what it carries; not what is loose, nor while somebody else holds a part."""
        thing = self.get(name)
        going = [thing, *self._carried(thing)]
        for part in going:
            if part.holder and part.holder not in owned:
                raise WorldError(f"{part.name} is held by {part.holder}; it can be removed when it is let go")
        if thing.parent in self.by_name:
            self.by_name[thing.parent].children.remove(name)
        names = {part.name for part in going}
        for part in going:
            for child in part.children:
                if child not in names:
                    self.by_name[child].parent = ""
                    self.changes.put[child] = None
            self.drop(part)

    def drop(self, thing: Thing) -> None:
        """Take one object out, whatever hangs on it."""
        self.poses.remove(thing.id)
        self.falls.cancel(thing)
        del self.by_name[thing.name], self.by_id[thing.id]
        self.changes.put.pop(thing.name, None)
        self.changes.moved.pop(thing.id, None)
        self.changes.gone.append(thing.id)
        self.changes.is_structural = True

    def move(self, owner: bytes, owned: set[str], poses: Sequence[ObjectPose], *, layout: bool) -> None:
        """Put objects elsewhere at once."""
        things = [self.get(pose.name) for pose in poses]
        rows = np.array([(*p.place, *p.rotation) for p in poses], float).reshape(-1, 7)
        bad = faulty(rows[:, :3], rows[:, None, 3:]) if len(rows) else np.zeros(0, bool)
        for thing, is_bad in zip(things, bad, strict=True):
            if thing.holder and thing.holder not in owned:
                raise WorldError(f"{thing.name} is held by {thing.holder}; it can be moved when it is let go")
            if layout and thing.moved:
                raise WorldError(f"{thing.name} was moved by somebody; it stays where it is")
            if is_bad:
                raise WorldError(f"{thing.name} can't be moved there: the place is not finite or the rotation not unit")
        self.place(owner, things, rows)
        for thing in things:
            thing.moved |= not layout
            self.falls.cancel(thing)
            self.rest(thing)

    def place(self, owner: bytes, things: Sequence[Thing], poses: Array) -> None:
        """Write poses (n, 7); what the objects carry goes along, but for what is written itself."""
        written = {thing.id for thing in things}
        moved, table = self.changes.moved, self.poses
        for thing, pose in zip(things, poses, strict=True):
            row = table[thing.id]
            thing.moved |= bool(thing.holder) and float(np.abs(pose - row).max()) > _ELSEWHERE
            if thing.children:
                self._carry(owner, thing, row, pose, written)
            row[:] = pose
            moved[thing.id] = owner

    def rest(self, thing: Thing) -> None:
        """It rests now: note it with all that it carries, for the journal."""
        self.changes.put[thing.name] = None
        for part in self._carried(thing):
            self.changes.put[part.name] = None

    # Claims

    def claim(self, human: str, names: Sequence[str], hand: str, *, waits: bool = False) -> None:
        """The human alone moves these from now on; or only waits for them. Who waits first has them first."""
        things = [self.get(name) for name in names]
        if waits:
            for thing in things:
                self.queues.wait(thing.name, human)
            return
        for thing in things:
            first = self.queues.first(thing.name)
            if not thing.holder and first not in ("", human):
                self.queues.wait(thing.name, human)
                raise WorldError(f"{thing.name} is waited for by {first}, who came first; wait until they let it go")
            if thing.holder not in ("", human):
                raise WorldError(f"{thing.name} is held by {thing.holder}; wait until it is let go")
            if not thing.movable:
                raise WorldError(f"{thing.name} can't be moved")
        if hand not in ("", "right", "left"):
            raise WorldError(f'"{hand}" is no hand: right or left')
        for thing in things:
            self.queues.leave(human, thing.name)
            self._hold(thing, human, hand)

    def release(self, human: str, names: Sequence[str]) -> None:
        """The human lets these go."""
        things = [self.get(name) for name in names]
        for thing in things:
            if thing.holder != human:
                raise WorldError(f"{human} does not hold {thing.name}")
        for thing in things:
            self._let_go(thing)

    def release_all(self, human: str) -> None:
        """The human is gone."""
        self.queues.leave(human)
        for thing in self.by_name.values():
            if thing.holder == human:
                self._let_go(thing)

    def transfer(self, name: str, giver: str, taker: str, hand: str) -> None:
        """From hand to hand."""
        thing = self.get(name)
        if thing.holder != giver:
            raise WorldError(f"{giver} does not hold {name}, so it can't be given")
        if hand not in ("", "right", "left"):
            raise WorldError(f'"{hand}" is no hand: right or left')
        self._hold(thing, taker, hand)

    def set_states(self, owned: set[str], changes: Sequence[StateChange]) -> None:
        """Set states of objects that nobody else holds, and what follows from that, whoever holds what it is about."""
        for change in changes:
            thing = self.get(change.object)
            if thing.holder and thing.holder not in owned:
                raise WorldError(f"{thing.name} is held by {thing.holder}; only its main sets {change.state}")
            if change.state not in thing.states:
                known = ", ".join(sorted(thing.states)) or "none"
                raise WorldError(f'{thing.name} has no state "{change.state}"; its states: {known}')
            if isinstance(change.value, str) and len(change.value) > _LONGEST_VALUE:
                raise WorldError(f"{thing.name}: {change.state} takes at most {_LONGEST_VALUE} characters")
        asked = [(change.object, change.state, change.value) for change in changes]
        for name, state, value in follow(asked, self._states_of, self._behaviour_of):
            self.by_name[name].states[state] = value
            self.changes.put[name] = None

    # How

    def _states_of(self, name: str) -> dict[str, StateValue] | None:
        thing = self.by_name.get(name)
        return None if thing is None else thing.states

    def _behaviour_of(self, name: str) -> Behaviour:
        return self.behaviours.get(self.by_name[name].behaviour)

    def _check(self, new: NewObject, earlier: set[str]) -> None:
        """Refuse a new object that can't be."""
        check_name(new.name, "an object")
        if new.name in self.by_name or new.name in earlier:
            raise WorldError(f"an object named {new.name} is in the world already; choose another name")
        if new.parent and new.parent not in self.by_name and new.parent not in earlier:
            raise WorldError(f'{new.name}: no object "{new.parent}" to contain it')
        if new.parent and not new.name.startswith(new.parent + "/"):
            raise WorldError(f"{new.name}: what {new.parent} contains is named {new.parent}/...")
        if is_faulty_row([0.0, *new.place, *new.rotation]):
            raise WorldError(f"{new.name}: its place is not finite, or its rotation no unit quaternion")
        longest = max((len(str(text)) for text in (*new.states, *new.states.values())), default=0)
        if len(new.states) > _MOST_STATES or longest > _LONGEST_VALUE or len(new.kind) > _LONGEST_NAME:
            raise WorldError(f"{new.name}: too big: at most {_MOST_STATES} states of {_LONGEST_VALUE} characters")

    def _insert(self, new: NewObject, pose: Array) -> Thing:
        thing = Thing(
            self.next_id, new.name, new.kind, new.parent, new.shape, new.texture, new.movable, new.behaviour,
            dict(new.states),
        )  # fmt: skip
        self.next_id += 1
        self.by_name[thing.name] = self.by_id[thing.id] = thing
        if thing.parent in self.by_name:
            self.by_name[thing.parent].children.append(thing.name)
        self.poses.add(thing.id, pose)
        self.changes.put[thing.name] = None
        self.changes.is_structural = True
        return thing

    def _hold(self, thing: Thing, human: str, hand: str) -> None:
        """A hand takes a thing off what contained it."""
        thing.holder, thing.hand, thing.fell = human, hand, False
        self.falls.cancel(thing)
        if hand:
            thing.attached = False
            thing.moved = True
        self.changes.put[thing.name] = None

    def _let_go(self, thing: Thing) -> None:
        thing.holder = thing.hand = ""
        self.rest(thing)
        self.let_fall(thing)

    def let_fall(self, thing: Thing) -> None:
        """It falls, if it was held in a hand and nothing is under it."""
        self.falls.begin(self, thing, self._carried(thing))

    def _carried(self, thing: Thing) -> Iterator[Thing]:
        """All that goes where the thing goes, parents first."""
        for name in thing.children:
            child = self.by_name[name]
            if child.attached:
                yield child
                yield from self._carried(child)

    def _carry(self, owner: bytes, thing: Thing, old: Array, new: Array, written: set[int]) -> None:
        """Turn and shift what the thing carries as the thing itself from `old` to `new` (7,)."""
        going = [part for part in self._carried(thing) if part.id not in written and part.holder in ("", thing.holder)]
        if not going:
            return
        rows = [self.poses.rows[part.id] for part in going]
        turn = multiply(new[3:], conjugate(old[3:]))
        poses = self.poses.data[rows]
        poses[:, :3] = rotate(turn, poses[:, :3] - old[:3]) + new[:3]
        poses[:, 3:] = normalize(multiply(turn, poses[:, 3:]))
        self.poses.data[rows] = poses
        for part in going:
            self.changes.moved[part.id] = owner
