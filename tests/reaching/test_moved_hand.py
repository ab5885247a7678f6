"""A hand that is moved as a whole: the elbow goes along, and never becomes straight on the way."""

import numpy as np
import pytest

from ahmss.body.inverse import grips
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.reaching.moved_hand import with_hand_moved
from ahmss.reaching.reacher import Reacher

HUMAN = Skeleton.of(1.7, "male")


@pytest.mark.parametrize(("side", "row"), [("right", 0), ("left", 1)])
def test_the_elbow_is_bent_softly_by_a_hand_that_is_led_farther_than_the_arm_is_long(side: str, row: int) -> None:
    rotations, root = HUMAN.upright()
    lower, reacher = INDEX[f"{side}_lower_arm"], Reacher.of(HUMAN, side)
    rotations[lower] = multiply(rotations[lower], from_axis_angle(np.array([0.0, 1.0, 0.0]), -0.5))
    palm = grips(HUMAN, rotations, root)[row]
    elbows, out = [], rotations.copy()
    for down in np.arange(0.0, 0.06, 0.001):
        out[reacher.links] = with_hand_moved(reacher, rotations, root, np.array([0.0, 0.0, -down]))
        elbows.append(out[lower].copy())
        if down < 0.008:
            moved = grips(HUMAN, out, root)[row]
            np.testing.assert_allclose(moved[:3], palm[:3] - [0.0, 0.0, down], atol=1e-9)
    turns = np.degrees(
        np.linalg.norm(to_rotation_vector(multiply(conjugate(elbows[:-1]), np.array(elbows[1:]))), axis=-1)
    )
    assert turns[:10].min() > 0.3
    assert turns.max() < 2.0  # a millimetre: into straight it is nearly six


@pytest.mark.parametrize("side", ["right", "left"])
def test_a_wrist_that_has_some_of_the_forearms_turn_keeps_it(side: str) -> None:
    """The forearm took it over as soon as the hand was moved at all: it turned by 14 degrees in a frame."""
    rotations, root = HUMAN.upright()
    reacher = Reacher.of(HUMAN, side)
    for link, axis, angle in (("lower_arm", 1, 0.5), ("lower_arm", 0, 0.2), ("hand", 0, -0.35), ("hand", 1, 0.1)):
        i = INDEX[f"{side}_{link}"]
        rotations[i] = multiply(rotations[i], from_axis_angle(np.eye(3)[axis], angle))
    before = rotations[reacher.links]
    after = with_hand_moved(reacher, rotations, root, np.array([0.0, 0.0, 1e-4]))
    assert np.degrees(np.linalg.norm(to_rotation_vector(multiply(conjugate(before), after)), axis=-1)).max() < 0.2
