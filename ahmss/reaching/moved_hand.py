"""An arm whose hand is moved as a whole: it stays turned as it was, and the elbow goes along."""

from __future__ import annotations

import numpy as np

from ahmss.body.arm import Wrist, hand_angles, with_hand, wrist_of
from ahmss.body.arm_choice import present_side
from ahmss.body.arm_swing import HAND, limits_of, swing_of
from ahmss.body.array import Array
from ahmss.body.quaternion import align, conjugate, multiply, rotate
from ahmss.reaching.reacher import Reacher, seat

__all__ = ["with_hand_moved"]


def with_hand_moved(reacher: Reacher, rotations: Array, root: Array, moved: Array) -> Array:
    """The arm's rows (3, 4) of a pose (43, 4), (3,) whose hand is moved by (3,) metres in the world.

    The hand is turned no farther than its joints allow, but where it was beyond that it may be so still.
    """
    arm, before = reacher.arm, rotations[reacher.links]
    turn = multiply(seat(reacher.skeleton, rotations, root)[1], arm.rotation)
    links = arm.from_pose(before)
    wrist = wrist_of(arm, links)
    wrist = Wrist(wrist.place + rotate(conjugate(turn), moved), wrist.rotation)
    made = swing_of(arm, wrist, present_side(arm, links, wrist.place)).links(np.zeros(()))
    held, (low, high) = hand_angles(links), limits_of(arm)[HAND].T
    made = with_hand(made, np.clip(hand_angles(made), np.minimum(low, held), np.maximum(high, held)))
    return align(arm.into_pose(made), before)
