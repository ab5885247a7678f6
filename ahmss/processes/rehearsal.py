"""A motion that nobody sees, played by each worker before it waits: what it touches is its own memory from then on.

A forked process shares its parent's pages until it first writes to one, and in Python to look is to write (reference
counts). Copying them costs milliseconds, which are spent here and not at the start of a motion.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator

import msgspec
import numpy as np

from ahmss.algorithm import cache
from ahmss.algorithm.author import Channel, serve
from ahmss.algorithm.messages import (
    Kind,
    ObjectRecord,
    PoseRecord,
    SiteRecord,
    Start,
    encode,
    encode_frame,
    encode_start,
)
from ahmss.algorithm.performance import Function
from ahmss.algorithm.place import Transform
from ahmss.algorithm.pose import HumanPose
from ahmss.algorithm.task import HumanTask
from ahmss.body import quaternion
from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.motion.clip import Clip
from ahmss.processes.child import Request
from ahmss.skills.staging import face, mirrored, part, stage
from ahmss.walking.library import Library

__all__ = ["rehearse"]

_FRAMES = 3
_BOX, _BEHIND = np.array([[1.0, -0.4], [1.6, -0.4], [1.6, 0.5], [1.0, 0.5]]), np.array([2.6, 0.1])
_SKELETON = Skeleton.of()
_UPRIGHT = _SKELETON.upright()
_CLIP = Clip(
    rotations=np.tile(_UPRIGHT[0], (_FRAMES + 1, 1, 1)), root=np.tile(_UPRIGHT[1], (_FRAMES + 1, 1)),
    importance=np.ones((_FRAMES + 1, 44)), contacts=np.ones((_FRAMES + 1, 2)), rate=60.0,
    targets=np.tile([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], (_FRAMES + 1, 5, 1)),
)  # fmt: skip


def _messages() -> bytes:
    """What main would send."""
    rotations, root = _UPRIGHT
    sites = {"top": SiteRecord((0.0, 0.0, 0.0))}
    thing = ObjectRecord(1, "thing", "thing", (1.0, 0.0, 1.0), (1.0, 0.0, 0.0, 0.0), sites)
    start = Start(
        kind="human", human=_SKELETON.to_record(), pose=PoseRecord.of(rotations, root), frames=_FRAMES, object=thing,
        site="top", parameters={"depth": 0.5}, world=[thing], directory=os.getcwd(),
    )  # fmt: skip
    grips = np.zeros((2, 7))
    return encode_start(start) + b"".join(encode_frame(k + 1, root, rotations, grips) for k in range(_FRAMES))


_INPUT = _messages() + encode(Kind.STOP)
_REQUEST = msgspec.json.encode(Request(("nobody.py",), "/"))


def rehearse() -> None:
    """Play the motion in each of the ways that algorithms make theirs, over pipes of its own."""
    for function in (_single, _block, _staged):
        _play(function)
    for library in cache.known_libraries():
        _walk(library)
    msgspec.json.decode(_REQUEST, type=Request)
    cache.touch()


def _play(function: Function) -> None:
    """One motion through the same code that serves main."""
    source, feed = os.pipe()
    output, sink = os.pipe()
    try:
        os.write(feed, _INPUT)
        serve(function, Channel(source, sink))
    finally:
        for descriptor in (source, feed, output, sink):
            os.close(descriptor)


def _single(task: HumanTask) -> Iterator[HumanPose]:
    """A motion of named rotations."""
    for _ in task.frames():
        yield task.pose({"head": task.start.rotations[2]}, targets={"gaze": task.start.root})


def _block(task: HumanTask) -> Array:
    """A motion made at once, by interpolation."""
    way = np.linspace(0.0, 1.0, task.length)
    rotations = quaternion.slerp(np.tile(task.start.rotations, (task.length, 1, 1)), _UPRIGHT[0], way[:, None])
    return task.block(rotations, task.start.root + way[:, None] * np.array([1.0, 0.0, 0.0]))


def _staged(task: HumanTask) -> Iterator[Array]:
    """A clip brought to where the human and the object are, its first frame first."""
    clip = mirrored(mirrored(_CLIP))
    for first, end in ((0, 2), (1, _CLIP.frames)):
        staged = stage(task, part(clip, first, end))
        targets = np.zeros((staged.clip.frames, 5, 8))
        if staged.base is not None:
            local = Transform.of(staged.local[:, 0])
            given = staged.local[:, 0, 3:7].any(axis=1, keepdims=True)
            targets[:, 0, :7] = np.where(given, staged.base.then(local).row(), 0.0)
        targets[:, 4, :3] = face(task, staged.rotations, staged.root).place
        yield task.block(staged.rotations[1:], staged.root[1:], staged.clip.importance[1:], targets[1:])


def _walk(library: Library) -> None:
    """The first step of a walk round a thing; with a library that lacks clips it may be none."""
    from ahmss.walking.trip import Ground, Trip  # it brings shapely, which only who walks needs

    with contextlib.suppress(Exception):
        next(Trip(_SKELETON, library, Ground([_BOX], ["box"]), _BEHIND, 0.0).pieces(*_UPRIGHT))
