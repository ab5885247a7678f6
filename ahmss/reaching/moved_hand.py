"""An arm whose hand is moved as a whole: it stays turned as it was, and the elbow goes along."""

from __future__ import annotations

import numpy as np

from ahmss.body.arm import Wrist, hand_angles, with_hand, wrist_of
from ahmss.body.arm_choice import present_side
from ahmss.body.arm_swing import HAND, limits_of, swing_of
from ahmss.body.array import Array
from ahmss.body.quaternion import align, conjugate, from_rotation_vector, multiply, rotate, to_rotation_vector
from ahmss.motion.easing import minimum_jerk
from ahmss.reaching.reacher import Reacher, seat
from ahmss.reaching.twist import twist_of, twisted

__all__ = ["gone_over", "with_hand_moved"]

_SOFT, _FULLY = 0.985, 0.996  # of the arm's length: from where on it gives less, and what it is not stretched beyond
_GOES_OVER = 0.12  # metres that a hand is moved by until the arm is one that can be


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


def gone_over(reacher: Reacher, rotations: Array, root: Array, moved: Array) -> Array:
    """The same of an arm that may be as none can be, on its way between two poses, where its elbow is no hinge.

    As its hand is moved it goes over into one that can: at once it would leap. Until then the hand may be some
    millimetres off.
    """
    before = rotations[..., reacher.links, :]
    made, unmoved = (with_hand_moved(reacher, rotations, root, by) for by in (moved, np.zeros_like(moved)))
    was, alike, now = (_against_trunk(links) for links in (before, unmoved, made))
    kept = 1.0 - minimum_jerk(np.minimum(np.linalg.norm(moved, axis=-1) / _GOES_OVER, 1.0))
    off = kept[..., None, None] * to_rotation_vector(multiply(conjugate(alike), was))
    turned = multiply(now, from_rotation_vector(off))  # each about its own axes, so that it points where it did
    against = multiply(conjugate(turned[..., :-1, :]), turned[..., 1:, :])
    return align(np.concatenate([turned[..., :1, :], against], axis=-2), before)


def _against_trunk(links: Array) -> Array:
    """The rotations (..., 3, 4) of an arm's links against the trunk, from those against each other."""
    lower = multiply(links[..., 0, :], links[..., 1, :])
    return np.stack([links[..., 0, :], lower, multiply(lower, links[..., 2, :])], axis=-2)


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
