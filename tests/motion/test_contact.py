"""Contact by height and speed together."""

import numpy as np
import pytest

from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.motion.contact import bearing, contacts, foot_points, runs, speeds
from ahmss.motion.importing import read_source
from ahmss.motion.naming import parts_of
from ahmss.motion.sourcequality import foot_points_of

from .mocap import capture_path

RATE = 60.0


def test_foot_points_stand_under_the_ankles(skeleton):
    rotations, root = skeleton.upright()
    points = foot_points(skeleton, rotations, root)
    places, _ = forward(rotations, root, skeleton.offsets)
    assert points.shape == (2, 3, 3)
    for foot, name in enumerate(("right_foot", "left_foot")):
        heel, ball, toe = points[foot]
        assert heel[0] < places[INDEX[name], 0] < ball[0] < toe[0]
        assert np.allclose(points[foot, :, 2], 0.0, atol=1e-12)
    assert np.allclose(points[0] * (1.0, -1.0, 1.0), points[1])


def test_runs_are_half_open():
    assert runs(np.array([1, 1, 0, 0, 1, 0, 1], bool)) == [(0, 2), (4, 5), (6, 7)]
    assert runs(np.zeros(4, bool)) == []


def test_speed_of_a_straight_way():
    points = np.stack([np.arange(10) * 0.02, np.zeros(10), np.arange(10) * -0.01], axis=-1)
    assert np.allclose(speeds(points, RATE), np.hypot(0.02, 0.01) * RATE)


@pytest.mark.parametrize(
    ("height", "speed", "frames", "bears"),
    [
        (0.02, 0.1, 60, True),
        (0.02, 3.0, 60, False),  # the toe that swings past low
        (0.10, 0.0, 60, False),  # held in the air
        (0.02, 0.1, 4, False),  # too short
        (0.02, 0.1, 8, True),  # the speed of being set down and lifted takes two
    ],
)
def test_a_point_bears_when_low_and_slow_for_long_enough(height, speed, frames, bears):
    points = np.zeros((frames + 40, 1, 3))
    points[:, 0, 2] = 0.5
    middle = slice(20, 20 + frames)
    points[middle, 0, 2] = height
    points[:, 0, 0] = np.arange(len(points)) * speed / RATE
    assert bool(bearing(points, RATE).any()) is bears


def test_standing_is_contact_of_both_feet_and_a_raised_one_is_not(skeleton):
    pose, place = skeleton.upright()
    rotations, root = np.repeat(pose[None], 30, axis=0), np.repeat(place[None], 30, axis=0)
    assert np.array_equal(contacts(skeleton, rotations, root, RATE), np.ones((30, 2)))
    knee = INDEX["right_lower_leg"]
    rotations[:, knee] = (np.cos(0.5), 0.0, np.sin(0.5), 0.0)
    assert np.array_equal(contacts(skeleton, rotations, root, RATE), np.tile([0.0, 1.0], (30, 1)))


def test_real_walking_steps_in_turn():
    source = read_source(capture_path("B03_Walk1"))
    points = foot_points_of(source, parts_of(source))
    bears = bearing(points.reshape(-1, 6, 3), source.rate).reshape(-1, 2, 3).any(axis=-1)
    share = bears.mean(axis=0)
    assert np.all((share > 0.55) & (share < 0.8))
    assert bears.any(axis=-1).mean() > 0.95  # walking is never off the ground
    by_height = (points[..., 2] < 0.05).any(axis=-1)
    assert by_height.mean() > bears.mean() + 0.03  # which the swinging toe deceives
