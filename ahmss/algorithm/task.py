"""What an author's function gets: the task, and at each frame where the human and the objects are."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np
from msgspec import UNSET

from ahmss.algorithm import cache
from ahmss.algorithm.messages import FRAME_HUMAN, FRAME_OBJECT, MOVED, WAY, Start, size
from ahmss.algorithm.place import Transform, WorldObject
from ahmss.algorithm.pose import HumanPose, ObjectPose, block, importance_of, target_rows
from ahmss.body.array import Array
from ahmss.body.fingertip import pad
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.body.skeleton import Skeleton
from ahmss.errors import ProtocolError
from ahmss.motion.clip import Clip
from ahmss.motion.way import known
from ahmss.walking.library import Library

__all__ = ["HumanFrame", "HumanTask", "ObjectTask", "Progress", "Rested", "Task"]

_HUMAN, _MOVED = size(FRAME_HUMAN), size(MOVED)
_ALONG = np.array([1.0, 0.0, 0.0])
Value = TypeVar("Value", bool, int, float, str)


class Rested(Exception):
    """A motion that was to come to rest has done so: it ends here, and nothing is wrong."""


@dataclass
class Progress:
    """How far a motion is, whatever copies of its task there are.

    rests: it is to come to rest now, and to end. arrived: it is where it acts. closed: the hand has closed.
    """

    rests: bool = False
    arrived: bool = False
    closed: bool = False


class HumanFrame:
    """The human at one frame: `root` (3,), `rotations` (43, 4), `right_grip` and `left_grip` (palms in the world)."""

    def __init__(self, row: Array) -> None:
        """From the first 190 numbers of a FRAME; holds views of them."""
        self.row = row
        self.root = row[1:4]
        self.rotations = row[4:176].reshape(43, 4)

    @property
    def k(self) -> int:
        """The frame, 1 for the first; 0 is where the human was at the start."""
        return int(self.row[0])

    @property
    def right_grip(self) -> Transform:
        """The right palm's frame in the world."""
        return Transform.of(self.row[176:183])

    @property
    def left_grip(self) -> Transform:
        """The left palm's frame in the world."""
        return Transform.of(self.row[183:190])

    def grip(self, hand: str) -> Transform:
        """The palm's frame of the `"right"` or `"left"` hand."""
        return self.left_grip if hand == "left" else self.right_grip


class Task:
    """What every algorithm is told. Arrays are metres, radians and unit quaternions wxyz.

    length: N, the frames asked for; 0: as many as the motion needs. Where the action's own frames are 0, N is a wish.
    rate: frames a second. hand: "right", "left" or "". hold: what the action does to the object. random: numpy's
    generator, seeded by main. object: the target, or None. world: the other objects that algorithm.toml asked for, by
    id. notes: what `note` was told. start: the human at frame 0; present: at the frame being computed.
    progress: how far the motion is.
    """

    def __init__(self, start: Start) -> None:
        self.message = start
        self.length = start.frames
        self.rate = start.rate
        self.hand = start.hand
        self.hold = start.hold
        self.parameters: Mapping[str, Any] = start.parameters
        self.directory = Path(start.directory)
        self.object = WorldObject.of(start.object) if start.object is not None else None
        self.notes: list[str] = []
        self.progress = Progress()
        self.world = {record.id: WorldObject.of(record) for record in start.world}
        about = [thing for thing in (self.goal_object, self.object) if thing is not None]
        self._about = {thing.id: thing for thing in about}
        told = [*about, *(thing for thing in self.world.values() if thing.kind == "human")]
        self._sites = {site.id: thing for thing in told for site in thing.sites.values() if site.id}

    @property
    def rests(self) -> bool:
        """Whether the motion is to come to rest now and end, where its algorithm.toml says that it can."""
        return self.progress.rests

    def arrived(self) -> None:
        """Say that one is where one acts: now what it moves is claimed, where algorithm.toml says `arrives = true`.

        Raises:
            Rested: one was to come to rest meanwhile; not to be caught.
        """
        self.refuse_rest()
        self.progress.arrived = True

    def refuse_rest(self) -> None:
        """End the motion here where it was to come to rest: one stands.

        Raises:
            Rested: it was; not to be caught.
        """
        if self.progress.rests:
            raise Rested

    @property
    def busy(self) -> tuple[str, ...]:
        """The hands, of `"right"` and `"left"`, that hold something."""
        return () if self.message.busy is UNSET else tuple(self.message.busy)

    @property
    def between(self) -> bool:
        """Whether both hands hold one thing between them."""
        held = {} if self.message.held is UNSET else self.message.held
        return len(held) == 2 and len(set(held.values())) == 1

    def in_hand(self, side: str) -> WorldObject | None:
        """What the `"right"` or `"left"` hand holds; None where it is neither the object nor in the world asked for."""
        number = None if self.message.held is UNSET else self.message.held.get(side)
        return None if number is None else self._about.get(number) or self.world.get(number)

    @property
    def carried(self) -> bool:
        """Whether another motion carries the body: what this one says of hips, legs and root does not count."""
        return bool(self.message.carried)

    @cached_property
    def human(self) -> Skeleton:
        """The acting human's skeleton."""
        return Skeleton.from_record(self.message.human)

    def fingerpad(self, hand: str, into: Array, finger: str = "index") -> Array:
        """Where (3,) a finger of the `"right"` or `"left"` hand touches what it pushes along (3,), unit."""
        link = INDEX[f"{hand}_{finger}_distal"]
        places, world = forward(self.present.rotations, self.present.root, self.human.offsets)
        tip = places[link] + rotate(world[link], self.human.tips[link])
        return pad(tip, rotate(world[link], _ALONG), float(self.human.radii[link]), into)

    @cached_property
    def random(self) -> np.random.Generator:
        """What is random comes from here, so that one seed gives one motion."""
        return np.random.default_rng(self.message.seed)

    @cached_property
    def start(self) -> HumanFrame:
        """The human at frame 0: as FRAME 1 finds it, or before that as START does."""
        return HumanFrame(self._begin())

    @cached_property
    def present(self) -> HumanFrame:
        """The human at the frame being computed (for a human algorithm: before it)."""
        return HumanFrame(self.start.row.copy())

    def _begin(self) -> Array:
        """The 190 numbers of frame 0, of START's pose, the palms by kinematics."""
        row = np.zeros(_HUMAN)
        row[1:4] = self.message.pose.root
        row[4:176] = np.reshape(self.message.pose.rotations, 172)
        places, world = forward(row[4:176].reshape(43, 4), row[1:4], self.human.offsets)
        for i, name in enumerate(("right_hand", "left_hand")):
            hand = Transform(places[INDEX[name]], world[INDEX[name]])
            row[176 + 7 * i : 183 + 7 * i] = hand.then(Transform.of(self.human.grips[i])).row()
        return row

    @cached_property
    def site(self) -> Transform | None:
        """The action's site in the world at the start, its free axis turned away from the human; None without one."""
        if self.object is None or not self.message.site:
            return None
        return self.object.site(self.message.site, np.array(self.message.pose.root))

    @cached_property
    def motion(self) -> Clip | None:
        """The action's motion clip, read when first asked for; None where the action names none."""
        return cache.clip(self.message.motion) if self.message.motion else None

    @cached_property
    def library(self) -> Library | None:
        """The action's walk library, where that is what it names as its motion; else None."""
        return cache.library(self.message.motion) if self.message.motion else None

    def resampled(self, frames: int) -> Clip | None:
        """The action's motion clip in so many frames; None where the action names none."""
        return cache.resampled(self.message.motion, frames) if self.message.motion else None

    @cached_property
    def posture(self) -> Clip | None:
        """The clip whose last frame is the posture to reach, or None."""
        return cache.clip(self.message.goal.posture) if self.message.goal.posture else None

    @cached_property
    def goal_place(self) -> Array | None:
        """The place (3,) to reach, or None; of a goal object its place, where no other was given."""
        goal = self.message.goal
        place = goal.place or (goal.object.place if goal.object is not None else None)
        return None if place is None else np.array(place)

    @cached_property
    def goal_rotation(self) -> Array | None:
        """The rotation (4,) to reach, or None."""
        return None if self.message.goal.rotation is None else np.array(self.message.goal.rotation)

    @property
    def goal_facing(self) -> float | None:
        """The heading to reach, radians about z, or None."""
        return self.message.goal.facing

    @cached_property
    def goal_object(self) -> WorldObject | None:
        """The object named as the goal, or None."""
        return WorldObject.of(self.message.goal.object) if self.message.goal.object is not None else None

    def parameter(self, name: str, default: Value) -> Value:
        """A parameter, of the default's type; the default where it is missing.

        Raises:
            TypeError: it has another type.
        """
        value = self.parameters.get(name, default)
        if isinstance(default, float) and isinstance(value, int) and not isinstance(value, bool):
            value = float(value)
        if type(value) is not type(default):
            raise TypeError(f"parameter {name} = {value!r} is no {type(default).__name__}")
        return cast(Value, value)

    def note(self, text: str) -> None:
        """Tell the person something in one line that is no failure; the same again is not told again."""
        self.notes.append(" ".join(text.split()))

    def see(self, row: Array) -> None:
        """Take in the numbers of a FRAME: the human, and whatever moved. Called by the runtime.

        Raises:
            ProtocolError: a FRAME of the wrong length.
        """
        own = self.frame_size
        if len(row) != own:
            for moved in self._rows(row):
                self._move(row[0], int(moved[0]), moved)
        if "present" in self.__dict__:
            self.present.row[:] = row[:_HUMAN]
            return
        self.present = HumanFrame(row[:_HUMAN].copy())
        if "start" not in self.__dict__:
            self.start = HumanFrame(row[:_HUMAN].copy())
            self.start.row[0] = 0.0

    frame_size = _HUMAN

    def _rows(self, row: Array) -> Iterator[Array]:
        """What a FRAME says of each that moved: (8,), of a human with its way (20,) where ways were asked for."""
        human, at = _MOVED + size(WAY) if self.message.ways else _MOVED, self.frame_size
        while at < len(row):
            end = at + (human if row[at] < 0.0 else _MOVED)
            if end > len(row):
                break
            yield row[at:end]
            at = end
        if at != len(row):
            more = f", {human} for each human," if human != _MOVED else ""
            raise ProtocolError(
                f"FRAME has {len(row)} numbers; {self.frame_size} and {_MOVED} for each that moved{more} are expected"
            )

    def _move(self, k: float, number: int, row: Array) -> None:
        """An object is elsewhere now, at frame k; one that is not known is not missed, a human who has come is."""
        place, rotation = row[1:4], row[4:8]
        if number in self._sites:
            self._sites[number].moved[number] = Transform(place.copy(), rotation.copy())
            return
        targets = [about[number] for about in (self._about, self.world) if number in about]
        if not targets and number < 0:
            targets = [WorldObject(number, "", "human", place.copy(), rotation.copy())]
            self.world[number] = targets[0]
        for target in targets:
            target.place[:] = place
            target.rotation[:] = rotation
            if target.kind == "human":
                stands = (place[0], place[1], 2.0 * np.arctan2(rotation[3], rotation[0]))
                if not target.seen or target.seen[-1][1:] != stands:  # else only where they will be is another
                    target.seen.append((k, *stands))
                target.way, target.heard = known(row[_MOVED:].copy()) if len(row) > _MOVED else None, int(k)


class HumanTask(Task):
    """A motion of the human: N frames from the present pose to the goal; with N = 0 until the function ends.

    For instance:

        def nod(task: HumanTask) -> Iterator[HumanPose]:
            for k in task.frames():
                yield task.pose({"head": ...})
    """

    def frames(self) -> Iterator[int]:
        """k = 1 to N, without an end where N is 0; `present` is the human's pose before each."""
        yield from range(1, self.length + 1) if self.length else itertools.count(1)

    def pose(
        self,
        rotations: Array | Mapping[str, Array],
        root: Array | None = None,
        importance: Array | Mapping[str, float] | None = None,
        targets: Array | Mapping[str, Array] | None = None,
        states: Mapping[str, Any] | None = None,
        way: Array | None = None,
    ) -> HumanPose:
        """The answer to a frame.

        Args:
            rotations: (43, 4), or (4,) by link name; links that are not named stay as they are at present.
            root: (3,); as at present if left out.
            importance: (44,), or by name as `importance_of`. If left out: 1 for what was given, 0 for the rest.
            targets: (5, 8), or by name as `target_rows`; none if left out.
            states: states of the target object that this frame changes.
            way: (6, 2), where the human will be, told to the others; see `ahmss.motion.way`. Not told if left out.
        """
        if importance is None:
            importance = self._importance_of_given(rotations, root)
        elif isinstance(importance, Mapping):
            importance = importance_of(importance)
        if isinstance(rotations, Mapping):
            named = self.present.rotations.copy()
            for name, rotation in rotations.items():
                named[INDEX[name]] = rotation
            rotations = named
        if isinstance(targets, Mapping):
            targets = target_rows(targets)
        return HumanPose(
            rotations,
            self.present.root.copy() if root is None else root,
            importance,
            np.zeros((5, 8)) if targets is None else targets,
            states or {},
            way,
        )

    def block(
        self,
        rotations: Array,
        root: Array,
        importance: Array | None = None,
        targets: Array | None = None,
        ways: Array | None = None,
    ) -> Array:
        """Many frames at once, to be returned or yielded as one: (N, 260), (N, 272) with ways.

        See `ahmss.algorithm.pose.block`.
        """
        return block(rotations, root, importance, targets, ways)

    @staticmethod
    def _importance_of_given(rotations: Array | Mapping[str, Array], root: Array | None) -> Array:
        """1 for every joint that was given a rotation, and for the root where it was given."""
        importance = np.zeros(len(INDEX) + 1)
        if isinstance(rotations, Mapping):
            importance[[INDEX[name] for name in rotations]] = 1.0
        else:
            importance[:43] = 1.0
        importance[43] = root is not None
        return importance


class ObjectTask(Task):
    """A motion of an object: at each frame of the human where the object is, until main stops it.

    For instance:

        def follow(task: ObjectTask) -> Iterator[ObjectPose]:
            for human in task.frames():
                yield task.pose(human.right_grip.place, task.object.rotation)

    `object` is never None here, and its place and rotation are those before the frame being computed.
    """

    object: WorldObject
    frame_size = size(FRAME_OBJECT)

    def __init__(self, start: Start) -> None:
        super().__init__(start)
        if start.object is None:
            raise ProtocolError("START for an object algorithm names no object")
        self.progress.closed = start.hold != "take"  # a hand that takes nothing need not close, or has closed before

    @property
    def closed(self) -> bool:
        """Whether the hand has closed on the object, as main has told it where algorithm.toml says `catches = true`."""
        return self.progress.closed

    def frames(self) -> Iterator[HumanFrame]:
        """The human at each frame, already blended, for as long as main asks."""
        while True:
            yield self.present

    def pose(
        self, place: Array | None = None, rotation: Array | None = None, states: Mapping[str, Any] | None = None
    ) -> ObjectPose:
        """The answer to a frame: place (3,) and rotation (4,) of the object, each as it is if left out."""
        return ObjectPose(
            self.object.place.copy() if place is None else place,
            self.object.rotation.copy() if rotation is None else rotation,
            states or {},
        )

    def see(self, row: Array) -> None:
        """Take in the numbers of a FRAME, the object's pose among them. Called by the runtime."""
        super().see(row)
        self.object.place[:] = row[190:193]
        self.object.rotation[:] = row[193:197]
