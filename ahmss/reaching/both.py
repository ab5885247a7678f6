"""Both hands at once: one posture from which both arms reach their palms, bent straight ahead as little as will do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import align, conjugate, from_axis_angle, multiply
from ahmss.reaching.leaning import EASY, STRETCHED, Stretch, stretch_of
from ahmss.reaching.plan import Found, Reaching
from ahmss.reaching.prism import Prism
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.standing import Posture
from ahmss.reaching.steps import Steps

__all__ = ["posture_for_both"]

_LEANS = np.radians(np.arange(0.0, 56.0, 5.0))
_EFFORT, _EASY, _TOO_FAR = 1.0 / np.radians(60.0) ** 2, 4.0, 600.0  # as of one arm
_ARM = 0.15
_SPINE = INDEX["spine"]


def posture_for_both(
    reaching: Reaching, palms: Mapping[str, Array], prisms: Sequence[Prism]
) -> Steps[Mapping[str, Found]]:
    """The posture, and for each side the palm of several (n, 7) that is easiest from there and how the arm then is.

    Args:
        reaching: who. palms: by side. prisms: what may be in the way.
    """
    best: tuple[float, Mapping[str, Found]] | None = None
    for lean in _LEANS:
        posture = _bent(reaching, float(lean))
        found: dict[str, Found] = {}
        cost = _EFFORT * float(lean) ** 2
        for side, some in palms.items():
            reacher = Reacher.of(reaching.skeleton, side)
            which, arm = yield from stretch_of(reacher, some, posture, reaching.present(reacher), prisms)
            found[side] = posture, some[which], arm
            cost += _cost(arm)
            yield
        if best is None or cost < best[0]:
            best = cost, found
        if all(arm.found and arm.stretched <= EASY for _, _, arm in found.values()):
            break  # to bend further would spare nothing
    assert best is not None
    return best[1]


def _cost(arm: Stretch) -> float:
    """What an arm costs."""
    over, far = max(arm.stretched - EASY, 0.0), max(arm.stretched - STRETCHED, 0.0)
    return _ARM * arm.cost + _EASY * over**2 + _TOO_FAR * far**2


def _bent(reaching: Reaching, lean: float) -> Posture:
    """Bent straight ahead: over the feet, or of who sits at the waist."""
    if lean == 0.0:
        return reaching.base
    if reaching.standing is not None:
        one = np.array([lean])
        made = reaching.standing.postures(0.0 * one, one, np.array([reaching.heading]), 0.0 * one, np.zeros(3))
        return Posture(made.rotations[0], made.root[0])
    rotations, heading = reaching.base.rotations.copy(), reaching.heading
    left = np.array([-np.sin(heading), np.cos(heading), 0.0])
    hips, spine = rotations[0], rotations[_SPINE]
    turned = multiply(from_axis_angle(left, lean), multiply(hips, spine))
    rotations[_SPINE] = align(multiply(conjugate(hips), turned), spine)
    return Posture(rotations, reaching.base.root)
