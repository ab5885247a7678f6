"""What every algorithm is told: its START, and at each frame where the human and the others are."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np
from msgspec import UNSET

from ahmss.algorithm import cache
from ahmss.algorithm.human_frame import HumanFrame
from ahmss.algorithm.messages import FRAME_HUMAN, MOVED, WAY, Meant, Start, size
from ahmss.algorithm.place import Transform, WorldObject
from ahmss.algorithm.progress import Progress, Rested
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

__all__ = ["Task"]

_HUMAN, _MOVED = size(FRAME_HUMAN), size(MOVED)
_ALONG = np.array([1.0, 0.0, 0.0])
Value = TypeVar("Value", bool, int, float, str)


class Task:
    """What every algorithm is told. Arrays are metres, radians and unit quaternions wxyz.

    length: N, the frames asked for; 0: as many as the motion needs. Where the action's own frames are 0, N is a wish.
    rate: frames a second. hand: "right", "left" or "". hold: what the action does to the object. random: numpy's
    generator, seeded by main. object: the target, or None. world: the other objects that algorithm.toml asked for, by
    id. notes: what `note` was told. meant: what `means` was. start: the human at frame 0; present: at the frame being
    computed. progress: how far the motion is.
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
        self.meant: Meant | None = None
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
    def led(self) -> tuple[str, ...]:
        """Of these those that a motion made with this one leads, from the start or by and by: it has their arms."""
        return () if self.message.led is UNSET else tuple(self.message.led)

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

    def means(self, otherwise: str, **states: tuple[float, float]) -> None:
        """Say, before the first pose, between which two values states of the object are to be in the end.

        Where one is not, the motion has failed, and the person is told `otherwise`, in one line.
        """
        self.meant = Meant(states, " ".join(otherwise.split()))

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
        """An object is elsewhere now, at frame k; one that is not known is not missed, a human who has come is.

        A human who has left is in the world no longer.
        """
        place, rotation = row[1:4], row[4:8]
        if number < 0 and np.isnan(place[0]):
            self.world.pop(number, None)
            return
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
