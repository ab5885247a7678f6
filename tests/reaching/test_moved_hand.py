"""A hand that is moved as a whole: the elbow goes along, and never becomes straight on the way."""

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, normalize, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.reaching.moved_hand import gone_over, with_hand_moved
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


HALF_WAY = [  # of who stands up straight again from before a table
    [0.574, 0.051, 0.375, -0.726],
    [0.344, -0.256, 0.671, 0.605],
    [0.947, 0.0, -0.28, -0.161],
]


def test_an_arm_half_way_between_two_poses_does_not_leap_as_its_hand_is_first_moved() -> None:
    """Its elbow is no hinge: made one at once it turned by 8 degrees in a frame."""
    rotations, root = HUMAN.upright()
    reacher = Reacher.of(HUMAN, "right")
    rotations[reacher.links] = normalize(np.array(HALF_WAY))
    aside = np.zeros((70, 3))
    aside[:, 2] = np.arange(70) * 0.002
    poses, roots = np.repeat(rotations[None], 70, axis=0), np.repeat(root[None], 70, axis=0)
    made, at_once = (move(reacher, poses, roots, aside) for move in (gone_over, with_hand_moved))

    def turns(links: Array) -> Array:
        steps = np.concatenate([rotations[None, reacher.links], links])
        return np.degrees(np.linalg.norm(to_rotation_vector(multiply(conjugate(steps[:-1]), steps[1:])), axis=-1))

    assert turns(at_once)[0].max() > 2.0
    assert turns(made)[0].max() < 1e-6
    assert turns(made).max() < 1.5
    np.testing.assert_allclose(made[-1], at_once[-1], atol=1e-9)
