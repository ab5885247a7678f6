"""An arm whose hand is moved as a whole: it stays turned as it was, and the elbow goes along."""

from __future__ import annotations

import numpy as np

from ahmss.body.arm import Wrist, hand_angles, with_hand, wrist_of
from ahmss.body.arm_choice import present_side
from ahmss.body.arm_swing import HAND, limits_of, swing_of
from ahmss.body.array import Array
from ahmss.body.quaternion import align, conjugate, multiply, rotate
from ahmss.reaching.reacher import Reacher, seat
from ahmss.reaching.twist import twist_of, twisted

__all__ = ["with_hand_moved"]

_SOFT, _FULLY = 0.985, 0.996  # of the arm's length: from where on it gives less, and what it is not stretched beyond


def with_hand_moved(reacher: Reacher, rotations: Array, root: Array, moved: Array, swung: Array | None = None) -> Array:
    """The arm's rows (..., 3, 4) of poses (..., 43, 4), (..., 3) whose hand is moved by (..., 3) metres in the world,
    and whose elbow is swung by (...) radians about the line from shoulder to wrist.

    The hand is turned no farther than its joints allow, but where it was beyond that it may be so still.
    """
    arm, before = reacher.arm, rotations[..., reacher.links, :]
    turn = multiply(seat(reacher.skeleton, rotations, root)[1], arm.rotation)
    links = arm.from_pose(before)
    wrist = wrist_of(arm, links)
    place = wrist.place + rotate(conjugate(turn), moved)
    wrist = Wrist(_within(reacher.length, place, np.linalg.norm(wrist.place, axis=-1)), wrist.rotation)
    made = swing_of(arm, wrist, present_side(arm, links, wrist.place)).links(
        np.zeros(place.shape[:-1]) if swung is None else swung
    )
    held, (low, high) = hand_angles(links), limits_of(arm)[HAND].T
    made = with_hand(made, np.clip(hand_angles(made), np.minimum(low, held), np.maximum(high, held)))
    made = twisted(made, twist_of(links))  # of the hand's turn the wrist has as much as before
    return align(arm.into_pose(made), before)


def _within(length: float, place: Array, was: Array) -> Array:
    """The wrist's places (..., 3) from the shoulder, not so far that the elbow becomes straight: it would get there,
    and leave, ever faster. Who held it farther off, `was` metres (...), may.
    """
    away = np.linalg.norm(place, axis=-1)
    soft = np.maximum(_SOFT * length, was)
    span = np.maximum(_FULLY * length - soft, 1e-9)
    over = np.maximum(away - soft, 0.0)
    held = soft + span * -np.expm1(-over / span)
    return np.where(over > 0.0, held / np.maximum(away, 1e-9), 1.0)[..., None] * place
