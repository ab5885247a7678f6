"""A motion through simulator process, line, driver and calibration, and what comes back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, rotate
from ahmss.capture.calibration import Calibration, calibrate, link_rotations
from ahmss.capture.config import load
from ahmss.capture.record import record
from ahmss.capture.repair import fill
from ahmss.capture.take import Take
from ahmss.motion import archive
from tests.capture.stage import simulated
from tests.capture.taken import degrees_between, heading
from tests.motion.mocap import capture_path

_BACK = np.array([0.0, 0.0, 1.0])  # of the hips


def back_from(folder: Path, subject: str, *options: str, seconds: float = 4.0) -> tuple[Take, dict[str, Array]]:
    """What was recorded, and the truth."""
    truth = folder / "truth.npz"
    with simulated(folder, subject, "--truth", str(truth), "--seed", "7", *options) as config:
        take, losses = record(load(config), seconds, lambda _: None)
    assert {"--kind", "--noise"} & set(options) or "nothing lost" in losses
    return take, archive.read(truth, "truth")


def calibrated(take: Take, truth: dict[str, Array]) -> Calibration:
    """By the posture that the subject really took, which faces along the pelvis, as of one who faces +x."""
    posture = truth["links"][truth["upright"][0]]
    x, y, _ = -rotate(posture[0], _BACK)
    facing = float(np.arctan2(y, x))
    return calibrate(take, multiply(conjugate(heading(np.degrees(facing))), posture), facing=facing)


def errors(take: Take, truth: dict[str, Array], found: Calibration) -> Array:
    """Degrees (F, 15) between the links as they come back and as they were."""
    links, true = link_rotations(take.world_rotations(), found.sensor_to_link), truth["links"]
    count = min(len(links), len(true))
    return degrees_between(links[:count], true[:count])


def test_real_motion_comes_back_and_the_mounts_are_found(tmp_path):
    take, truth = back_from(tmp_path, str(capture_path("A05")), "--clock", "poll")
    assert take.frames >= 240
    found = calibrated(take, truth)
    assert degrees_between(found.sensor_to_link, truth["sensor_to_link"]).max() < 0.1
    assert np.median(errors(take, truth, found)) < 0.2
    assert errors(take, truth, found).max() < 0.2
    moved = degrees_between(truth["links"][240], truth["links"][0])
    assert np.median(moved) > 2.0  # it was a motion


@pytest.mark.parametrize(
    "clip", ["A05", pytest.param("B01", marks=pytest.mark.long)]
)  # their first stances face 2 and 7 degrees aside in the file
def test_calibrated_as_a_user_does_it_without_knowing_the_truth(tmp_path, clip):
    """Heading and posture are those that the written configuration and the calibration assume."""
    take, truth = back_from(tmp_path, str(capture_path(clip)), "--clock", "poll")
    found = calibrate(take)
    assert degrees_between(found.sensor_to_link, truth["sensor_to_link"]).max() < 0.1
    error = errors(take, truth, found)
    assert np.median(error) < 0.2
    assert error.max() < 0.2


@pytest.mark.long
@pytest.mark.parametrize(
    ("clip", "level"),
    [("B03", "none"), ("B12", "none"), ("A05", "none"), ("A05", "resolution"), ("A01", "resolution"), ("A05", "full")],
)  # with noise those who stay within the transmitter's reach
def test_whole_clips_come_back(tmp_path, clip, level):
    take, truth = back_from(tmp_path, str(capture_path(clip)), "--clock", "poll", "--noise", level, seconds=9.0)
    error = errors(take, truth, calibrated(take, truth))
    print(clip, level, np.median(error).round(4), np.sqrt((error**2).mean()).round(4))
    allowed = {"none": 0.001, "resolution": 0.11, "full": 3.0 * np.sqrt(2.0)}  # table 5.2, upright and now
    assert np.sqrt((error**2).mean()) < allowed[level] * 1.2
    assert np.median(error) < allowed[level]


@pytest.mark.long
def test_four_real_lines_of_a_fastrak_bring_it_back(tmp_path):
    take, truth = back_from(tmp_path, str(capture_path("A05")), "--kind", "fastrak", "--rate", "30", "--baud", "115200")
    assert take.rate == pytest.approx(30.0, abs=0.6)
    assert (take.missing.mean(axis=0) < 0.05).all()
    found = calibrated(fill(take), truth)
    assert degrees_between(found.sensor_to_link, truth["sensor_to_link"]).max() < 0.1
