"""Which swings of an elbow keep upper arm and forearm out of things, the hand being where it is to be."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ahmss.body.arm import Wrist
from ahmss.body.arm_path import SWINGS, carried_sides
from ahmss.body.arm_swing import swing_of
from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.motion.steps import Steps
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.skin import limbs

__all__ = ["clear_swings"]

_AIR, _AS_WELL = 0.006, 0.001  # metres that are kept; by which one is as clear as the clearest, where none keeps them
_EVERY, _AT_ONCE = 4, 16  # every so many frames are looked at, so many of these together
_X = np.array([1.0, 0.0, 0.0])


def clear_swings(
    reacher: Reacher, wrist: Wrist, present: Array, spine: tuple[Array, Array], prisms: Sequence[Prism]
) -> Steps[NDArray[np.bool_]]:
    """Which of the `SWINGS` (F, 48) are clear of things; where none is those that are the clearest.

    Args:
        reacher: the arm. wrist: places (F, 3) and rotations (F, 4) in the shoulder frame, as of `arm_path.follow`.
        present: (3, 4) the links of the frame before. spine: its places (F, 3) and rotations (F, 4), world.
        prisms: the things.
    """
    arm, n = reacher.arm, len(wrist.place)
    swing = swing_of(arm, wrist, carried_sides(arm, wrist.place, present))
    turned, shoulder = multiply(spine[1], arm.rotation), reacher.shoulder(spine)
    ends = shoulder + rotate(turned, wrist.place)
    looked = np.unique(np.append(np.arange(0, n, _EVERY), n - 1))
    seen = np.empty((len(looked), len(SWINGS)), bool)
    for first in range(0, len(looked), _AT_ONCE):
        yield
        some = looked[first : first + _AT_ONCE, None]
        upper = multiply(from_axis_angle(swing.line[some], SWINGS), swing.upper[some])
        elbow = shoulder[some] + arm.lengths[0] * rotate(multiply(turned[some], upper), _X)
        points, radii = limbs(
            np.broadcast_to(shoulder[some], elbow.shape), elbow, np.broadcast_to(ends[some], elbow.shape)
        )
        gap = (clearance(prisms, points, _AIR + float(radii.max())) - radii).min(axis=-1)
        seen[first : first + len(some)] = gap > np.minimum(_AIR, gap.max(axis=-1, keepdims=True) - _AS_WELL)
    after = np.minimum(np.searchsorted(looked, np.arange(n)), len(looked) - 1)
    return seen[after] & seen[np.maximum(after - 1, 0)]
