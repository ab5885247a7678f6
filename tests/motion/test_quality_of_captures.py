"""The figures of real capture, on the skeleton of whoever performed it, beside those that are known of it."""

from __future__ import annotations

import pytest

from ahmss.body.links import LINKS
from ahmss.body.skeleton import Skeleton
from ahmss.errors import DataError
from ahmss.motion.importing import import_clip, read_source
from ahmss.motion.quality import measure
from ahmss.motion.sourcequality import measure_file, measure_source

from .mocap import capture_path


def figures(name):
    return measure_source(read_source(capture_path(name))).figures()


def test_real_standing_measures_as_known():
    found = figures("A01_Stand")
    assert found["support_speed_mean"] == pytest.approx(0.004, abs=0.001)
    assert found["support_speed_p95"] == pytest.approx(0.008, abs=0.003)
    assert found["slide_per_stance_cm"] == pytest.approx(1.6, abs=0.1)
    assert found["alpha_max"] == pytest.approx(30.0, rel=0.05)
    assert found["alpha_p99"] == pytest.approx(19.0, rel=0.05)
    assert found["jerk_max"] == pytest.approx(1300.0, rel=0.05)
    assert found["contact_drift_mm"] < 5.0


def test_real_straight_walking_measures_as_known():
    found = figures("B03_Walk1")
    assert 0.037 < found["support_speed_mean"] < 0.073
    assert 0.146 < found["support_speed_p95"] < 1.1 * 0.212
    assert 4.2 < found["slide_per_stance_cm"] < 1.02 * 6.5
    assert 259.0 < found["alpha_max"] < 382.0
    assert 0.99 * 98.0 < found["alpha_p99"] < 213.0
    assert 1e4 < found["jerk_max"] < 1.5e4


def test_a_real_turn_measures_as_known():
    found = figures("B09_WalkTurnLeft90")
    assert found["support_speed_mean"] == pytest.approx(0.041, abs=0.011)
    assert found["support_speed_p95"] == pytest.approx(0.165, rel=0.12)
    assert found["slide_per_stance_cm"] == pytest.approx(6.3, rel=0.1)
    assert found["alpha_max"] == pytest.approx(298.0, rel=0.06)
    assert found["alpha_p99"] == pytest.approx(92.0, rel=0.03)
    assert found["jerk_max"] == pytest.approx(13600.0, rel=0.07)


def test_a_glitch_of_capture_is_seen_and_named():
    quality = measure_source(read_source(capture_path("B02_WalkToStand")))
    assert quality.joints.acceleration_max == pytest.approx(1118.0, rel=0.01)
    assert quality.names[quality.joints.joint] == "RightFoot"
    assert quality.names[quality.pop.joint] == "RightFoot"
    assert quality.pop.degrees > 90.0


def test_a_file_is_measured_as_it_is_and_its_limits_are_a_humans():
    path = capture_path("B03_Walk1")
    skeleton = Skeleton.of(1.65, "female")
    found, own = measure_file(path, skeleton), measure_source(read_source(path))
    assert own.excess.degrees == 0.0
    clip, _ = import_clip(path, skeleton, rate=None)
    imported = measure(clip.rotations, clip.root, clip.rate, skeleton, clip.contacts)
    assert found.excess == imported.excess
    assert {**found.figures(), "joint_limit_excess_deg": 0.0} == own.figures()


def test_an_imported_walk_slides_no_more_than_its_source():
    path = capture_path("B09_WalkTurnLeft90")
    skeleton = Skeleton.of(1.76)
    clip, _ = import_clip(path, skeleton)
    found = measure(clip.rotations, clip.root, clip.rate, skeleton, clip.contacts)
    assert found.support.slide_mean <= measure_source(read_source(path)).support.slide_mean
    assert max(found.drifts) < 0.02
    assert found.names == LINKS


def test_what_is_damaged_says_so(tmp_path):
    path = tmp_path / "walk.bvh"
    path.write_text("HIERARCHY\nROOT")
    with pytest.raises(DataError, match=r"walk\.bvh"):
        measure_file(path, Skeleton.of())
