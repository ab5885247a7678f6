"""Both hands at once: one posture from which both arms reach their palms, bent straight ahead as little as will do.

The hands go along with their fingers, so the posture is one from which both arms come to all places between which they
go, within their joints' limits. Who stands bends at hips and waist, and at the knees; who sits, at the waist.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import align, conjugate, from_axis_angle, multiply
from ahmss.motion.steps import Steps
from ahmss.reaching.comfort import discomfort
from ahmss.reaching.leaning import EASY, STRETCHED, looking, overbent, stretch_of, sunk
from ahmss.reaching.plan import Found, Reaching
from ahmss.reaching.prism import Prism
from ahmss.reaching.reacher import Reacher, seat
from ahmss.reaching.standing import Posture

__all__ = ["Between", "posture_for_both"]

_LEANS, _DROPS = np.radians(np.arange(0.0, 81.0, 5.0)), (0.0, 0.05, 0.1, 0.15, 0.2)
_SEATED = np.radians(np.arange(0.0, 26.0, 5.0))  # who sits bends no further: the chair is to be nearer
_EFFORT, _KNEES = 1.0 / np.radians(60.0) ** 2, 1.3 / 0.3**2  # of leaning and of knees bent
_EASY, _TOO_FAR, _SHORT, _NOT = 4.0, 600.0, 60.0, 20.0  # as of one arm; a metre too short; joints that don't allow it
_ARM, _SUNK, _LIMIT = 0.15, 1e5, 3000.0
_ENOUGH, _KEPT = 40, 24  # palms by which a posture is judged; that are looked at closely
_AT_ONCE = 24  # postures
_SPINE = INDEX["spine"]


@dataclass(frozen=True, eq=False)
class Between:
    """Palms (n, 7) of which a hand is to take one, and how far from it (k, 3) it then goes, in the world."""

    palms: Array
    goes: Array

    def places(self) -> Array:
        """The palms (n, 1 + k, 7), each as it is and as it goes."""
        made = np.repeat(self.palms[:, None], 1 + len(self.goes), axis=1)
        made[:, 1:, :3] += self.goes
        return made

    def some(self, which: slice) -> Between:
        """The same with some of its palms."""
        return Between(self.palms[which], self.goes)


def posture_for_both(
    reaching: Reaching, hands: Mapping[str, Between], gaze: Array, prisms: Sequence[Prism]
) -> Steps[Mapping[str, Found]]:
    """The posture, and for each side the palm of several that is easiest from there and how the arm then is.

    Args:
        reaching: who. hands: what they are to reach, by side. gaze: (3,) what is looked at. prisms: what may be in the
            way.
    """
    few = {side: hand.some(slice(None, None, 1 + (len(hand.palms) - 1) // _ENOUGH)) for side, hand in hands.items()}
    best: tuple[float, Posture] | None = None
    for made, static in _postures(reaching, prisms):
        yield
        if best is not None and float(static.min()) >= best[0]:
            break
        for i in np.argsort(static, kind="stable"):
            if best is not None and static[i] >= best[0]:
                break
            posture, cost = Posture(made.rotations[i], made.root[i]), float(static[i])
            for side, hand in few.items():
                cost += float(_costs(reaching, side, hand, posture, gaze).min())
            if best is None or cost < best[0]:
                best = cost, posture
            yield
    assert best is not None
    found: dict[str, Found] = {}
    for side, hand in hands.items():
        cost = _costs(reaching, side, hand, best[1], gaze)
        order = np.argsort(cost, kind="stable")[:_KEPT]
        near = hand.palms[order[cost[order] < cost[order[0]] + _NOT]]
        yield
        reacher = Reacher.of(reaching.skeleton, side)
        which, arm = yield from stretch_of(reacher, near, best[1], reaching.present(reacher), prisms)
        found[side] = best[1], near[which], arm
    return found


def _costs(reaching: Reaching, side: str, hand: Between, posture: Posture, gaze: Array) -> Array:
    """What palms cost an arm (n), at the worst of the places to which they go."""
    reacher = Reacher.of(reaching.skeleton, side)
    spine = seat(reaching.skeleton, looking(reaching.skeleton, posture.rotations, posture.root, gaze), posture.root)
    places = hand.places()
    cost, found, missing = discomfort(reacher, places, spine, reaching.present(reacher))
    stretched = np.linalg.norm(reacher.hand(places)[0] - reacher.shoulder(spine), axis=-1) / reacher.length
    over, far = np.maximum(stretched - EASY, 0.0), np.maximum(stretched - STRETCHED, 0.0)
    total = _ARM * cost + _EASY * over**2 + _TOO_FAR * far**2 + _SHORT * missing + np.where(found, 0.0, _NOT)
    return total.max(axis=-1)


def _postures(reaching: Reaching, prisms: Sequence[Prism]) -> Iterator[tuple[Posture, Array]]:
    """Postures (n) bent straight ahead, the least effort first, and what each costs by itself (n).

    That is effort, joints beyond their limits, and trunk and knees in things.
    """
    standing = reaching.standing
    if standing is None:
        made = [_at_the_waist(reaching, float(lean)) for lean in _SEATED]
        both = Posture(np.stack([one.rotations for one in made]), np.stack([one.root for one in made]))
        yield both, _EFFORT * _SEATED**2
        return
    lean, drop = (a.ravel() for a in np.meshgrid(_LEANS, _DROPS, indexing="ij"))
    effort = _EFFORT * lean**2 + _KNEES * drop**2
    order = np.argsort(effort, kind="stable")
    for first in range(0, len(order), _AT_ONCE):
        some = order[first : first + _AT_ONCE]
        zero = np.zeros(len(some))
        made = standing.postures(zero, lean[some], zero + reaching.heading, drop[some], np.zeros(3))
        cost = effort[some] + _LIMIT * overbent(reaching.skeleton, made.rotations) ** 2
        yield made, cost + _SUNK * sunk(standing, made, prisms) if prisms else cost


def _at_the_waist(reaching: Reaching, lean: float) -> Posture:
    """Bent straight ahead at the waist, of who sits."""
    rotations, heading = reaching.base.rotations.copy(), reaching.heading
    left = np.array([-np.sin(heading), np.cos(heading), 0.0])
    hips, spine = rotations[0], rotations[_SPINE]
    turned = multiply(from_axis_angle(left, lean), multiply(hips, spine))
    rotations[_SPINE] = align(multiply(conjugate(hips), turned), spine)
    return Posture(rotations, reaching.base.root)
