"""Trunk and hips over planted feet."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.planting import feet
from ahmss.reaching.standing import Posture, Standing, centre_of_mass, support

HUMAN = Skeleton.of(1.7)
DEGREES = np.array([0.0, 20.0, 50.0, 90.0])


def standing(heading: float = 0.0) -> Standing:
    rotations, root = HUMAN.relaxed()
    turn = from_axis_angle(np.array([0.0, 0.0, 1.0]), heading)
    rotations[0] = multiply(turn, rotations[0])
    made = Standing.of(HUMAN, rotations, rotate(turn, root))
    assert made is not None
    return made


def lean(stood: Standing, turn: float = 0.0, toward: float = 0.0, drop: float = 0.0) -> Posture:
    n = len(DEGREES)
    return stood.postures(np.full(n, turn), np.radians(DEGREES), np.full(n, toward), np.full(n, drop), np.zeros(3))


@pytest.mark.parametrize("heading", [0.0, 2.0])
@pytest.mark.parametrize("drop", [0.0, 0.3])
def test_feet_stay_and_the_weight_is_over_them(heading: float, drop: float) -> None:
    stood = standing(heading)
    made = lean(stood, toward=heading, drop=drop)
    np.testing.assert_allclose(
        feet(HUMAN, made.rotations, made.root)[..., :3], stood.feet[None, :, :3] + np.zeros((4, 1, 1)), atol=2e-3
    )
    lows, highs = support(HUMAN, stood.feet, stood.heading, (0.0, 1.0), 1.0)
    ahead = np.array([np.cos(heading), np.sin(heading)])
    along = centre_of_mass(HUMAN, made.rotations, made.root)[:, :2] @ ahead
    assert (along > lows[0]).all()
    assert (along < highs[0]).all()


def test_the_trunk_leans_where_it_is_told_and_the_hips_go_back() -> None:
    made = lean(standing(), toward=0.0)
    up = rotate(multiply(made.rotations[:, 0], made.rotations[:, 1]), np.array([1.0, 0.0, 0.0]))
    np.testing.assert_allclose(up[:, 0], np.sin(np.radians(DEGREES)), atol=0.02)
    np.testing.assert_allclose(up[:, 1], 0.0, atol=0.02)
    assert (np.diff(made.root[:, 0]) < 0.01).all()
    assert made.root[-1, 0] < made.root[0, 0] - 0.08


def test_a_turn_is_to_the_left() -> None:
    stood = standing()
    made = stood.postures(np.array([0.5]), np.zeros(1), np.zeros(1), np.zeros(1), np.zeros(3))
    front = rotate(multiply(made.rotations[0, 0], made.rotations[0, 1]), np.array([0.0, 0.0, -1.0]))
    assert np.arctan2(front[1], front[0]) == pytest.approx(0.5, abs=0.03)


def test_who_is_off_their_feet_does_not_stand() -> None:
    rotations, root = HUMAN.relaxed()
    assert Standing.of(HUMAN, rotations, root + np.array([0.0, 0.0, 0.3])) is None
    thighs = rotations.copy()
    for link in (6, 9):
        thighs[link] = multiply(thighs[link], from_axis_angle(np.array([0.0, 1.0, 0.0]), -1.5))
        thighs[link + 1] = multiply(thighs[link + 1], from_axis_angle(np.array([0.0, 1.0, 0.0]), 1.5))
    ankle = feet(HUMAN, rotations, root)[:, 2].min() - feet(HUMAN, thighs, root)[:, 2].min()
    assert Standing.of(HUMAN, thighs, root + np.array([0.0, 0.0, ankle])) is None  # sits
