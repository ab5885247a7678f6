"""A clip in which one stands, its trunk led round what stands beside on the way from one keyframe to the next."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.motion.steps import Steps
from ahmss.reaching.prism import in_the_way
from ahmss.reaching.standing import Posture, Standing
from ahmss.reaching.trunk_way import drawn_towards
from ahmss.skills.reaching import prisms_of
from ahmss.skills.staging import Staged

__all__ = ["trunk_kept_clear"]

_GOES = 0.1  # metres: hips that rise or sink less bring no head past an edge


def trunk_kept_clear(task: HumanTask, staged: Staged) -> Steps[Staged]:
    """The clip, and what the trunk is drawn towards on the way to each keyframe; as it is where one stays as high."""
    way = [Posture(task.start.rotations, task.start.root)]
    way += [Posture(*key) for key in zip(staged.rotations, staged.root, strict=True)]
    standing = Standing.of(task.human, task.start.rotations, task.start.root)
    rises = float(np.ptp([key.root[2] for key in way])) > _GOES
    if task.carried or not staged.planted or not rises or standing is None:
        return staged
    prisms = in_the_way(prisms_of(task), task.start.root, task.start.root)
    towards: list[Posture | None] = []
    for before, after in pairwise(way):
        towards.append((yield from drawn_towards(standing, before, after, None, prisms)))
        yield
    return replace(staged, towards=towards)
