"""The gate: what no body could do is held back, what stays is believed."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.quaternion import from_rotation_vector
from ahmss.capture.formats.losses import Losses
from ahmss.capture.merge import Merged
from ahmss.capture.plausible import SPEED, TURN, Gate, possible
from ahmss.capture.stations import Reading, Status

RATE = 60.0
HIPS, HEAD = 0, 2


class Stand:
    """A gate in front of two sensors, on hips (station 5) and head (station 1)."""

    def __init__(self):
        self.losses = Losses()
        self.gate = Gate({5: HIPS, 1: HEAD}, RATE, self.losses)
        self.number = -1

    def see(self, x=0.0, turned=0.0, *, status="", sign=1.0, stamp=None, skip=0):
        """The next frame: the head at x, turned about z; the hips stay."""
        self.number += 1 + skip
        q = sign * from_rotation_vector(np.array([0.0, 0.0, turned]))
        head = Reading(1, status, (x, 0.0, 0.0), tuple(q.tolist()), None, stamp)
        hips = Reading(5, "", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), None, stamp)
        return self.gate.frame(Merged(self.number, {1: head, 5: hips}, 0.0))


def test_rows_and_statuses():
    stand = Stand()
    frame = stand.see(0.5)
    assert frame.status[[HIPS, HEAD]].tolist() == [Status.GOOD, Status.GOOD]
    assert set(np.delete(frame.status, [HIPS, HEAD])) == {Status.MISSING}
    assert frame.positions[HEAD].tolist() == [0.5, 0.0, 0.0]
    assert stand.see(0.5, status="C").status[HEAD] == Status.WEAK
    assert stand.losses.weak == 1


@pytest.mark.parametrize(("x", "turned"), [(0.5, 0.0), (0.0, 1.2)])
def test_a_spike_is_held_back_and_what_follows_is_good(x, turned):
    stand = Stand()
    for _ in range(5):
        stand.see()
    spike = stand.see(x, turned)
    assert spike.status[HEAD] == Status.IMPLAUSIBLE
    assert spike.status[HIPS] == Status.GOOD
    assert spike.positions[HEAD].tolist() == [0.0, 0.0, 0.0]
    assert stand.see().status[HEAD] == Status.GOOD
    assert stand.losses.implausible == 1


def test_a_jump_that_stays_is_believed_after_two_frames():
    stand = Stand()
    for _ in range(5):
        stand.see()
    assert [int(stand.see(2.0).status[HEAD]) for _ in range(4)] == [Status.IMPLAUSIBLE, Status.IMPLAUSIBLE, 0, 0]


def test_one_wrong_first_reading_does_not_shut_the_others_out():
    stand = Stand()
    stand.see(3.0)
    assert [int(stand.see().status[HEAD]) for _ in range(4)] == [Status.IMPLAUSIBLE, Status.IMPLAUSIBLE, 0, 0]


def test_a_fast_hand_is_no_damage():
    stand = Stand()
    times = np.arange(60) / RATE
    for x, turned in zip(0.8 * np.sin(9.0 * times), 1.2 * np.sin(11.0 * times), strict=True):  # 7 m/s, 13 rad/s
        assert stand.see(x, turned).status[HEAD] == Status.GOOD


def test_a_pull_that_no_muscle_has_is_held_back_though_it_is_slow():
    stand = Stand()
    for _ in range(5):
        stand.see()
    assert stand.see(0.12).status[HEAD] == Status.IMPLAUSIBLE  # 7 m/s, from rest, in a frame
    assert 0.12 * RATE < SPEED


def test_after_a_gap_more_is_possible():
    stand = Stand()
    stand.see()
    assert stand.see(1.0, skip=30).status[HEAD] == Status.GOOD


def test_the_sign_of_a_quaternion_follows_its_predecessor():
    stand = Stand()
    first = stand.see(turned=0.1)
    second = stand.see(turned=0.2, sign=-1.0)
    assert np.dot(first.rotations[HEAD], second.rotations[HEAD]) > 0.9


def test_time_by_the_devices_stamps_where_they_fit():
    stand = Stand()
    times = [stand.see(stamp=5.0 + at * 0.01661).time for at in range(4)]
    assert times == pytest.approx([0.0, 0.01661, 0.03322, 0.04983])
    assert stand.see(stamp=400.0).time == pytest.approx(times[-1] + 1 / RATE)
    assert Stand().see().time == 0.0


def test_the_limits_hold_on_both_sides():
    still, unit = np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0])
    for factor, expected in ((0.99, True), (1.5, False)):
        far = np.array([0.0, factor * SPEED, 0.0])
        turned = from_rotation_vector(np.array([factor * TURN / 20, 0.0, 0.0]))
        assert bool(possible((still, far), (unit, unit), 1.0)) is expected
        assert bool(possible((still, still), (unit, turned), 1 / 20)) is expected
