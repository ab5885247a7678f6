"""Where the elbow is, of a hand that is brought to the head: it swings out of the trunk, and hangs as low as it can."""

from __future__ import annotations

import itertools

import numpy as np

from ahmss.body.arm import Wrist, hand_angles
from ahmss.body.arm_choice import present_side
from ahmss.body.arm_swing import HAND, limits_of, swing_of
from ahmss.body.array import Array
from ahmss.body.quaternion import between, multiply, rotate
from ahmss.motion.easing import minimum_jerk
from ahmss.reaching.reacher import Reacher

__all__ = ["hangs", "swung"]

_SWINGS = np.radians(np.arange(-150.0, 151.0, 6.0))
_TRUNK = np.array([0.17, 0.13])  # metres: half of its width and depth
_UNDER = 0.06  # metres over the shoulder, up to which it reaches
_INSIDE, _OVER, _HIGH, _CHANGE = 40.0, 12.0, 5.0, 0.2  # what it costs: in the trunk, a radian over a limit, a metre up
_SHORT = 60.0  # a metre that the wrist is missing


def hangs(reacher: Reacher, palms: Array, spine: tuple[Array, Array], present: Array) -> tuple[Array, Array]:
    """What palms (n, 7) cost (n) with the elbow where it is best, and how far it swings there (n), radians.

    Args:
        reacher: the arm. palms: in the world.
        spine: place (3,) and rotation (4,) of the spine link.
        present: (3, 4) the arm's present links: a swing of 0 has the elbow carried along from there.
    """
    costs, swings = np.empty(len(palms)), np.empty(len(palms))
    for i, palm in enumerate(palms):
        wrist = reacher.wrist(palm, spine)
        costs[i], swings[i] = _best(reacher, wrist, present_side(reacher.arm, present, wrist.place))
    return costs, swings


def _best(reacher: Reacher, wrist: Wrist, side: Array) -> tuple[float, float]:
    """What a wrist pose costs where the elbow swings from a side (3,) to where it is best; and how far, radians."""
    n = len(_SWINGS)
    many = Wrist(np.tile(wrist.place, (n, 1)), np.tile(wrist.rotation, (n, 1)))
    swing = swing_of(reacher.arm, many, np.tile(side, (n, 1)))
    cost = _cost(reacher, swing.links(_SWINGS)) + _CHANGE * _SWINGS**2
    best = int(cost.argmin())
    return float(cost[best]) + _SHORT * max(float(swing.missing[0]), 0.0), float(_SWINGS[best])


def _cost(reacher: Reacher, links: Array) -> Array:
    """What arms (n, 3, 4) cost (n): elbow and forearm in the trunk, the hand beyond its limits, the elbow high."""
    limits = limits_of(reacher.arm)[HAND]
    angles = hand_angles(links)
    over = np.maximum(np.maximum(limits[:, 0] - angles, angles - limits[:, 1]), 0.0).sum(axis=-1)
    in_spine = multiply(reacher.arm.rotation, links[:, 0])
    elbow = reacher.arm.place + rotate(in_spine, np.array([reacher.arm.lengths[0], 0.0, 0.0]))
    forearm = rotate(multiply(in_spine, links[:, 1]), np.array([reacher.arm.lengths[1], 0.0, 0.0]))
    inside = np.zeros(len(links))
    for share in (0.0, 0.35, 0.7):  # a spine has x up, y to the left, z back
        point = elbow + share * forearm
        out = np.hypot(point[:, 1] / _TRUNK[0], point[:, 2] / _TRUNK[1])
        under = point[:, 0] < reacher.arm.place[0] + _UNDER
        inside += np.where(under, np.maximum(1.0 - out, 0.0), 0.0)
    high = elbow[:, 0] - reacher.arm.place[0]
    return _INSIDE * inside + _OVER * over + _HIGH * np.maximum(high + 0.3, 0.0)


def swung(reacher: Reacher, palms: Array, spine: tuple[Array, Array], present: Array) -> Array:
    """An arm's rows in poses (F, 3, 4), the hand at palms (F, 7), the elbow swinging out gradually all the way.

    Args:
        reacher: the arm. palms: in the world.
        spine: places (F, 3) and rotations (F, 4) of the spine link.
        present: (3, 4) the arm's links in the frame before.
    """
    wrist = reacher.wrist(palms, spine)
    sides = [present_side(reacher.arm, present, wrist.place[0])]
    for before, place in itertools.pairwise(wrist.place):  # carried along by the smallest turns
        sides.append(rotate(between(before, place), sides[-1]))
    last = Wrist(wrist.place[-1], wrist.rotation[-1])
    _, swing = _best(reacher, last, sides[-1])
    share = minimum_jerk(np.arange(1, len(palms) + 1) / len(palms))
    made = reacher.arm.into_pose(swing_of(reacher.arm, wrist, np.stack(sides)).links(swing * share))
    before = np.concatenate([reacher.arm.into_pose(present)[None], made[:-1]])
    same = (made * before).sum(axis=-1) >= 0.0
    return np.cumprod(np.where(same, 1.0, -1.0), axis=0)[..., None] * made
