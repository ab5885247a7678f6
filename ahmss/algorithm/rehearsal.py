"""A motion that nobody sees, played by each worker before it waits: what it touches is its own memory from then on.

A forked process shares its parent's pages until it first writes to one, and in Python to look is to write (reference
counts). Copying them costs milliseconds, which are spent here and not at the start of a motion.
"""

from __future__ import annotations

import os
from collections.abc import Iterator

import msgspec
import numpy as np

from ahmss.algorithm import cache
from ahmss.algorithm.author import Channel, serve
from ahmss.algorithm.child import Request
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
from ahmss.algorithm.pose import HumanPose
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton

__all__ = ["rehearse"]

_FRAMES = 3
_SKELETON = Skeleton.of()


def _messages() -> bytes:
    """What main would send."""
    rotations, root = _SKELETON.upright()
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
    """Play the motion, once as single poses and once as a block, over pipes of its own."""
    for function in (_single, _block):
        _play(function)
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
    """A motion made at once."""
    rotations, root = task.start.rotations, task.start.root
    return task.block(np.tile(rotations, (task.length, 1, 1)), np.tile(root, (task.length, 1)))
