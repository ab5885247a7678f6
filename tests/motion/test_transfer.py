"""A clip given from one of our humans to another."""

from dataclasses import replace

import msgspec
import numpy as np
import pytest

from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS
from ahmss.body.quaternion import from_axis_angle, from_rotation_vector, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.clip import Clip, ClipHeader
from ahmss.motion.contact import foot_points
from ahmss.motion.edit import floor_frame
from ahmss.motion.transfer import transfer

from .makers import RATE, stepping

TALL, SMALL = Skeleton.of(1.85, "male", "tall"), Skeleton.of(1.55, "female", "small")


@pytest.fixture
def bow():
    """A bow of the tall one over standing feet, the index finger bent, somewhere in the world."""
    rotations, root = stepping(TALL)
    finger = INDEX["left_index_proximal"]
    rotations[:, finger] = multiply(rotations[:, finger], from_rotation_vector(np.array([0.0, 0.0, 0.8])))
    turn = from_axis_angle(np.array([0.0, 0.0, 1.0]), 0.8)
    rotations[:, 0], root = multiply(turn, rotations[:, 0]), rotate(turn, root) + np.array([2.0, 1.0, 0.0])
    targets = np.zeros((len(root), 5, 8))
    targets[:, 0] = (0.4, 0.1, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    importance = np.linspace(0.0, 1.0, len(root) * 44).reshape(-1, 44)
    return Clip(rotations, root, importance, np.ones((len(root), 2)), RATE, targets, ClipHeader(human="tall"))


def same(a, b, tolerance):
    return np.abs(np.einsum("...c,...c->...", a, b)).min() > 1.0 - tolerance


def test_to_oneself_it_is_the_same_motion(bow):
    own = transfer(bow, TALL, TALL)
    places, _ = forward(bow.rotations, bow.root, TALL.offsets)
    there, _ = forward(own.rotations, own.root, TALL.offsets)
    assert np.abs(places - there).max() < 0.02  # knees, which the ground straightens or bends by some degrees
    assert same(own.rotations, bow.rotations, 2e-3)


def test_the_other_stands_where_the_one_did_with_feet_on_the_floor(bow):
    given = transfer(bow, TALL, SMALL)
    assert given.header.human == "small"
    points = foot_points(SMALL, given.rotations, given.root)
    assert np.abs(points[..., 2]).max() < 0.004
    assert np.ptp(points, axis=0).max() < 0.004
    place, heading = floor_frame(given.rotations[0], given.root[0])
    was_place, was_heading = floor_frame(bow.rotations[0], bow.root[0])
    assert np.allclose(place, was_place, atol=0.01)
    assert same(heading, was_heading, 1e-4)
    assert given.root[0, 2] < 0.9 * bow.root[0, 2]


def test_hands_are_where_they_were_relative_to_the_body_scaled(bow):
    given = transfer(bow, TALL, SMALL)
    middle = len(bow.root) // 2
    seen = []
    for skeleton, clip in ((TALL, bow), (SMALL, given)):
        places, _ = forward(clip.rotations[middle], clip.root[middle], skeleton.offsets)
        reach = places[INDEX["right_hand"]] - places[INDEX["right_upper_arm"]]
        arm = np.linalg.norm(skeleton.offsets[[INDEX["right_lower_arm"], INDEX["right_hand"]]], axis=-1).sum()
        seen.append(reach / arm)
    assert np.linalg.norm(seen[0] - seen[1]) < 0.03


def test_what_is_no_posture_comes_along(bow):
    given = transfer(bow, TALL, SMALL)
    fingers = [i for i, name in enumerate(LINKS) if i >= 15]
    assert np.array_equal(given.rotations[:, fingers], bow.rotations[:, fingers])
    for name in ("importance", "contacts", "targets"):
        assert np.array_equal(getattr(given, name), getattr(bow, name))


def test_keyframes_are_given_as_postures(bow):
    keys = [0, 40, 89]
    header = msgspec.structs.replace(bow.header, times=(0.2, 0.6, 1.0))
    three = replace(
        bow, rotations=bow.rotations[keys], root=bow.root[keys], importance=bow.importance[keys],
        contacts=bow.contacts[keys], targets=None, header=header,
    )  # fmt: skip
    given = transfer(three, TALL, SMALL)
    assert given.header.times == (0.2, 0.6, 1.0)
    points = foot_points(SMALL, given.rotations, given.root)
    assert np.abs(points[..., 2]).max() < 0.02
