"""A take becomes a clip of a human, and what a person should know of it is said."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from ahmss.body.links import INDEX
from ahmss.body.skeleton import Skeleton
from ahmss.capture.casting import performance_of
from ahmss.capture.clipping import Choices, clip_of
from ahmss.capture.formats.decode import REACH
from ahmss.capture.performance import begun_upright
from ahmss.capture.stations import Status
from ahmss.errors import CommandError
from ahmss.motion.clip import load, save
from ahmss.motion.contact import foot_points
from tests.capture.taken import RATE, SUBJECT, degrees_between, performed, standing, take_of
from tests.motion.mocap import capture_path


def test_the_human_does_what_the_subject_did(tmp_path):
    performance = performed("lift")
    captured = clip_of(take_of(performance)[0], SUBJECT)
    trunk = [INDEX[name] for name in ("hips", "spine", "head", "right_upper_arm", "left_hand")]
    assert degrees_between(captured.clip.rotations[:, trunk], performance.rotations[:, trunk]).max() < 0.01
    moved, meant = (np.ptp(root[:, 2]) for root in (captured.clip.root, performance.root))
    assert moved == pytest.approx(meant, abs=0.02)
    assert foot_points(SUBJECT, captured.clip.rotations, captured.clip.root)[..., 2].min() > -1e-3
    relaxed, _ = SUBJECT.relaxed()
    np.testing.assert_allclose(degrees_between(captured.clip.rotations[:, 15:], relaxed[15:]), 0.0, atol=1e-4)
    save(captured.clip, tmp_path / "lift.npz")
    assert load(tmp_path / "lift.npz").header.origin == "a test"


def test_straight_legs_that_stand_stay_straight():
    performance = standing(3.0)
    captured = clip_of(take_of(performance)[0], SUBJECT)
    assert degrees_between(captured.clip.rotations, performance.rotations)[:, :15].max() < 0.01
    legs = [INDEX[f"{side}_{link}"] for side in ("right", "left") for link in ("upper_leg", "lower_leg", "foot")]
    opens = performed("door_open")
    bent = degrees_between(clip_of(take_of(opens)[0], SUBJECT).clip.rotations[:, legs], opens.rotations[:, legs])
    assert np.median(bent) < 0.05
    assert np.median(bent[:120]) < 0.01


def test_the_clip_begins_at_the_humans_own_floor_frame():
    captured = clip_of(take_of(performed("sit", 70.0))[0], SUBJECT, Choices(facing=np.radians(70.0)))
    np.testing.assert_allclose(captured.clip.root[0, :2], 0.0, atol=1e-9)
    upright, _ = SUBJECT.upright()
    assert degrees_between(captured.clip.rotations[0, 0], upright[0]) < 0.01


def test_what_should_be_known_is_said():
    take, _ = take_of(performed("lift", 40.0))
    take.status[100:110, 5] = Status.MISSING
    said = "\n".join(clip_of(take, SUBJECT).report())
    assert "right_hand: nothing from 1.67 to 1.83 s, filled" in said
    assert "faced +4" in said.replace("+3", "+4")
    assert "faced" not in "\n".join(clip_of(take, SUBJECT, Choices(facing=np.radians(40.0))).report())


def test_another_stretch_that_may_have_been_meant_is_named():
    rotations, root = SUBJECT.relaxed()
    motion = rotations[None].repeat(90, axis=0), root[None].repeat(90, axis=0)
    said = clip_of(take_of(begun_upright(motion, 60.0, SUBJECT, 2.0, "at ease"))[0], SUBJECT).report()
    named = [re.search(r"stood as tall from .* then --upright (\S+) (\S+)$", line) for line in said]
    (marked,) = [[float(second) for second in match.groups()] for match in named if match]
    assert 2.0 < marked[0] < marked[1] < 4.6
    assert "--upright" not in "".join(clip_of(take_of(performed("sit"))[0], SUBJECT).report())


def test_many_gaps_are_told_link_by_link():
    take, _ = take_of(performed("lift"))
    take.status[100:110, 5] = take.status[120:125, 5] = Status.MISSING
    few = clip_of(take, SUBJECT).report()
    assert sum("right_hand: nothing" in line for line in few) == 2
    for first in range(130, 190, 4):
        take.status[first, 8] = Status.MISSING
    many = [line for line in clip_of(take, SUBJECT).report() if "nothing" in line]
    assert many == [
        "right_hand: nothing 2 times, 0.25 s in all, the longest from 1.67 to 1.83 s, filled",
        "right_foot: nothing 15 times, 0.25 s in all, the longest from 2.17 to 2.18 s, filled",
    ]


def test_an_over_full_line_is_told_once_with_the_cause():
    take, _ = take_of(performed("lift"))
    came = np.unique(np.round(np.arange(0.0, take.frames, RATE / 23.3)).astype(int))
    lost = np.setdiff1d(np.arange(take.frames), came)
    take.status[lost] = Status.MISSING
    take.status[came[40] : came[50] + 1, 5] = Status.MISSING
    said = [line for line in clip_of(take, SUBJECT).report() if ", filled" in line]
    assert [line.split(":")[0] for line in said] == ["all sensors", "right_hand"]
    assert said[0].startswith("all sensors: 23.3 frames a second came, filled, not the 60 that are asked for: the line")


def test_lines_that_are_over_full_each_in_its_own_frames_are_told_once():
    take, _ = take_of(performed("lift"))
    for line in range(4):
        take.status[line % 2 :: 2, 4 * line : 4 * line + 4] = Status.MISSING
    (said,) = [line for line in clip_of(take, SUBJECT).report() if ", filled" in line]
    assert said.startswith("all sensors: 29.9 frames a second came")


def test_a_line_that_lost_much_at_times_is_not_over_full():
    take, _ = take_of(performed("lift"))
    for first in range(150, 300, 10):
        take.status[first : first + 5] = Status.MISSING
    take.status[320:324, 4:8] = Status.MISSING
    captured = clip_of(take, SUBJECT)
    assert captured.carried == 0.0
    assert [line for line in captured.report() if ", filled" in line] == [
        "all sensors: nothing 15 times, 1.25 s in all, the longest from 2.50 to 2.58 s, filled",
        "right_lower_arm, right_hand, right_upper_leg, right_lower_leg: "
        "nothing once, 0.07 s in all, the longest from 5.33 to 5.40 s, filled",
    ]


def test_who_walked_out_of_reach_is_told_so_once():
    take, _ = take_of(performed("lift"))
    way = np.interp(np.arange(take.frames), [150, 300], [0.0, 9.0])
    far = replace(take, positions=take.positions + way[:, None, None] * np.array([1.0, 0.0, 0.0]))
    beyond = np.linalg.norm(far.positions, axis=-1) > REACH
    assert 0 < beyond.sum() < beyond.size
    far.status[beyond] = Status.MISSING
    said = [line for line in clip_of(far, SUBJECT).report() if "reach" in line]
    assert len(said) == 1
    assert "near 9.2 m from the transmitter" in said[0]


def test_jitter_is_smoothed_when_asked():
    take, _ = take_of(performed("lift"), noise="resolution")
    true, _ = take_of(performed("lift"))
    rough, smooth = clip_of(take, SUBJECT).clip, clip_of(take, SUBJECT, Choices(cutoff=6.0)).clip
    meant = clip_of(true, SUBJECT).clip
    head = INDEX["head"]
    errors = [degrees_between(clip.rotations[:, head], meant.rotations[:, head]) for clip in (rough, smooth)]
    assert errors[1].std() < 0.6 * errors[0].std()
    with pytest.raises(CommandError, match="less than 30"):
        clip_of(take, SUBJECT, Choices(cutoff=30.0))


@pytest.fixture(scope="module")
def stumble():
    """A real capture in which the right foot jumps once."""
    return take_of(performance_of(str(capture_path("B02")), Skeleton.of(1.65, "female")))[0]


def test_a_real_jump_is_found_and_mended_only_when_asked(stumble):
    left = clip_of(stumble, SUBJECT)
    jump = max(left.jumps, key=lambda each: each.degrees)
    assert jump.link == "right_foot"
    assert jump.degrees > 60.0
    assert "--mend" in left.report()[-1]
    mended = clip_of(stumble, SUBJECT, Choices(mend=True))
    assert mended.report()[-1].endswith("mended")
    feet = [clip.rotations[:, INDEX["right_foot"]] for clip in (left.clip, mended.clip)]
    steps = [degrees_between(foot[1:], foot[:-1]).max() for foot in feet]
    assert steps[0] > 25.0
    assert steps[1] < 12.0


def test_a_performance_that_is_not_there():
    with pytest.raises(CommandError, match="door_open"):
        performance_of("dance", SUBJECT)


def test_unused_readings_do_not_matter():
    take, _ = take_of(performed("lift"))
    moved = replace(take, positions=take.positions + np.array([0.3, 0.1, 0.0]))
    np.testing.assert_allclose(clip_of(moved, SUBJECT).clip.root, clip_of(take, SUBJECT).clip.root)
