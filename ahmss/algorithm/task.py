"""What an author's function gets: the task of a human or of an object, and what it answers a frame with."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ahmss.algorithm.human_frame import HumanFrame
from ahmss.algorithm.messages import FRAME_OBJECT, Start, size
from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.pose import HumanPose, ObjectPose, block, importance_of, target_rows
from ahmss.algorithm.told import Task
from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.errors import ProtocolError

__all__ = ["HumanFrame", "HumanTask", "ObjectTask"]


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
