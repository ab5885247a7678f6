"""The turn that a wrist was left with goes to the forearm without moving the hand."""

import numpy as np
import pytest

from ahmss.body.arm import Arm, links_of, split_wrist, wrist_of
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.reaching.twist import handed_back, untwisted

ARM = Arm.of(Skeleton.of(1.7, "male"), "right")
ALONG = np.array([1.0, 0.0, 0.0])


def twisted(by: float):
    """An arm, and the same wrist pose with some of the forearm's turn in the wrist."""
    links = links_of(np.array([0.3, 0.6, -0.2, 1.1, 0.5, 0.4, -0.3]))
    out = links.copy()
    out[1] = multiply(links[1], from_axis_angle(ALONG, -by))
    out[2] = multiply(from_axis_angle(ALONG, by), links[2])
    return links, out


def angle(p, q):
    return np.linalg.norm(to_rotation_vector(multiply(conjugate(p), q)), axis=-1)


@pytest.mark.parametrize("by", [0.7, -0.4, 2.5])
def test_the_turn_is_found_and_the_arm_without_it(by: float) -> None:
    links, left = twisted(by)
    found, twist = untwisted(left)
    assert np.isclose(twist, by)
    assert angle(found, links).max() < 1e-9


@pytest.mark.parametrize("by", [0.7, -0.4])
def test_it_is_handed_back_from_where_it_was_and_the_hand_stays(by: float) -> None:
    links, left = twisted(by)
    still = np.repeat(links[None], 80, axis=0)
    out = handed_back(still, by)
    assert angle(out[0], left).max() < np.radians(0.1)
    assert angle(out[-1], links).max() < 1e-9
    assert angle(out[:-1], out[1:]).max() < np.radians(1.6)
    assert angle(wrist_of(ARM, out).rotation, wrist_of(ARM, still).rotation).max() < 1e-9
    assert np.allclose(wrist_of(ARM, out).place, wrist_of(ARM, still).place)
    turn, _ = split_wrist(out[10, 2])
    assert np.sign(turn[1]) == np.sign(by)
