"""A task that goes on from elsewhere: after steps, or after its human has stood up."""

from __future__ import annotations

import copy

from ahmss.algorithm.task import HumanFrame, HumanTask
from ahmss.body.array import Array

__all__ = ["begun_at"]


def begun_at(task: HumanTask, rotations: Array, root: Array) -> HumanTask:
    """The task as one that begins in a pose (43, 4), (3,)."""
    moved = copy.copy(task)
    row = task.start.row.copy()
    row[1:4], row[4:176] = root, rotations.reshape(172)
    moved.start = HumanFrame(row)
    return moved
