"""Arms of who stands that a motion does not lead: they keep out of what they are brought to, or come from over.

What the shipped algorithms share, and an author may use.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.motion.steps import Steps
from ahmss.reaching.prism import in_the_way
from ahmss.skills.hanging import Hanging
from ahmss.skills.in_first import InFirst
from ahmss.skills.reaching import prisms_of

__all__ = ["IdleArms"]

_SEEN = 4  # every so many frames are looked at to see whether an arm's way is clear


class IdleArms:
    """Arms in a motion whose frames are counted.

    Args:
        task: who. sides: whose arms they are.
    """

    def __init__(self, task: HumanTask, sides: Sequence[str]) -> None:
        self._prisms, self._length = in_the_way(prisms_of(task), task.start.root, task.start.root), task.length
        self._seconds = task.length / task.rate
        sides = sides if self._prisms else ()
        self._arms = [Hanging(task.human, side, task.rate) for side in sides]
        self._ways = {side: InFirst(task.human, side, self._prisms, task.start.rotations) for side in sides}

    @property
    def seen(self) -> Array:
        """The frames (n) to be looked at."""
        return np.append(np.arange(1, self._length, _SEEN), self._length)

    def look(self, sides: Sequence[str], rotations: Array, root: Array) -> Steps[None]:
        """Find out which arms come in on their way, in parts.

        Args:
            sides: whose. rotations, root: (n, 43, 4) and (n, 3) in the frames to be looked at, as they would be.
        """
        for side in sides:
            if side in self._ways:
                yield
                yield from self._ways[side].look(self.seen / self._length, self._seconds, rotations, root)

    def over(self, rows: Array, frames: Array) -> Array:
        """POSE rows (n, 260) of frames (n), these arms in, or aside, where they would be in something."""
        rotations, root = rows[:, 4:176].reshape(-1, 43, 4).copy(), rows[:, 1:4]
        for way, arm in zip(self._ways.values(), self._arms, strict=True):
            way.over(frames / self._length, rotations)
            arm.over(self._prisms, rotations, root)
        return np.concatenate([rows[:, :4], rotations.reshape(-1, 172), rows[:, 176:]], axis=1)
