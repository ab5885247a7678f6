"""What bears an arm that reaches, frame by frame: trunk, legs and fingers on the plan's way, the gaze turning."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.quaternion import conjugate, multiply, slerp
from ahmss.motion.easing import minimum_jerk
from ahmss.reaching.leaning import looking
from ahmss.reaching.plan import Plan
from ahmss.reaching.reacher import seat
from ahmss.reaching.standing import Posture

__all__ = ["SHAPED_BY", "Bearing", "Fingers", "bearing_of"]

SHAPED_BY = 0.8
"""The share of the time by which the fingers have their shape."""

Fingers = tuple[list[int], Array]
"""Links of fingers and the rotations (n, 4) that they come to."""

_GOES_ON = 0.4  # of the time, in which a hand parts from a trunk that turns after the gaze
_UNTURNED = np.array([1.0, 0.0, 0.0, 0.0])


@dataclass(frozen=True, eq=False)
class Bearing:
    """F frames of a body but for the arm that reaches.

    time (F,). trunk: hips, spine, legs and root as before the gaze turns anything, the fingers as they go. seen
    (F, 43, 4): as it is shown. spine: its place (F, 3) and rotation (F, 4). hands (2, F, 7): where the palms would be
    if nothing moved but the gaze.
    """

    time: Array
    trunk: Posture
    seen: Array
    spine: tuple[Array, Array]
    hands: Array

    def begun(self, plan: Plan, row: int, palms: Array) -> Array:
        """Palms (F, 7) of a hand that, at first, goes on with a trunk which still turns after the gaze."""
        start, still = plan.hands[row], self.hands[row]
        left = 1.0 - minimum_jerk(self.time / _GOES_ON)
        turn = slerp(_UNTURNED, multiply(still[:, 3:], conjugate(start[3:])), left)
        place = palms[:, :3] + left[:, None] * (still[:, :3] - start[:3])
        return np.concatenate([place, multiply(turn, palms[:, 3:])], axis=-1)


def bearing_of(plan: Plan, time: Array, gaze: Array, looked: Array, fingers: Fingers) -> Bearing:
    """What bears the arm at shares of the time (F), while it is looked (F,) so far at a place (3,), fingers shaped."""
    trunk, skeleton = plan.trunk(time), plan.reacher.skeleton
    rotations = trunk.rotations
    if plan.standing is not None and plan.helped:
        rotations = plan.standing.on_feet(rotations, trunk.root)
    links, shape = fingers
    rotations[:, links] = slerp(plan.start.rotations[links], shape, minimum_jerk(time / SHAPED_BY)[:, None])
    seen = looking(skeleton, rotations, trunk.root, gaze, looked)
    start, n = plan.start, len(time)
    root = np.repeat(start.root[None], n, axis=0)
    still = looking(skeleton, np.repeat(start.rotations[None], n, axis=0), root, gaze, looked)
    hands = np.moveaxis(grips(skeleton, still, root), 1, 0)
    return Bearing(time, Posture(rotations, trunk.root), seen, seat(skeleton, seen, trunk.root), hands)
