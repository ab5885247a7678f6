"""The measures against motions whose figures are known by hand, and against those known of real capture."""

import numpy as np
import pytest

from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import from_rotation_vector, multiply, rotate
from ahmss.motion.fingers import opened
from ahmss.motion.quality import beyond_limits, measure
from ahmss.motion.smoothness import joint_motion, pops, worst_pop

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


def still(skeleton, frames=60):
    """The upright pose held: rotations, root."""
    pose, place = skeleton.upright()
    return np.repeat(pose[None], frames, 0), np.repeat(place[None], frames, 0)


def test_standing_still_measures_nothing(skeleton):
    quality = measure(*still(skeleton, 90), RATE, skeleton)
    assert len(quality.support.slides) == 2
    assert len(quality.drifts) == 6
    assert list(quality.figures()) == [
        "support_speed_mean", "support_speed_p95", "slide_per_stance_cm", "alpha_max", "alpha_p99", "jerk_max",
        "pop_deg", "contact_drift_mm", "floor_penetration_mm", "joint_limit_excess_deg",
    ]  # fmt: skip
    assert max(quality.figures().values()) < 1e-4


def sliding(skeleton, speed):
    """The upright pose carried along the floor."""
    rotations, root = still(skeleton)
    return rotations, root + np.stack([np.arange(60) * speed / RATE, np.zeros(60), np.zeros(60)], axis=-1)


def test_a_sliding_body_drifts_at_every_contact(skeleton):
    found = measure(*sliding(skeleton, 0.1), RATE, skeleton)
    assert found.support.speed_mean == pytest.approx(0.1)
    assert found.support.slide_mean == pytest.approx(0.1)
    assert found.drifts == pytest.approx([0.1 * 59 / RATE] * 6)
    assert found.figures()["contact_drift_mm"] == pytest.approx(100.0 * 59 / RATE)
    assert found.figures()["slide_per_stance_cm"] == pytest.approx(10.0)


def test_a_foot_that_is_said_to_stand_drifts_however_fast_it_slides(skeleton):
    rotations, root = sliding(skeleton, 2.0)
    assert measure(rotations, root, RATE, skeleton).drifts == ()
    contacts = np.zeros((60, 2))
    contacts[:, 1] = 1.0
    said = measure(rotations, root, RATE, skeleton, contacts)
    assert said.drifts == pytest.approx([2.0 * 59 / RATE] * 3)  # heel, ball and toe tip of the left foot


def test_a_foot_that_is_said_to_stand_in_the_air_counts_by_its_lowest_point(skeleton):
    rotations, root = sliding(skeleton, 0.2)
    ankle = INDEX["right_foot"]
    rotations[:, ankle] = multiply(rotations[:, ankle], from_rotation_vector(np.array([0.0, 0.3, 0.0])))  # toes down
    root[:, 2] += 0.2
    found = measure(rotations, root, RATE, skeleton, np.tile([1.0, 0.0], (60, 1)))
    assert found.drifts == pytest.approx([0.2 * 59 / RATE])


def test_a_pivot_shows_where_the_slower_point_hides_it(skeleton):
    """Turning at the ankle: support speed is nought, the toe's drift is not."""
    rotations, root = still(skeleton)
    foot = INDEX["right_foot"]
    yaw = from_rotation_vector(np.stack([np.zeros(60), np.zeros(60), np.linspace(0.0, 0.5, 60)], axis=-1))
    rotations[:, foot] = multiply(rotations[:, foot], yaw)
    found = measure(rotations, root, RATE, skeleton)
    assert found.support.speed_mean < 1e-9
    assert max(found.drifts) > 0.05


def test_what_is_under_the_floor_is_told_in_millimetres(skeleton):
    rotations, root = still(skeleton)
    root[30:33, 2] -= 0.012
    assert measure(rotations, root, RATE, skeleton).figures()["floor_penetration_mm"] == pytest.approx(12.0)
    root[:, 2] += 0.5
    assert measure(rotations, root, RATE, skeleton).sunk == 0.0


def test_a_joint_beyond_its_limits_is_told_in_degrees(skeleton):
    rotations, _ = still(skeleton)
    assert beyond_limits(rotations, skeleton).degrees == 0.0
    knee = INDEX["left_lower_leg"]
    low = np.degrees(skeleton.limits[knee, 1, 0])
    backwards = from_rotation_vector(np.array([0.0, np.radians(low - 7.0), 0.0]))
    rotations[20, knee] = multiply(rotations[20, knee], backwards)
    found = beyond_limits(rotations, skeleton)
    assert found.degrees == pytest.approx(7.0)
    assert (found.frame, found.joint) == (20, knee)


@pytest.mark.parametrize("side", ["right", "left"])
def test_a_thumb_that_opposes_as_far_as_it_goes_is_within_its_limits(skeleton, side):
    rotations, _ = skeleton.upright()
    out = opened(side, opened(side))
    rotations[list(fingers(side))] = out
    assert beyond_limits(rotations[None], skeleton).degrees == 0.0
    ahead = rotate(out[0], np.array([1.0, 0.0, 0.0]))
    assert ahead[1] * (1.0 if side == "left" else -1.0) > 0.8  # out of the palm


def test_a_twisted_and_bent_forearm_is_no_sideways_bend(skeleton):
    rotations, _ = still(skeleton)
    elbow = INDEX["right_lower_arm"]
    bend, turn = from_rotation_vector(np.array([0.0, 1.6, 0.0])), from_rotation_vector(np.array([1.2, 0.0, 0.0]))
    rotations[:, elbow] = multiply(rotations[:, elbow], multiply(bend, turn))
    assert beyond_limits(rotations, skeleton).degrees < 1e-6
    rotations[:, elbow] = multiply(rotations[:, elbow], from_rotation_vector(np.array([0.5, 0.0, 0.0])))
    high = skeleton.limits[elbow, 0, 1]
    assert beyond_limits(rotations, skeleton).degrees == pytest.approx(np.degrees(1.7 - high))


def test_fingers_do_not_dilute_the_percentile(skeleton):
    rotations, root = still(skeleton, 120)
    swing = about_y(0.5 * np.sin(5.0 * np.arange(120) / RATE))
    rotations[:, :15] = multiply(rotations[:, :15], swing)
    joints = measure(rotations, root, RATE, skeleton).joints
    assert joints.acceleration_p99 == pytest.approx(0.5 * 25.0, rel=0.05)
    assert joints.acceleration_p99 > joint_motion(rotations, RATE).acceleration_p99
