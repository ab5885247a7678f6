"""An arm that is let down from over a thing, a table say, comes in to the body on its way: straight it goes through.

What the shipped algorithms share, and an author may use.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import align, slerp
from ahmss.body.skeleton import Skeleton
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.steps import Steps
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.skin import skin_of
from ahmss.skills.tucking import tucked

__all__ = ["InFirst"]

_HIGHER = (0.0, 0.1, 0.2)  # metres over the belly where it comes in
_DEEP = 0.02  # metres that it may be in things: of so much it is kept out otherwise


class InFirst:
    """One arm's way from pose to pose of who stands.

    Args:
        skeleton: whose. side: "right" or "left". prisms: the things. start: (43, 4) before the first frame.
    """

    def __init__(self, skeleton: Skeleton, side: str, prisms: Sequence[Prism], start: Array) -> None:
        self._reacher, self._prisms = Reacher.of(skeleton, side), prisms
        self._arm = slice(INDEX[f"{side}_upper_arm"], INDEX[f"{side}_hand"] + 1)
        self._ends = np.stack([start[self._arm]] * 2)
        self._within: Array | None = None

    def look(self, times: Array, rotations: Array, root: Array) -> Steps[None]:
        """Find out whether it is to come in, and where.

        Args:
            times: (n,) shares of the motion's time, from its first frame to its last.
            rotations, root: (n, 43, 4) and (n, 3) then, as it would be.
        """
        self._ends[1] = rotations[-1, self._arm]
        least, made = self._deep(rotations, root), rotations.copy()
        for higher in _HIGHER if least > _DEEP else ():
            yield
            within = tucked(self._reacher.skeleton, higher)[self._arm]
            made[:, self._arm] = self._drawn(within, times)
            if (deep := self._deep(made, root)) < least:
                least, self._within = deep, within
            if least <= 0.0:
                break

    def over(self, times: Array, rotations: Array) -> None:
        """Have it come in, where it is to, in poses (n, 43, 4) at shares (n,) of the motion's time."""
        if self._within is not None:
            rotations[:, self._arm] = self._drawn(self._within, times)

    def _drawn(self, within: Array, times: Array) -> Array:
        """The arm's rotations (n, 3, 4) on a way as of a cubic Bezier curve whose middle points (3, 4) are within."""
        first, last = (np.broadcast_to(end, (len(times), *end.shape)) for end in self._ends)
        done = minimum_jerk(times)
        leaves, arrives = (1.0 - done) ** 3, done**3
        own = slerp(first, last, (arrives / (leaves + arrives))[:, None])
        return slerp(own, align(np.broadcast_to(within, own.shape), own), (1.0 - leaves - arrives)[:, None])

    def _deep(self, rotations: Array, root: Array) -> float:
        """Metres by which its skin is in things at the most, deeper than at either end."""
        points, radii = skin_of(self._reacher, rotations, root)
        gap = np.minimum((clearance(self._prisms, points, float(radii.max())) - radii).min(axis=-1), 0.0)
        return float(min(gap[0], gap[-1]) - gap.min())
