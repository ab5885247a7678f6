"""An arm that hangs, or is drawn in, while one walks is moved aside where it would still be in a thing.

The way is known to the end of a step: the hand is moved as far as the skin of forearm, hand and fingers takes, sooner
than it would be there, and back again (`ahmss.reaching.aside`). The upper arm goes with the shoulder.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

import numpy as np

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.reaching.aside import AIR, Aside
from ahmss.reaching.moved_hand import gone_over
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.skin import skin_of

__all__ = ["Hanging"]

_AHEAD = (0, 4, 8, 12, 16)  # frames that are looked at
_LOOKED_AT = np.array(_AHEAD)
_AIR = 0.010  # metres of air that are kept: a hand that hangs has a hip beside it
_DEEP = 0.06  # metres: what a hand is so deep in (a shelf, a basin), or the hips are over, is not in its way
_MOVES = 0.15  # metres aside that a hand may come: what is farther off is not looked at
_FAR = 0.3  # metres aside beyond which nothing is in the way in a single frame
_ALL = 0.04  # metres aside at which it counts in full


class Hanging:
    """One arm, from piece to piece of a walk.

    Args:
        skeleton: whose. side: "right" or "left". rate: frames a second.
    """

    def __init__(self, skeleton: Skeleton, side: str, rate: float) -> None:
        self._reacher, self._rate = Reacher.of(skeleton, side), rate
        self._aside = Aside(rate)
        self._after: list[Aside] = []  # as it was after each frame of the last piece

    @property
    def still(self) -> bool:
        """Whether it is moved nowhere."""
        return self._aside.still

    def forget(self) -> None:
        """The arm is another motion's now."""
        self._aside, self._after = Aside(self._rate), []

    def back(self, count: int) -> None:
        """Go on as after so many frames of the last piece."""
        if self._after:
            self._aside = self._after[count - 1]

    def over(self, prisms: Sequence[Prism], rotations: Array, root: Array) -> Array:
        """Put the arm of poses (n, 43, 4), (n, 3) where no skin is in things; how far it is aside (n,), 0 to 1."""
        points, radii = skin_of(self._reacher, rotations, root)
        points = _gone_on(points)
        radii = radii + (_AIR - AIR)
        room = float(radii.max()) + AIR
        low, high = points.min(axis=(0, 1)) - room - _MOVES, points.max(axis=(0, 1)) + room + _MOVES
        low, high = low.tolist(), high.tolist()
        prisms = [prism for prism in prisms if not prism.is_beyond(low, high)]
        gap = (clearance(prisms, points, room) - radii).min(axis=-1) - AIR if prisms else np.full(len(points), np.inf)
        under = [~prism.over(root) for prism in prisms]
        moved = np.zeros((len(rotations), 3))
        clear = (_of_ahead(gap, np.minimum) > 0.0).tolist()
        lowest = _of_ahead(points.min(axis=1), np.minimum) - room - _FAR
        highest = _of_ahead(points.max(axis=1), np.maximum) + room + _FAR
        often = np.tile(radii, len(_AHEAD))
        self._after, still = [], self.still
        for k in range(len(moved)):
            if still and clear[k]:
                self._after.append(self._after[-1] if self._after else self._aside.copy())
                continue
            low, high, own = lowest[k].tolist(), highest[k].tolist(), points[k] + self._aside.moved
            within = own.min(axis=0), own.max(axis=0)
            in_the_way = [
                prism
                for prism, beside in zip(prisms, under, strict=True)
                if beside[k] and not prism.is_beyond(low, high) and not _deep_in(prism, own, within)
            ]
            moved[k] = self._aside.step(in_the_way, points[k + _LOOKED_AT].reshape(-1, 3), often)
            self._after.append(self._aside.copy())
            still = self.still
        shares = np.minimum(np.linalg.norm(moved, axis=-1) / _ALL, 1.0)
        (aside,) = np.nonzero(shares)
        if len(aside):
            made = gone_over(self._reacher, rotations[aside], root[aside], moved[aside])
            rotations[aside, self._reacher.links] = made
        return shares


def _of_ahead(values: Array, least: np.ufunc) -> Array:
    """The least or most (n, ...) of values (n + the farthest ahead, ...) of the frames that are looked at from each."""
    n = len(values) - _AHEAD[-1]
    return reduce(least, [values[ahead : ahead + n] for ahead in _AHEAD])


def _deep_in(prism: Prism, points: Array, within: tuple[Array, Array]) -> bool:
    """Whether one of points (m, 3), in the box of such corners, is so deep in a thing that it is not in their way."""
    return prism.meets(*within) and clearance([prism], points, 0.0).min() <= -_DEEP


def _gone_on(points: Array) -> Array:
    """Points (n, m, 3), and what comes after them if they go on as they do."""
    speed = points[-1] - points[-2] if len(points) > 1 else np.zeros(points.shape[1:])
    return np.concatenate([points, points[-1] + np.arange(1, _AHEAD[-1] + 1)[:, None, None] * speed])
