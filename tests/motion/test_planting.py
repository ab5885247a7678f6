"""Poses put under a human's feet, and the minimum-jerk profile."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, multiply
from ahmss.body.skeleton import Skeleton
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.planting import feet, plant, stance

TALL, SMALL = Skeleton.of(1.85, "male"), Skeleton.of(1.55, "female")


def test_feet_are_those_of_forward_kinematics() -> None:
    generator = np.random.default_rng(0)
    rotations = generator.normal(size=(3, 43, 4))
    rotations /= np.linalg.norm(rotations, axis=-1, keepdims=True)
    root = generator.normal(size=(3, 3))
    places, world = forward(rotations, root, TALL.offsets)
    found = feet(TALL, rotations, root)
    for i, name in enumerate(("right_foot", "left_foot")):
        np.testing.assert_allclose(found[:, i, :3], places[:, INDEX[name]])
        np.testing.assert_allclose(found[:, i, 3:], world[:, INDEX[name]])


@pytest.mark.parametrize("skeleton", [TALL, SMALL])
def test_a_pose_is_put_where_the_feet_stand(skeleton: Skeleton) -> None:
    rotations, root = skeleton.upright()
    turn = from_axis_angle(np.array([0.0, 0.0, 1.0]), 1.1)
    rotations[0] = multiply(turn, rotations[0])
    wanted = feet(skeleton, rotations, root + np.array([2.0, -1.0, 0.0]))
    other, _ = TALL.upright()  # in another heading, elsewhere
    planted, place = plant(skeleton, other, wanted)
    middle, heading = stance(feet(skeleton, planted, place))
    np.testing.assert_allclose(middle, wanted[:, :3].mean(axis=0), atol=1e-12)
    assert heading == pytest.approx(1.1)
    assert place[2] == pytest.approx(root[2])  # as high as its own legs are long


def test_minimum_jerk_starts_and_ends_at_rest() -> None:
    t = np.linspace(0.0, 1.0, 1001)
    s = minimum_jerk(t)
    velocity = np.gradient(s, t)
    assert (s[0], s[-1], s[500]) == pytest.approx((0.0, 1.0, 0.5))
    assert velocity.max() == pytest.approx(1.875, abs=1e-3)
    assert np.abs(np.gradient(velocity, t)[[0, -1]]).max() < 0.1
    np.testing.assert_array_equal(minimum_jerk(np.array([-1.0, 2.0])), [0.0, 1.0])
