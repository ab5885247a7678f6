"""An arm that is let down from over a thing, a table say, comes in to the body on its way: straight it goes through.

What the shipped algorithms share, and an author may use.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ahmss.body.array import Array
from ahmss.body.inverse import grips
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

_WAYS = ((0.6, 0.1), (0.8, 0.1), (0.8, 0.2), (1.0, 0.2))  # how far it comes in; metres over the belly where
_AT_ONCE = 2  # of these that are looked at
_TOUCHES, _FAST, _FASTER = 0.01, 1.0, 0.05  # metres in things; m/s of a palm, and beyond them what is as bad
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
        self._way: tuple[float, Array] | None = None

    def look(self, times: Array, seconds: float, rotations: Array, root: Array) -> Steps[None]:
        """Find out whether it is to come in, and how.

        Args:
            times: (n,) shares of the motion's time, from its first frame to its last. seconds: how long that is.
            rotations, root: (n, 43, 4) and (n, 3) then, as it would be.
        """
        self._ends[1] = rotations[-1, self._arm]
        if self._deep(rotations, root) <= _DEEP:
            return
        made, best = rotations.copy(), np.inf
        for i, (share, higher) in enumerate(_WAYS):
            if i % _AT_ONCE == 0:
                yield
            way = share, tucked(self._reacher.skeleton, higher)[self._arm]
            made[:, self._arm] = self._drawn(way, times)
            palms = grips(self._reacher.skeleton, made, root)[:, self._reacher.row, :3]
            fastest = float((np.linalg.norm(np.diff(palms, axis=0), axis=-1) / np.diff(times)).max()) / seconds
            cost = self._deep(made, root) / _TOUCHES + max(fastest - _FAST, 0.0) / _FASTER
            if cost < best:
                best, self._way = cost, way

    def over(self, times: Array, rotations: Array) -> None:
        """Have it come in, where it is to, in poses (n, 43, 4) at shares (n,) of the motion's time."""
        if self._way is not None:
            rotations[:, self._arm] = self._drawn(self._way, times)

    def _drawn(self, way: tuple[float, Array], times: Array) -> Array:
        """The arm's rotations (n, 3, 4) that comes in by a share of the way, to rotations (3, 4).

        All the way it goes as on a cubic Bezier curve whose middle points are in there.
        """
        share, within = way
        first, last = (np.broadcast_to(end, (len(times), *end.shape)) for end in self._ends)
        done = minimum_jerk(times)
        leaves, arrives = (1.0 - done) ** 3, done**3
        straight = done + share * (arrives / (leaves + arrives) - done)
        own = slerp(first, last, straight[:, None])
        return slerp(own, align(np.broadcast_to(within, own.shape), own), share * (1.0 - leaves - arrives)[:, None])

    def _deep(self, rotations: Array, root: Array) -> float:
        """Metres by which its skin is in things at the most, deeper than at either end."""
        points, radii = skin_of(self._reacher, rotations, root)
        gap = np.minimum((clearance(self._prisms, points, float(radii.max())) - radii).min(axis=-1), 0.0)
        return float(min(gap[0], gap[-1]) - gap.min())
