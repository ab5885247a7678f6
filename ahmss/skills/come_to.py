"""Who is thought of as standing elsewhere: as one stands who has come there, the arms drawn in beside things.

From where an arm sets out its elbow comes to what the hand does: of who is thought to begin otherwise one thinks amiss.
"""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.skills.begun import begun_at
from ahmss.skills.stands import stance_at
from ahmss.skills.tucking import Tucking
from ahmss.walking import goals

__all__ = ["come_to"]

_COMES = 45  # frames in which arms come to where they are beside things


def come_to(task: HumanTask, stand: goals.Goal) -> HumanTask:
    """The task of who would have come to a stand, and tells nothing."""
    there = stance_at(task, stand).start
    thought = begun_at(task, there.rotations, there.root)
    thought.notes = []
    stays = np.repeat(task.block(there.rotations[None], there.root[None]), _COMES, axis=0)
    return begun_at(thought, Tucking(thought).over(stays)[-1, 4:176].reshape(43, 4), there.root)
