"""The measures against motions whose figures are known by hand, and against those known of real capture."""

import numpy as np
import pytest

from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_rotation_vector, multiply
from ahmss.motion.contact import bearing
from ahmss.motion.quality import joint_motion, measure, pops, support, worst_pop

from .bvh import foot_points as bvh_points
from .bvh import read

RATE = 60.0


def about_y(angles):
    """Rotations (frames, 1, 4) by angles (frames,)."""
    return from_rotation_vector(np.stack([0.0 * angles, angles, 0.0 * angles], axis=-1))[:, None]


@pytest.mark.parametrize("rate", [30.0, 60.0, 120.0])
def test_a_sine_has_the_acceleration_and_jerk_of_its_derivatives(rate):
    t = np.arange(int(4 * rate)) / rate
    omega, size = 2.0 * np.pi * 0.8, 0.5
    found = joint_motion(about_y(size * np.sin(omega * t)), rate)
    assert found.acceleration_max == pytest.approx(size * omega**2, rel=0.03)
    assert found.jerk_max == pytest.approx(size * omega**3, rel=0.05)
    assert 0.9 * found.acceleration_max < found.acceleration_p99 <= found.acceleration_max


def test_the_worst_joint_is_named():
    rotations = np.tile([1.0, 0.0, 0.0, 0.0], (120, 43, 1))
    t = np.arange(120) / RATE
    rotations[:, 11] = about_y(0.3 * np.sin(6.0 * t))[:, 0]
    assert joint_motion(rotations, RATE).joint == 11


def test_less_than_half_a_second_is_not_judged():
    assert joint_motion(about_y(np.arange(30) ** 2 * 0.1), RATE).acceleration_max == 0.0
    assert joint_motion(about_y(np.arange(31) ** 2 * 0.001), RATE).acceleration_max > 0.0
    assert joint_motion(about_y(np.arange(20) ** 2 * 0.1), RATE).acceleration_max == 0.0


def test_a_pop_is_the_step_against_its_neighbours_mean():
    angles = np.radians(np.arange(30) * 1.0)
    angles[15:] += np.radians(3.0)
    found = worst_pop(np.repeat(about_y(angles), 43, axis=1))
    assert found.degrees == pytest.approx(3.0)
    assert found.frame == 15
    assert np.allclose(pops(about_y(np.radians(np.arange(10) * 5.0))), 0.0, atol=1e-5)  # even motion has none


def test_signs_of_quaternions_are_no_pop():
    rotations = np.repeat(about_y(np.radians(np.arange(30) * 1.0)), 43, axis=1)
    rotations[::2] *= -1.0
    assert worst_pop(rotations).degrees < 1e-6


def test_standing_still_measures_nothing(skeleton):
    pose, place = skeleton.upright()
    quality = measure(np.repeat(pose[None], 90, 0), np.repeat(place[None], 90, 0), RATE, skeleton)
    assert quality.joints.acceleration_max < 1e-6
    assert quality.support.speed_mean < 1e-12
    assert len(quality.support.slides) == 2
    assert len(quality.support.drifts) == 6
    assert quality.support.drift_max < 1e-12
    assert quality.pop.degrees < 1e-6


def test_a_sliding_body_drifts_at_every_contact(skeleton):
    pose, place = skeleton.upright()
    root = place + np.stack([np.arange(60) * 0.1 / RATE, np.zeros(60), np.zeros(60)], axis=-1)
    found = measure(np.repeat(pose[None], 60, 0), root, RATE, skeleton).support
    assert found.speed_mean == pytest.approx(0.1)
    assert found.drift_max == pytest.approx(0.1 * 59 / RATE)
    assert found.slide_mean == pytest.approx(0.1)


def test_a_contact_that_is_known_not_to_be_is_not_counted(skeleton):
    pose, place = skeleton.upright()
    contacts = np.ones((60, 2))
    contacts[:, 0] = 0.0
    found = measure(np.repeat(pose[None], 60, 0), np.repeat(place[None], 60, 0), RATE, skeleton, contacts)
    assert len(found.support.drifts) == 3
    assert len(found.support.slides) == 1


def test_a_pivot_shows_where_the_slower_point_hides_it(skeleton):
    """Turning on the heel: support speed is nought, the toe's drift is not."""
    pose, place = skeleton.upright()
    rotations = np.repeat(pose[None], 60, 0)
    foot = INDEX["right_foot"]
    yaw = from_rotation_vector(np.stack([np.zeros(60), np.zeros(60), np.linspace(0.0, 0.5, 60)], axis=-1))
    rotations[:, foot] = multiply(rotations[:, foot], yaw)
    found = measure(rotations, np.repeat(place[None], 60, 0), RATE, skeleton).support
    assert found.speed_mean < 1e-9
    assert found.drift_max > 0.05


def capture(name):
    """Support and joint figures of a clip of real capture."""
    motion = read(name)
    points = bvh_points(motion)
    bears = bearing(points.reshape(-1, 6, 3), motion.rate).reshape(-1, 2, 3)
    joints = [i for i, node in enumerate(motion.names) if not node.endswith(" end")]
    return support(points, bears, motion.rate), joint_motion(motion.rotations[:, joints], motion.rate)


def test_real_standing_measures_as_known():
    feet, joints = capture("A01_Stand")
    assert feet.speed_mean == pytest.approx(0.004, abs=0.002)
    assert feet.speed_p95 == pytest.approx(0.008, abs=0.003)
    assert 100.0 * feet.slide_mean == pytest.approx(1.6, abs=0.3)
    assert joints.acceleration_max == pytest.approx(30.0, rel=0.15)
    assert joints.acceleration_p99 == pytest.approx(19.0, rel=0.15)
    assert joints.jerk_max == pytest.approx(1300.0, rel=0.15)


def test_real_straight_walking_measures_as_known():
    feet, joints = capture("B03_Walk1")
    assert 0.037 < feet.speed_mean < 0.080
    assert 0.146 < feet.speed_p95 < 0.25
    assert 4.0 < 100.0 * feet.slide_mean < 6.6
    assert 230.0 < joints.acceleration_max < 390.0
    assert 80.0 < joints.acceleration_p99 < 215.0
    assert 9e3 < joints.jerk_max < 1.5e4


def test_real_turning_measures_as_known():
    feet, joints = capture("B09_WalkTurnLeft90")
    assert feet.speed_mean == pytest.approx(0.041, abs=0.015)
    assert 100.0 * feet.slide_mean == pytest.approx(6.3, abs=1.5)
    assert joints.acceleration_max == pytest.approx(298.0, rel=0.15)
    assert joints.acceleration_p99 == pytest.approx(92.0, rel=0.15)


def test_a_glitch_of_capture_is_seen():
    _, joints = capture("B02_WalkToStand")
    assert joints.acceleration_max > 900.0
