"""Takes: frames put where their numbers say, the file, and what is wrong with a broken one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ahmss.capture.stations import Status, TrackerFrame
from ahmss.capture.take import TakeHeader, from_frames, load, save
from ahmss.errors import DataError
from ahmss.motion import archive
from tests.capture.taken import performed, take_of


def frame(number: int) -> TrackerFrame:
    rotations = np.tile([0.0, 1.0, 0.0, 0.0], (15, 1))
    return TrackerFrame(number, number / 60.0, rotations, np.full((15, 3), float(number)), np.zeros(15, np.uint8), 0.0)


def test_a_frame_that_never_came_leaves_a_gap_and_time_keeps_its_pace():
    take = from_frames([frame(7), frame(8), frame(11)], 60.0, TakeHeader(origin="here"))
    assert take.frames == 5
    np.testing.assert_allclose(take.times, np.arange(5) / 60.0)
    np.testing.assert_array_equal(take.status[:, 0], [0, 0, Status.MISSING, Status.MISSING, 0])
    np.testing.assert_array_equal(take.positions[[0, 1, 4], 3, 0], [7.0, 8.0, 11.0])
    assert not take.missing[[0, 1, 4]].any()
    assert take.missing[2:4].all()


def test_no_frames_make_no_take():
    with pytest.raises(DataError, match="doctor"):
        from_frames([], 60.0)


def test_a_file_holds_the_take_and_is_the_same_each_time(tmp_path):
    take, _ = take_of(performed())
    take.status[3, 4] = Status.WEAK
    save(take, tmp_path / "a.take.npz")
    save(take, tmp_path / "b.take.npz")
    assert (tmp_path / "a.take.npz").read_bytes() == (tmp_path / "b.take.npz").read_bytes()
    found = load(tmp_path / "a.take.npz")
    np.testing.assert_allclose(found.rotations, take.rotations, atol=1e-7)
    np.testing.assert_allclose(found.positions, take.positions, atol=1e-6)
    np.testing.assert_array_equal(found.status, take.status)
    assert (found.header, found.rate) == (take.header, take.rate)


def test_places_and_rotations_are_brought_to_the_world():
    take = from_frames([frame(0)], 60.0)
    still = replace(take, positions=np.array([[[1.0, 2.0, 3.0]] * 15]))
    np.testing.assert_allclose(still.world_places()[0, 0], [1.0, -2.0, -2.3])  # y right, z down, 0.7 m up
    np.testing.assert_allclose(still.world_rotations()[0, 0], [-1.0, 0.0, 0.0, 0.0], atol=1e-12)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"status": None}, "status: missing"),
        ({"rotations": np.zeros((2, 15, 4))}, r"rotations: shape \(2, 15, 4\)"),
        ({"rotations": np.zeros((3, 15, 4))}, "frame 0, hips: not a unit quaternion"),
        ({"positions": np.full((3, 15, 3), np.nan)}, "positions: not finite"),
        ({"status": np.full((3, 15), 9, np.uint8)}, "status: they must be 0 to 3"),
        ({"header": np.array("{}["), "rate": np.float64(60.0)}, "header"),
        ({"rate": np.float64(0.0)}, "rate 0"),
    ],
)
def test_a_broken_file_is_told_apart(tmp_path, changes, said):
    save(from_frames([frame(0), frame(1), frame(2)], 60.0), tmp_path / "whole.npz")
    arrays = archive.read(tmp_path / "whole.npz", "take") | changes
    archive.write(tmp_path / "broken.npz", {name: value for name, value in arrays.items() if value is not None})
    with pytest.raises(DataError, match=said):
        load(tmp_path / "broken.npz")
