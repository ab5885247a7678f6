"""What the simulated sensors measure: mounting, transmitter, and the errors of table 5.2."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.links import LINKS
from ahmss.capture.config import TransmitterConfig
from ahmss.capture.simulator.noise import REACH, Noise
from ahmss.capture.simulator.options import SimulatorOptions
from ahmss.capture.simulator.sensors import Mounts, measure, save_truth
from ahmss.capture.simulator.stage import Stage
from ahmss.motion import archive
from tests.capture.simulated import angles_between, as_rotation, subject

FOOT = 0.3048
INCH = 0.0254


def test_a_straight_sensor_sees_an_upright_head_through_a_transmitter_that_looks_forward_and_down():
    performance = subject(moving=False)
    transmitter = TransmitterConfig(position=(-1.0, 0.2, 0.1))
    rotations, positions = measure(performance, Mounts.straight(), transmitter)
    joints, _ = performance.links()
    x, y, z = joints[0, LINKS.index("head")]
    assert positions[0, LINKS.index("head")] == pytest.approx([x + 1.0, 0.2 - y, 0.1 - z])
    # The foot's axes are the world's; the transmitter's y and z point the other way.
    axes = as_rotation(rotations[0, LINKS.index("right_foot")]).as_matrix()[0]
    assert axes == pytest.approx(np.diag([1.0, -1.0, -1.0]), abs=1e-9)


def test_a_sensor_askew_gives_its_link_back_by_the_constant_of_5_1_and_5_2():
    performance = subject()
    mounts = Mounts.askew(performance.skeleton, 5)
    rotations, _ = measure(performance, mounts, TransmitterConfig())
    _, links = performance.links()
    for sensor in range(15):
        to_world = as_rotation(np.array([0.0, 1.0, 0.0, 0.0])) * as_rotation(rotations[:, sensor])
        constant = to_world[0].inv() * as_rotation(links[0, sensor])
        back = (to_world * constant).as_quat()
        assert angles_between(np.roll(back, 1, axis=-1), links[:, sensor]).max() < 1e-5


def test_a_sensor_sits_on_the_skin_and_goes_with_its_link():
    performance = subject()
    mounts = Mounts.askew(performance.skeleton, 5)
    _, positions = measure(performance, mounts, TransmitterConfig(position=(0.0, 0.0, 0.0), upside_down=True))
    joints, links = performance.links()
    for sensor in range(15):
        expected = joints[:, sensor] + as_rotation(links[:, sensor]).apply(mounts.places[sensor])
        assert positions[:, sensor] == pytest.approx(expected)
        across = np.hypot(*(mounts.places[sensor] - mounts.places[sensor, 0] / max(
            performance.skeleton.tips[sensor, 0], 1e-9) * performance.skeleton.tips[sensor])[1:])  # fmt: skip
        assert across == pytest.approx(performance.skeleton.radii[sensor])


def test_the_seed_says_how_the_sensors_sit():
    skeleton = subject().skeleton
    one, again, other = (Mounts.askew(skeleton, seed) for seed in (1, 1, 2))
    assert (one.rotations == again.rotations).all()
    assert (one.places == again.places).all()
    assert angles_between(one.rotations, other.rotations).min() > 1.0
    assert np.median(angles_between(one.rotations, np.tile([1.0, 0, 0, 0], (15, 1)))) > 45.0


def test_the_truth_file_holds_what_a_calibration_should_find(tmp_path):
    performance = subject()
    mounts = Mounts.askew(performance.skeleton, 3)
    save_truth(tmp_path / "truth.npz", performance, mounts, TransmitterConfig(position=(-1.0, 0.0, 0.0)))
    truth = archive.read(tmp_path / "truth.npz", "truth")
    assert angles_between(truth["sensor_to_link"], mounts.rotations * [1, -1, -1, -1]).max() < 1e-6
    assert truth["links"].shape == (90, 15, 4)
    assert truth["transmitter"].tolist() == [-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]
    assert truth["upright"].tolist() == [0, 30]


@pytest.mark.parametrize(("feet", "accuracy", "resolution"), [(5.0, 1.0, 0.05), (10.0, 2.0, 0.15), (15.0, 3.0, 0.25)])
def test_errors_are_those_of_table_5_2(feet, accuracy, resolution):
    random = np.random.default_rng(0)
    angle, shift, jitter_angle, jitter = [], [], [], []
    for seed in range(60):
        noise, quiet = Noise("full", seed), Noise("resolution", seed)
        away = random.standard_normal((15, 3))
        places = feet * FOOT * away / np.linalg.norm(away, axis=-1, keepdims=True)
        upright = np.tile([1.0, 0.0, 0.0, 0.0], (15, 1))
        turned, moved = noise(upright, places, 7)
        angle.append(angles_between(upright, turned))
        shift.append(np.linalg.norm(moved - places, axis=-1) / INCH)
        turned, moved = quiet(upright, places, 7)
        jitter_angle.append(angles_between(upright, turned))
        jitter.append(np.linalg.norm(moved - places, axis=-1) / INCH)
    rms = [np.sqrt(np.mean(np.square(values))) for values in (angle, shift, jitter_angle, jitter)]
    assert rms == pytest.approx([3.0, accuracy, 0.1, resolution], rel=0.1)


def test_the_field_is_smooth_in_space_and_the_jitter_is_not_in_time():
    noise = Noise("full", 1)
    places = np.zeros((15, 3)) + np.arange(15)[:, None] * np.array([0.01, 0.0, 0.0]) + [1.5, 0.0, 0.0]
    upright = np.tile([1.0, 0.0, 0.0, 0.0], (15, 1))
    turned, moved = noise(upright, places, 0)
    quiet = np.diff(np.linalg.norm(moved - places, axis=-1))
    assert np.abs(quiet).max() < 0.01  # neighbours a centimetre apart are off by nearly the same
    assert angles_between(turned[:-1], turned[1:]).max() < 1.0
    again, _ = noise(upright, places, 0)
    later, _ = noise(upright, places, 1)
    assert (again == turned).all()
    assert angles_between(turned, later).min() > 0.0


def test_without_noise_nothing_is_out_of_reach_and_with_it_what_is_farther_than_fifteen_feet():
    far = TransmitterConfig(position=(-REACH - 0.3, 0.0, 0.0))
    quiet = Stage(SimulatorOptions(subject(), transmitter=far))
    noisy = Stage(SimulatorOptions(subject(), transmitter=far, noise="resolution"))
    assert not any(quiet.sense(station, 0.0, 0).far for station in range(1, 16))
    assert all(noisy.sense(station, 0.0, 0).far for station in range(1, 16))


def test_between_two_frames_of_the_subject_its_motion_is_interpolated():
    performance = subject()
    stage = Stage(SimulatorOptions(performance))
    rotations, positions = measure(performance, Mounts.askew(performance.skeleton, 0), stage_transmitter())
    sensed = stage.sense(3, 50.5 / 60.0, 0)
    assert sensed.position == pytest.approx((positions[50, 2] + positions[51, 2]) / 2)
    step = angles_between(rotations[50, 2], rotations[51, 2])[0]
    assert angles_between(rotations[50, 2], sensed.rotation)[0] == pytest.approx(step / 2)


@pytest.mark.parametrize(("after", "frame"), [("hold", 89), ("loop", 10)])
def test_after_its_end_a_performance_is_held_or_begins_again(after, frame):
    stage = Stage(SimulatorOptions(subject(), after=after))
    end, expected = stage.sense(1, 100 / 60.0, 0), stage.sense(1, frame / 60.0, 0)
    assert end.position == pytest.approx(expected.position)
    assert not stage.over(100 / 60.0)


def test_after_its_end_a_performance_may_be_over():
    stage = Stage(SimulatorOptions(subject(), after="stop"))
    assert not stage.over(89 / 60.0)
    assert stage.over(90 / 60.0)


def stage_transmitter():
    return SimulatorOptions(subject()).transmitter
