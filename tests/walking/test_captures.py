"""A user's captures become clips: recognised by what was measured, fitted, and every key accounted for."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from ahmss.body.quaternion import align, from_axis_angle, multiply
from ahmss.errors import DataError
from ahmss.motion.clip import ClipHeader
from ahmss.motion.edit import part
from ahmss.walking.build import build
from ahmss.walking.captures import files_in, gather
from ahmss.walking.catalogue import MIXED, STRAIGHT, TABLE, Key
from ahmss.walking.cutting import Cut, Unused, cuts
from ahmss.walking.fitting import wanted_ends
from ahmss.walking.library import Library, load, save
from ahmss.walking.mirroring import mirror
from ahmss.walking.nominal import length_of
from ahmss.walking.phases import Landing, Walk
from ahmss.walking.recording import Recording, read
from tests.motion.mocap import MOCAP, capture_path
from tests.walking.performed import HUMAN, STAND, STANDING, UP, recorded
from tests.walking.performed import save as save_clip
from tests.walking.test_replanting import drift, same

KEYS = [
    Key("start", 0), Key("start", 60), Key("start", 150), Key("end", 0, 0, "normal", "right"),
    Key("end", 0, 60, "normal", "left"), Key("end", 0, 30, "small", "left"), Key("one_step", 0, 30),
    Key("one_step", 120, -120, "small"), Key("one_step", 60, -30), Key("two_step", 60, 30), Key("two_step", 180, 180),
    Key("two_step", 30, 30),
]  # fmt: skip  # who turns by more takes more footsteps than two or three


@cache
def fallback() -> Library:
    keys = [key for key in TABLE if key.kind in ("start", "end")]
    steps = [key for key in KEYS if key.kind.endswith("_step")] + [Key("one_step", 90, -90), Key("two_step", 30, -30)]
    short = [replace(key, stride=stride) for key in steps for stride in ("normal", "small")]
    return build(HUMAN, STAND, keys=[*keys, *short])


def found_in(path) -> list[Cut | Unused]:
    return list(cuts(read(path, HUMAN), HUMAN, STANDING))


def measured(cut: Cut) -> tuple[float, float]:
    sign = -1.0 if cut.mirrored else 1.0
    return sign * cut.direction, sign * cut.facing


def apart(a: float, b: float) -> float:
    return abs((a - b + 180.0) % 360.0 - 180.0)


@pytest.mark.parametrize("seen", [False, True])
@pytest.mark.parametrize("key", KEYS, ids=lambda key: key.name)
def test_what_was_performed_is_what_is_found(key, seen, tmp_path):
    found = found_in(save_clip(recorded(key, 130.0, seen), tmp_path / "turn_left_45.npz"))
    normal = replace(key, stride="normal")
    matching = [cut for cut in found if isinstance(cut, Cut) and cut.clip.key == normal]
    assert matching
    for cut in matching:
        direction, facing = measured(cut)
        if key.kind != "end":
            assert apart(direction, key.direction) < 6.0
        if key.kind != "start":
            assert apart(facing, key.facing) < 6.0
        if key.facing not in (0, 180) or key.direction not in (0, 180):
            assert cut.mirrored == seen
        assert cut.clip.root[0, :2] == pytest.approx([0.0, 0.0], abs=1e-9)
        way = np.radians(cut.clip.key.direction)
        assert length_of(cut.clip) == pytest.approx(np.hypot(*cut.clip.root[-1, :2]), rel=0.03)
        assert np.sign(np.cos(way)) * cut.clip.root[-1, 0] > -0.02


@pytest.mark.parametrize("seen", [False, True])
def test_straight_steps_lie_along_their_way(seen, tmp_path):
    found = found_in(save_clip(recorded(STRAIGHT, -70.0, seen), tmp_path / "a.npz"))
    steps = [cut for cut in found if isinstance(cut, Cut) and cut.clip.key == STRAIGHT]
    assert len(steps) > 5
    for cut in steps:
        clip = cut.clip
        assert clip.root[0, 0] == pytest.approx(0.0, abs=1e-9)
        assert clip.root[-1, 1] == pytest.approx(-clip.root[0, 1], abs=1e-9)
        assert clip.root[-1, 0] > 0.5
        right, left = clip.bearing[0].any(axis=-1)
        assert right
        assert left
        assert not clip.bearing[15].any(axis=-1)[1]  # the left foot is in the air
    assert {cut.mirrored for cut in steps} == {False, True}


@pytest.fixture
def folder(tmp_path):
    """Captures under names that tell nothing, some useless, one broken."""
    under = tmp_path / "more"
    under.mkdir()
    for name, key, degrees, seen in (
        ("a", Key("start", 60), 10.0, False), ("b", Key("end", 0, 60, "normal", "left"), 100.0, True),
        ("more/c", Key("one_step", 90, -90, "small"), -140.0, True), ("d", Key("two_step", 30, -30), 0.0, False),
    ):  # fmt: skip
        save_clip(recorded(key, degrees, seen), tmp_path / f"{name}.npz")
    save_clip(part(recorded(Key("start", 0)), 0, 30), tmp_path / "stand.npz")
    keyframes = replace(recorded(Key("start", 0)), header=ClipHeader(times=None))
    keyframes = replace(part(keyframes, 0, 2), header=ClipHeader(times=(0.5, 1.0)))
    save_clip(keyframes, tmp_path / "keyframes.npz")
    (tmp_path / "broken.bvh").write_text("HIERARCHY\nROOT")
    (tmp_path / "notes.txt").write_text("nothing")
    return tmp_path


def test_a_folder_becomes_a_library_and_every_key_is_accounted_for(folder):
    files = files_in(folder)
    assert [path.name for path in files] == [
        "a.npz", "b.npz", "broken.bvh", "d.npz", "keyframes.npz", "c.npz", "stand.npz"
    ]  # fmt: skip
    library, report = gather(files, HUMAN, STANDING, fallback())
    filled = {one.key: one for one in report.filled}
    captured = {
        STRAIGHT, Key("start", 0), Key("start", 60), Key("end", 0, 60, "normal", "left"),
        Key("one_step", 90, -90, "small"), Key("two_step", 30, -30),
    }  # fmt: skip
    assert captured <= set(filled)
    assert filled[Key("start", 60)].file == "a.npz"
    assert filled[Key("start", 60)].direction == pytest.approx(60.0, abs=6.0)
    assert filled[Key("end", 0, 60, "normal", "left")].mirrored
    assert filled[Key("end", 0, 60, "normal", "left")].facing == pytest.approx(-60.0, abs=6.0)
    assert filled[Key("one_step", 90, -90, "small")].direction == pytest.approx(-90.0, abs=6.0)

    every = (*TABLE, *MIXED)
    counted = [*filled, *report.fallback, *report.missing]
    assert sorted(counted) == sorted(every)
    assert set(library.clips) == set(filled) | set(report.fallback)
    assert set(report.missing) == set(library.missing)
    assert all(key in fallback().clips for key in report.fallback)
    assert len(report.unread) == 2
    assert any("broken.bvh" in line for line in report.unread)
    assert any("keyframes" in line for line in report.unread)
    assert any(one.file == "stand.npz" and one.what == "no steps" for one in report.unused)
    assert any("more straight steps" in one.what for one in report.unused)
    text = "\n".join(report.lines())
    assert "start_60: a.npz, 0.0" in text
    assert "not read: " in text
    for key in every:
        assert key.name in text

    path = folder / "walk.npz"
    save(library, path)
    assert set(load(path).clips) == set(library.clips)


def test_all_clips_join_and_stand(folder):
    library, _ = gather(files_in(folder), HUMAN, STANDING, fallback())
    straight = library.clips[STRAIGHT]
    expected, _ = mirror(straight.rotations[0], straight.root[0])
    assert same(straight.rotations[-1], expected) < 1e-9
    assert library.human == HUMAN.name
    assert library.hip_height == pytest.approx(STANDING.root[2])
    captured = [clip for clip in library.clips.values() if clip.source != "subject"]
    assert len(captured) >= 6
    for clip in captured:
        assert ".npz" in clip.source
        assert drift(clip) < 0.005
    for clip in library.clips.values():
        if clip.key == STRAIGHT:
            continue
        first, last = wanted_ends(clip.key, straight, STANDING)
        assert same(clip.rotations[0], first.rotations) < 1e-6
        assert same(clip.rotations[-1], last.rotations) < 1e-6
        assert np.abs(np.diff(align_all(clip.rotations), axis=0)).max() < 0.15


def align_all(rotations):
    out = rotations.copy()
    for frame in range(1, len(out)):
        out[frame] = align(out[frame], out[frame - 1])
    return out


def test_without_a_fallback_the_rest_is_missing(folder):
    library, report = gather(files_in(folder), HUMAN, STANDING)
    assert report.fallback == ()
    assert set(report.missing) == set(library.missing)
    assert "are empty" in "\n".join(report.lines())


def test_without_a_straight_step_there_is_no_library(tmp_path):
    path = save_clip(recorded(Key("one_step", 0, 0)), tmp_path / "a.npz")
    with pytest.raises(DataError, match="no straight step"):
        gather([path], HUMAN, STANDING)
    library, report = gather([path], HUMAN, STANDING, fallback())
    assert STRAIGHT in report.fallback
    assert [one.key for one in report.filled] == [Key("one_step", 0, 0)]
    assert library.clips[STRAIGHT].source == "subject"


def test_of_several_for_one_key_the_one_that_fits_best(tmp_path):
    good = recorded(Key("start", 60))
    bad = recorded(Key("start", 60))
    rotations = bad.rotations.copy()
    rotations[:, 1] = align(np.roll(rotations[:, 1], 1, axis=-1), rotations[:, 1])  # a spine that is bent all the time
    files = [save_clip(replace(bad, rotations=rotations), tmp_path / "a.npz"), save_clip(good, tmp_path / "b.npz")]
    _, report = gather(files, HUMAN, STANDING, fallback())
    assert next(one for one in report.filled if one.key == Key("start", 60)).file == "b.npz"
    assert any(one.file == "a.npz" and one.what == "another start_60" for one in report.unused)


def test_a_fault_of_the_capture_is_left_out(tmp_path):
    clip = recorded(Key("one_step", 0, 0))
    rotations = clip.rotations.copy()
    rotations[60, 4] = rotations[60, 1]
    path = save_clip(replace(clip, rotations=rotations), tmp_path / "a.npz")
    (one,) = found_in(path)
    assert isinstance(one, Unused)
    assert "right_lower_arm jumps" in one.what


def test_another_humans_clip_is_walked_by_this_one(tmp_path):
    clip = recorded(Key("start", 60))
    other = replace(clip, header=ClipHeader(human="ken"), root=1.4 * clip.root)
    found = found_in(save_clip(other, tmp_path / "a.npz"))
    (start, *_) = [one for one in found if isinstance(one, Cut) and one.clip.key.kind == "start"]
    assert start.clip.key == Key("start", 60)
    assert length_of(start.clip) < 1.1


@pytest.mark.parametrize(("turn", "side"), [(90.0, "left"), (-60.0, "right")])
def test_a_turn_in_walking_is_found_and_is_no_clip(turn, side):
    """Landings every half second, the hips on a way that bends from the fourth to the seventh."""
    landings = tuple(Landing(1 - i % 2, 30 * i - 20, 30 * i) for i in range(1, 11))
    angle = np.radians(turn) * np.clip((np.arange(330) - 120) / 90.0, 0.0, 1.0)
    root = np.zeros((330, 3))
    root[:, 0], root[:, 1] = np.cumsum(np.cos(angle)) / 60.0, np.cumsum(np.sin(angle)) / 60.0
    rotations = np.repeat(STANDING.rotations[None], 330, axis=0)
    rotations[:, 0] = multiply(from_axis_angle(UP, angle), rotations[:, 0])
    bears = np.ones((330, 2, 3), bool)
    recording = Recording("a.bvh", rotations, root, bears, bears[..., 0], (Walk(landings, None, None),))
    found = list(cuts(recording, HUMAN, STANDING))
    (bend,) = [one for one in found if isinstance(one, Unused)]
    assert bend.what == f"a turn in walking, {abs(turn):.0f} degrees to the {side}"
    assert bend.first <= 120
    assert bend.last >= 210
    steps = [cut for cut in found if isinstance(cut, Cut)]
    assert steps
    assert all(cut.last < 150 or cut.first > 180 for cut in steps)


def test_a_fallback_that_fits_already_is_taken_as_it_is(tmp_path):
    path = save_clip(recorded(Key("one_step", 0, 0)), tmp_path / "a.npz")
    library, _ = gather([path], HUMAN, STANDING, fallback())
    assert library.clips[Key("one_step", 0, 30)].rotations is fallback().clips[Key("one_step", 0, 30)].rotations
    own = fallback().clips[STRAIGHT]
    limping = replace(own, rotations=np.roll(own.rotations, 2, axis=0))
    other = replace(fallback(), clips={**fallback().clips, STRAIGHT: limping})
    library, _ = gather([path], HUMAN, STANDING, other)
    landing = wanted_ends(Key("start", 90), limping, STANDING)[1]
    assert same(library.clips[Key("start", 90)].rotations[-1], landing.rotations) < 1e-9


def test_real_captures_by_what_they_measure():
    capture_path("B03")
    library, report = gather(files_in(MOCAP), HUMAN, STANDING)
    filled = {one.key: one for one in report.filled}
    assert set(filled) == {
        STRAIGHT, Key("start", 0), Key("end", 0, 0, "normal", "left"), Key("end", 0, 0, "normal", "right")
    }  # fmt: skip
    assert filled[STRAIGHT].length == pytest.approx(0.66, abs=0.06)
    assert abs(filled[Key("start", 0)].direction) < 10.0
    assert "B02" in filled[Key("end", 0, 0, "normal", "left")].file
    turns = [one for one in report.unused if "turn in walking" in one.what]
    assert [(one.file[8:11], "left" in one.what) for one in turns] == [
        ("B09", True), ("B10", True), ("B12", False), ("B13", False)
    ]  # fmt: skip
    assert [one.file[8:11] for one in report.unused if one.what == "no steps"] == ["A01", "A05"]
    for clip in library.clips.values():
        assert drift(clip) < 0.01
