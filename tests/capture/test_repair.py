"""Drop-outs filled and marked, jumps found and mended."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ahmss.body.quaternion import from_rotation_vector, multiply
from ahmss.capture.repair import Gap, fill, gaps, jumps, mend
from ahmss.capture.stations import TRACKED, Status
from ahmss.errors import DataError
from tests.capture.taken import degrees_between, performed, take_of

HAND = TRACKED.index("right_hand")


@pytest.fixture
def whole():
    return take_of(performed("lift"))[0]


def without(take, first, end, sensor=HAND, status=Status.MISSING):
    """The take with a drop-out, in which the last values stay, as trackers have it."""
    rotations, positions, flags = take.rotations.copy(), take.positions.copy(), take.status.copy()
    rotations[first:end, sensor], positions[first:end, sensor] = (
        rotations[first - 1, sensor],
        positions[first - 1, sensor],
    )
    flags[first:end, sensor] = status
    return replace(take, rotations=rotations, positions=positions, status=flags)


@pytest.mark.parametrize("status", [Status.MISSING, Status.IMPLAUSIBLE])
def test_a_short_drop_out_in_the_middle_of_a_movement_is_hardly_seen(whole, status):
    moving = np.abs(np.gradient(whole.positions[:, HAND, 0])).argmax()
    first, end = int(moving) - 6, int(moving) + 6
    damaged = without(whole, first, end, status=status)
    filled = fill(damaged)
    lost = degrees_between(damaged.rotations, whole.rotations)[:, HAND].max()
    assert lost > 5.0
    assert degrees_between(filled.rotations, whole.rotations)[:, HAND].max() < 0.1 * lost
    assert np.abs(filled.positions - whole.positions).max() < 0.01
    assert gaps(filled) == [Gap("right_hand", first, end)]  # still marked
    assert degrees_between(filled.rotations, whole.rotations)[:, :HAND].max() < 1e-4


def test_weak_readings_are_readings(whole):
    assert gaps(without(whole, 100, 110, status=Status.WEAK)) == []


def test_before_the_first_and_after_the_last_reading_a_sensor_rests(whole):
    damaged = without(without(whole, whole.frames - 30, whole.frames), 1, 20)
    damaged.status[0, HAND] = Status.MISSING
    filled = fill(damaged)
    np.testing.assert_array_equal(filled.rotations[:20, HAND], np.tile(filled.rotations[20, HAND], (20, 1)))
    np.testing.assert_array_equal(filled.positions[-30:, HAND], np.tile(whole.positions[-31, HAND], (30, 1)))


def test_two_drop_outs_side_by_side_do_not_take_their_speed_from_one_another(whole):
    moving = int(np.abs(np.gradient(whole.positions[:, HAND, 0])).argmax())
    damaged = without(without(whole, moving - 6, moving), moving + 1, moving + 7)
    filled = fill(damaged)
    assert degrees_between(filled.rotations, whole.rotations)[:, HAND].max() < 3.0


def test_a_sensor_that_gave_nothing_is_named(whole):
    whole.status[:, HAND] = Status.MISSING
    with pytest.raises(DataError, match="right_hand: nothing came"):
        fill(whole)


def test_who_moves_does_not_jump():
    for name in ("sit", "lift"):
        assert jumps(take_of(performed(name), noise="resolution")[0]) == []


def test_a_jump_is_found_and_mended_only_when_asked(whole):
    kicked = whole.rotations.copy()
    kick = from_rotation_vector(np.radians(60.0) * np.array([[0.0, 0.4, 0.0], [0.0, 1.0, 0.0], [0.0, 0.5, 0.0]]))
    kicked[200:203, HAND] = multiply(kick, kicked[200:203, HAND])
    take = replace(whole, rotations=kicked)
    (found,) = jumps(take)
    assert found.link == "right_hand"
    assert found.first <= 200
    assert found.end >= 203
    assert found.degrees == pytest.approx(60.0, abs=5.0)
    mended = mend(take, [found])
    assert degrees_between(mended.rotations, whole.rotations).max() < 2.0
    assert jumps(mended) == []
    assert degrees_between(take.rotations, whole.rotations).max() > 50.0
