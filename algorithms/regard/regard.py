"""Looking at somebody: the eyes stay on theirs, wherever either goes."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import HumanPose, HumanTask, importance_of, run
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE
from ahmss.errors import AlgorithmError
from ahmss.skills.company import Watching

CARES = 0.5  # the head's importance: a walk's is a sixth of it


def regard(task: HumanTask) -> Iterator[HumanPose | Array]:
    """A frame for each that is asked for; who is behind one's back is turned to first."""
    task, watching = yield from Watching.faced(task)
    task.arrived()
    if watching is None:
        raise AlgorithmError("look at whom? name another human")
    importance = importance_of({"head": CARES})
    for k in range(1, task.length + 1) if task.length else itertools.count(1):
        targets = np.zeros((5, 8))
        targets[GAZE] = watching.gaze(0.0, 0.0, k)
        yield task.pose({}, None, importance, targets)


if __name__ == "__main__":
    run(regard)
