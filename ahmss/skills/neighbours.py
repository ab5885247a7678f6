"""The controls beside the one that is used, of which hand and arm keep out."""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.task import HumanTask

__all__ = ["neighbours"]

_NEAR = 0.6  # metres from a control within which others are looked at


def neighbours(task: HumanTask) -> list[WorldObject]:
    """What tells by its property `box` what it fills, near the task's object."""
    if task.object is None:
        return []
    at = task.object.place
    told = [thing for thing in task.world.values() if "box" in thing.properties and thing.id != task.object.id]
    return [thing for thing in told if float(np.linalg.norm(thing.place - at)) < _NEAR]
