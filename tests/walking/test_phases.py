"""Landings and standing are told from what the feet do."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.motion.contact import foot_points
from ahmss.walking.catalogue import Key
from ahmss.walking.library import RATE
from ahmss.walking.phases import Landing, Standing, level_speed, steady_contacts, walks
from ahmss.walking.replanting import whole
from tests.walking.performed import HUMAN, performance


def feet_of(key: Key):
    performed, take = performance(key)
    points = foot_points(HUMAN, whole(HUMAN, performed.rotations), performed.root)
    return points, performed.root, take


def contacts(frames: int, *air: tuple[int, int, int]):
    """Both feet bear, but for (foot, first, end)."""
    out = np.ones((frames, 2), bool)
    for foot, first, end in air:
        out[first:end, foot] = False
    return out


def moving(frames: int, first: int, end: int):
    """A root that goes ahead at 1 m/s from first to end."""
    root = np.zeros((frames, 3))
    root[:, 0] = np.clip(np.arange(frames) - first, 0, end - first) / RATE
    return root


@pytest.mark.parametrize("key", [Key("end", 0, 60), Key("one_step", 90, 0, "small"), Key("two_step", 180, 30)])
def test_landings_are_those_of_the_plan(key):
    points, root, take = feet_of(key)
    (walk,) = walks(steady_contacts(points, RATE), root, RATE)
    planned = take.plan.steps
    assert [landing.foot for landing in walk.landings] == [step.foot for step in planned]
    for landing, step in zip(walk.landings, planned, strict=True):
        assert landing.land == pytest.approx(step.land * RATE, abs=5)
        assert landing.lift == pytest.approx(step.lift * RATE, abs=10)
    assert walk.before is not None
    assert walk.before.first == 0
    assert walk.after is not None
    assert walk.after.end == len(root)


def test_standing_with_landings_between():
    bears = contacts(300, (1, 100, 120), (0, 130, 150))
    (walk,) = walks(bears, moving(300, 90, 160), RATE)
    assert walk.landings == (Landing(1, 99, 120), Landing(0, 129, 150))
    assert walk.before == Standing(0, 87)  # three frames of smoothing
    assert walk.after is not None
    assert walk.after.first == pytest.approx(163, abs=2)


def test_a_recording_that_begins_or_ends_in_walking():
    bears = contacts(300, (0, 0, 10), (1, 30, 50), (0, 270, 290))
    first, last = walks(bears, moving(300, 0, 60) + moving(300, 250, 300), RATE)
    assert first.before is None
    assert first.landings == (Landing(0, 0, 10), Landing(1, 29, 50))
    assert first.after == last.before
    assert last.landings == (Landing(0, 269, 290),)
    assert last.after is None


def test_bending_is_no_walk():
    assert walks(contacts(300), moving(300, 100, 140), RATE) == ()


def test_a_short_halt_between_small_steps_is_no_standing():
    bears = contacts(300, (1, 100, 120), (0, 140, 160))
    root = moving(300, 100, 118) + moving(300, 142, 160)
    assert len(walks(bears, root, RATE)) == 1
    bears = contacts(400, (1, 100, 120), (0, 240, 260))
    root = moving(400, 100, 118) + moving(400, 242, 260)
    assert len(walks(bears, root, RATE)) == 2


def test_gaps_and_touches():
    points = np.zeros((200, 2, 3, 3))
    points[:, 0, :, 0] = np.array([0.0, 0.1, 0.2])
    points[:, 1] = points[:, 0]
    points[50:55, 0, :, 2] = 0.2  # a jump of the foot, no step
    points[100:130, 1, :, 2] = 0.2  # in the air, but for 3 frames
    points[114:117, 1, :, 2] = 0.0
    bears = steady_contacts(points, RATE)
    assert bears[:, 0].all()
    np.testing.assert_array_equal(np.flatnonzero(~bears[:, 1]), np.arange(99, 131))


def test_a_step_that_is_never_fast_is_a_step():
    """A foot that slides 8 cm at less than 0.5 m/s without rising 5 cm bears all the time, by height and speed."""
    points = np.zeros((200, 2, 3, 3))
    share = np.clip((np.arange(200) - 80) / 20.0, 0.0, 1.0)
    points[..., 0] = np.array([0.0, 0.1, 0.2])
    points[:, 0, :, 0] += 0.08 * share[:, None]
    bears = steady_contacts(points, RATE)
    assert bears[:, 1].all()
    off = np.flatnonzero(~bears[:, 0])
    assert (off[0], off[-1]) == (81, 99)
    points[:, 0, 2, 0] = 0.2  # turned about its toe tip, it stands
    assert steady_contacts(points, RATE)[:, 0].all()


def test_speed_over_the_floor():
    root = moving(300, 100, 200)
    root[:, 2] = np.sin(np.arange(300))  # up and down is none
    speed = level_speed(root, RATE)
    assert speed[150] == pytest.approx(1.0, abs=1e-6)
    assert speed[50] == pytest.approx(0.0, abs=1e-6)
    assert level_speed(root[:1], RATE).tolist() == [0.0]
