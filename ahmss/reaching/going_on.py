"""The posture of a hand that goes on from where it reaches: one from which the arm comes all along its way.

What is easy to take may lead out of the arm's reach, a tap's lever, say, that is turned by the hand on the far side. So
it is looked how the arm takes other places of the way too, from the posture for its beginning and from one for its end.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.motion.steps import Steps
from ahmss.reaching.comfort import discomfort
from ahmss.reaching.goal import Goal
from ahmss.reaching.leaning import Stretch, looking
from ahmss.reaching.plan import Found, Reaching
from ahmss.reaching.prism import Prism
from ahmss.reaching.reacher import Reacher, seat
from ahmss.reaching.standing import Posture

__all__ = ["GoingOn"]

_CANNOT, _MISSES = 100.0, 1e4  # what it costs that the arm's joints can't, and a metre that it is too short


class GoingOn(Reaching):
    """A human about to reach for something that then goes on with the hand.

    Args:
        skeleton, rotations, root: as of `Reaching`.
        on: of palms (n, 7) at the beginning of the way, where they are at other places of it (s, n, 7), last its end.
    """

    def __init__(self, skeleton: Skeleton, rotations: Array, root: Array, on: Callable[[Array], Array]) -> None:
        super().__init__(skeleton, rotations, root)
        self._on = on

    def posture(self, reacher: Reacher, goal: Goal, prisms: Sequence[Prism]) -> Steps[Found]:
        """The posture to reach from, the palm (7,) at the beginning, and how the arm then is."""
        found = yield from super().posture(reacher, goal, prisms)
        yield
        if self._along(reacher, found[1][None], found[0])[0] < _CANNOT:
            return found
        palms = self.palms(reacher, goal)
        yield
        cost, best, arm = self._along(reacher, palms, found[0])
        if cost < _CANNOT:
            return found[0], palms[best], arm
        end = replace(goal, palms={reacher.side: self._on(palms[best][None])[-1]})
        yield
        posture, _, _ = yield from super().posture(reacher, end, prisms)
        yield
        there, other, so = self._along(reacher, palms, posture)
        return (posture, palms[other], so) if there < cost else (found[0], palms[best], arm)

    def _along(self, reacher: Reacher, palms: Array, posture: Posture) -> tuple[float, int, Stretch]:
        """What the easiest of palms (n, 7) costs on its way in a posture, which it is, and how the arm begins so."""
        seen = looking(reacher.skeleton, posture.rotations, posture.root, palms[0, :3])
        spine = seat(reacher.skeleton, seen, posture.root)
        places = np.concatenate([palms[None], self._on(palms)])
        cost, found, missing = discomfort(reacher, places, spine, self.present(reacher))
        total = (cost + np.where(found, 0.0, _CANNOT) + _MISSES * missing).sum(axis=0)
        i = int(total.argmin())
        far = float(np.linalg.norm(reacher.hand(palms[i])[0] - reacher.shoulder(spine)))
        arm = Stretch(float(cost[0, i]), bool(found[0, i]), float(missing[0, i]), far / reacher.length)
        return float(total[i]), i, arm
