"""An author's function being played: frames in, poses out. The same in a process of its own and in a test."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from ahmss.algorithm.messages import OBJECT, POSE, WAY, Meant, Start, size
from ahmss.algorithm.pose import HumanPose, ObjectPose
from ahmss.algorithm.progress import Rested
from ahmss.algorithm.task import HumanTask, ObjectTask
from ahmss.body.array import Array
from ahmss.errors import ShapeError

__all__ = ["Answer", "Function", "Performance", "frames"]

_NOTHING: Mapping[str, Any] = {}
Answer = HumanPose | ObjectPose | Array
Function = Callable[[Any], Iterable[Answer] | Array]
"""HumanTask or ObjectTask to poses: a generator, any iterable, or an array of POSE rows (N, 260) or (N, 272)."""


class Performance:
    """One motion by one author's function; `step` answers a frame.

    `row` is the last answer as a POSE (260,), with a way (272,), or OBJECT (8,) row, `states` the states that it
    changed.
    """

    def __init__(self, function: Function, start: Start) -> None:
        self.task = HumanTask(start) if start.kind == "human" else ObjectTask(start)
        narrow = size(POSE) if start.kind == "human" else size(OBJECT)
        self._widths = (narrow, narrow + size(WAY)) if start.kind == "human" else (narrow,)
        self._pose_type: type[HumanPose | ObjectPose] = HumanPose if start.kind == "human" else ObjectPose
        self._row = np.zeros(self._widths[-1])
        self._function = function
        self._answers: Iterator[Answer] | None = None
        self._block = np.zeros((0, narrow))
        self._next = 0
        self._noted, self._arrived = 0, False
        self._meant: Meant | None = None
        self._whole = False  # the block is all that will come
        self._told = dict(self.task.object.states) if self.task.object is not None else {}
        self.row = self._row
        self.states = _NOTHING

    def step(self, frame: Array) -> bool:
        """Answer a FRAME's numbers; False when the function has no more to say."""
        if self._next < len(self._block) and len(frame) == self.task.frame_size:
            self.states = _NOTHING  # nobody looks at this frame: the answer was made ahead
        else:
            self.task.see(frame)
            if self._next == len(self._block) and not self._advance():
                return False
        if self._next < len(self._block):
            self.row = self._block[self._next]
            self._next += 1
        self.row[0] = frame[0]
        return True

    @property
    def over(self) -> bool:
        """Whether a human motion has given its last frame; one that takes as long as it needs may not know yet."""
        if not isinstance(self.task, HumanTask):
            return False
        if self._whole and self._next == len(self._block):
            return True
        return not self.task.message.wish and 0 < self.task.length <= self.row[0]

    def news(self) -> list[str]:
        """The notes that came since the last call."""
        first, self._noted = self._noted, len(self.task.notes)
        return self.task.notes[first:]

    def arrived(self) -> bool:
        """Whether the function has said since the last call, for the first time, that it is where it acts."""
        before, self._arrived = self._arrived, self.task.progress.arrived
        return self._arrived and not before

    def meant(self) -> Meant | None:
        """What the motion is to bring about, if the function has said so since the last call."""
        before, self._meant = self._meant, self.task.meant
        return self._meant if self._meant is not before else None

    def close(self) -> None:
        """Let the function's `finally` run."""
        close = getattr(self._answers, "close", None)
        if close is not None:
            close()

    def _advance(self) -> bool:
        """Get the function's next answer; False at its end."""
        if self._answers is None:
            result = self._function(self.task)
            self._whole = isinstance(result, np.ndarray)
            self._answers = iter([result] if isinstance(result, np.ndarray) else result)
        try:
            answer = next(self._answers, None)
        except Rested:
            return False
        if answer is None:
            return False
        if isinstance(answer, np.ndarray):
            self.states = _NOTHING
            self._take_block(answer)
            return len(self._block) > 0 or self._advance()
        if not isinstance(answer, self._pose_type):
            raise TypeError(f"expected a {self._pose_type.__name__} (see task.pose), got {type(answer).__name__}")
        self.row = self._row[: answer.width]
        answer.pack(self.row)
        self.states = self._changed(answer.states)
        return True

    def _take_block(self, rows: Array) -> None:
        """Rows to be given out one a frame."""
        if rows.ndim != 2 or rows.shape[1] not in self._widths:
            allowed = " or ".join(f"(N, {width})" for width in self._widths)
            raise ShapeError(f"a block of poses is {allowed} (see task.block), not {rows.shape}")
        self._block = np.ascontiguousarray(rows, dtype=np.float64)
        if not self._block.flags.writeable:
            self._block = self._block.copy()
        self._next = 0

    def _changed(self, states: Mapping[str, Any]) -> Mapping[str, Any]:
        """Those of the states that differ from what was last told."""
        if not states:
            return states
        news = {name: value for name, value in states.items() if self._told.get(name, self) != value}
        self._told.update(news)
        return news


def frames(function: Function, start: Start, humans: Iterable[Array] | None = None) -> Iterator[HumanPose | ObjectPose]:
    """Play a function without a process, as a test does.

    A human algorithm is asked for its N frames (with `frames` 0 until it ends by itself), each from the pose that it
    gave before; an object algorithm sees the frames of `humans` (each the 190 numbers of FRAME, or a HumanFrame's
    `row`) and its own object where it last put it.

    Args:
        function: what would be given to `run`.
        start: as main would send it.
        humans: for an object algorithm, or for a human algorithm that is to see other present poses than its own.
    """
    performance = Performance(function, start)
    try:
        for frame in _asked(performance, start, humans):
            if not performance.step(frame):
                return
            row = performance.row.copy()
            pose = HumanPose.of(row) if start.kind == "human" else ObjectPose.of(row)
            yield _with_states(pose, performance.states)
            if performance.over:
                return
    finally:
        performance.close()


def _asked(performance: Performance, start: Start, humans: Iterable[Array] | None) -> Iterator[Array]:
    """The numbers of each FRAME, k counted from 1."""
    task = performance.task
    present = task.start.row.copy()
    given = iter(humans) if humans is not None else None
    for k in range(1, start.frames + 1) if start.frames and not start.wish else itertools.count(1):
        if given is not None:
            seen = next(given, None)
            if seen is None:
                return
            present[:] = seen[:190]
        present[0] = k
        if isinstance(task, HumanTask):
            yield present
            if given is None:
                present[1:176] = performance.row[1:176]
        else:
            yield np.concatenate([present, task.object.place, task.object.rotation])
            task.object.place[:], task.object.rotation[:] = performance.row[1:4], performance.row[4:8]


def _with_states(pose: HumanPose | ObjectPose, states: Mapping[str, Any]) -> HumanPose | ObjectPose:
    """The pose with the states that it changed."""
    if isinstance(pose, HumanPose):
        return HumanPose(pose.rotations, pose.root, pose.importance, pose.targets, states, pose.way)
    return ObjectPose(pose.place, pose.rotation, states)
