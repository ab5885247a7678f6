"""(5.1) and (5.2), the still stretch, and where the subject faces."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.quaternion import from_rotation_vector, multiply, normalize
from ahmss.capture.calibration import (
    calibrate,
    heading_of_sensors,
    link_rotations,
    mean_rotation,
    sensor_to_link,
    still_stretches,
)
from ahmss.capture.casting import performance_of
from ahmss.capture.config import TransmitterConfig
from ahmss.capture.performance import Performance, begun_upright
from ahmss.errors import DataError
from tests.capture.taken import (
    RATE,
    SUBJECT,
    degrees_between,
    inverse_mounts,
    performed,
    reversed_in_time,
    standing,
    take_of,
    turned,
    upright_links,
)
from tests.motion.mocap import capture_path


def test_the_constant_turn_brings_any_sensor_to_its_link():
    generator = np.random.default_rng(4)
    mount, upright, later = (normalize(generator.normal(size=(15, 4))) for _ in range(3))
    turns = sensor_to_link(multiply(upright, mount), upright)
    np.testing.assert_allclose(degrees_between(link_rotations(multiply(later, mount), turns), later), 0.0, atol=1e-5)
    assert degrees_between(turns, mount).min() > 1.0  # it is the mount's inverse, not the mount


@pytest.mark.parametrize(
    "transmitter",
    [
        TransmitterConfig(),
        TransmitterConfig((-1.0, 0.3, 0.0), 50.0),
        TransmitterConfig((0.0, 0.0, 2.2), -20.0, upside_down=True),
    ],
)
def test_all_rotations_come_back_wherever_the_transmitter_stands(transmitter):
    performance = performed("lift", transmitter.facing_deg)
    take, mounts = take_of(performance, transmitter=transmitter, seed=3)
    found = calibrate(take)
    assert degrees_between(found.sensor_to_link, inverse_mounts(mounts)).max() < 1e-4
    links = link_rotations(take.world_rotations(), found.sensor_to_link)
    assert degrees_between(links, performance.links()[1]).max() < 1e-4
    first, end = performance.upright
    assert first <= found.stretch[0] < found.stretch[1] <= end
    assert np.degrees(found.facing) == pytest.approx(transmitter.facing_deg)


def test_a_heading_that_is_given_is_taken():
    performance = performed("lift", 65.0)
    take, mounts = take_of(performance)
    found = calibrate(take, facing=np.radians(65.0))
    assert degrees_between(found.sensor_to_link, inverse_mounts(mounts)).max() < 1e-4
    wrong = calibrate(take)  # along the transmitter's x
    assert np.degrees(wrong.doubt) == pytest.approx(65.0, abs=8.0)
    assert degrees_between(wrong.sensor_to_link, inverse_mounts(mounts)).min() > 60.0


@pytest.mark.parametrize("facing", [0.0, 130.0, -175.0])
def test_the_sensors_places_tell_the_heading_to_a_few_degrees(facing):
    take, _ = take_of(performed("lift", facing))
    seen = np.degrees(heading_of_sensors(take, (0, 60)))
    assert abs((seen - facing + 180.0) % 360.0 - 180.0) < 8.0
    assert calibrate(take, facing=None).facing == pytest.approx(np.radians(seen))


def test_upright_at_the_end_is_found_where_the_take_begins_seated():
    performance = reversed_in_time(performed("sit"))
    take, _ = take_of(performance)
    first, end = still_stretches(take)[0]
    assert performance.upright[0] <= first < end <= performance.upright[1]


def test_upright_at_the_start_is_found_where_the_take_ends_seated():
    performance = performed("sit")
    first, end = still_stretches(take_of(performance)[0])[0]
    assert performance.upright[0] <= first < end <= performance.upright[1]
    assert end - first == 60


def ending_upright(rotations: Array, root: Array) -> Performance:
    """Some frames, and then two seconds of standing upright."""
    upright, place = SUBJECT.upright()
    count = round(2.0 * RATE)
    return Performance(
        np.concatenate([rotations, upright[None].repeat(count, axis=0)]),
        np.concatenate([root, place[None].repeat(count, axis=0)]),
        RATE, SUBJECT, "ends upright", (len(rotations), len(rotations) + count),
    )  # fmt: skip


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_who_hardly_moves_at_a_door_does_not_beat_who_stands_upright_at_the_end(seed):
    opening = performed("door_open")
    begun = opening.upright[1]
    middle = (begun + opening.frames) // 2  # with the hand on the lever
    backwards = slice(middle, begun - 1, -1)
    performance = ending_upright(opening.rotations[backwards], opening.root[backwards])
    take, mounts = take_of(performance, seed=seed)
    found = calibrate(take)
    assert performance.upright[0] <= found.stretch[0] < found.stretch[1] <= performance.upright[1]
    assert degrees_between(found.sensor_to_link, inverse_mounts(mounts)).max() < 1e-3


def test_who_sways_does_not_beat_who_stands_perfectly_still():
    upright, place = SUBJECT.upright()
    sway = np.radians(2.0) * np.sin(2.0 * np.pi * np.arange(90) / RATE)
    rotations, root = upright[None].repeat(90, axis=0), place[None].repeat(90, axis=0)
    rotations[:, 0] = multiply(from_rotation_vector(sway[:, None] * np.array([1.0, 0.0, 0.0])), rotations[:, 0])
    swaying = take_of(Performance(rotations, root, RATE, SUBJECT, "sways", (0, 90)))[0]
    assert 1.0 < calibrate(swaying).stillness < 2.0  # who does nothing else is taken so, and told to stand stiller
    lift = performed("lift")
    there = slice(lift.upright[1], (lift.upright[1] + lift.frames) // 2)
    down, deep = lift.rotations[there], lift.root[there]
    performance = ending_upright(
        np.concatenate([rotations, down, down[::-1]]), np.concatenate([root, deep, deep[::-1]])
    )
    found = calibrate(take_of(performance)[0])
    assert found.stretch[0] >= performance.upright[0]
    assert found.stillness < 0.01


def at_ease(seconds: float = 2.0) -> Performance:
    """Stands upright, then at ease, arms a little open and bent: all but as tall."""
    rotations, root = SUBJECT.relaxed()
    count = round(seconds * RATE)
    motion = rotations[None].repeat(count, axis=0), root[None].repeat(count, axis=0)
    return begun_upright(motion, RATE, SUBJECT, seconds, "at ease")


@pytest.mark.parametrize("noise", ["none", "full"])
@pytest.mark.parametrize("backwards", [False, True])
def test_who_stands_at_ease_before_or_after_is_told_from_who_stands_upright(backwards, noise):
    performance = reversed_in_time(at_ease()) if backwards else at_ease()
    upright, other = still_stretches(take_of(performance, noise=noise)[0])
    assert performance.upright[0] - 6 <= upright[0] < upright[1] <= performance.upright[1] + 6
    assert (other[1] <= upright[0]) == backwards


@pytest.mark.parametrize("clip", ["A01", "A05", "B01"])  # who stand at ease for a second somewhere
@pytest.mark.parametrize("facing", [0.0, 120.0])
def test_real_people_upright_at_the_end(clip, facing):
    performance = turned(reversed_in_time(performance_of(str(capture_path(clip)), SUBJECT)), facing)
    take, mounts = take_of(performance)
    found = calibrate(take, facing=np.radians(facing))
    assert degrees_between(found.sensor_to_link, inverse_mounts(mounts)).max() < 0.1
    assert len(found.others) == 1


def test_jitter_does_not_hide_who_stands_still():
    take, _ = take_of(performed("lift"), noise="resolution")
    found = calibrate(take)
    assert found.stretch[1] <= performed("lift").upright[1]
    assert 0.05 < found.stillness < 0.2  # table 5.2: 0.1 degrees RMS


def test_a_stretch_that_is_marked_is_taken_and_must_lie_in_the_take():
    take, _ = take_of(standing(2.0))
    assert calibrate(take, stretch=(10, 40)).stretch == (10, 40)
    with pytest.raises(DataError, match="upright"):
        calibrate(take, stretch=(10, 4000))


def test_nobody_stands_still():
    take, _ = take_of(performed("lift"))
    turn = from_rotation_vector(np.arange(take.frames)[:, None] * np.array([0.0, 0.0, 0.05]))
    take.rotations[:] = multiply(turn[:, None], take.rotations)
    with pytest.raises(DataError, match="--upright"):
        still_stretches(take)


def test_the_posture_counts_that_the_subject_took():
    performance = performed("lift")
    take, mounts = take_of(performance)
    later = (performance.frames - 20, performance.frames)
    bent = performance.links()[1][-1]
    found = calibrate(take, bent, later)
    assert degrees_between(found.sensor_to_link, inverse_mounts(mounts)).max() < 0.1
    assert degrees_between(calibrate(take, None, later).sensor_to_link, inverse_mounts(mounts)).max() > 10.0


def test_a_mean_of_rotations_ignores_their_signs():
    middle = upright_links(20.0)
    away = from_rotation_vector(np.array([[0.1, 0.0, 0.0], [-0.1, 0.0, 0.0]]))
    both = multiply(away[:, None], middle[None]) * np.array([1.0, -1.0])[:, None, None]
    np.testing.assert_allclose(degrees_between(mean_rotation(both), middle), 0.0, atol=1e-5)
