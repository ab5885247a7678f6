"""The file of clips: what is written is read, and what is broken is named."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ahmss.body.quaternion import norm
from ahmss.errors import DataError
from ahmss.motion import archive
from ahmss.walking.catalogue import MIXED, ONE_STEP, STRAIGHT, TABLE, TWO_STEP, Key
from ahmss.walking.library import BODY, Library, is_library, load, save
from ahmss.walking.mirroring import mirrored
from ahmss.walking.nominal import length_of

from . import measures as m

FEW = (STRAIGHT, Key("start", 30), Key("one_step", 60, -30, "small"), Key("end", 0, 90, "normal", "left"))


@pytest.fixture
def few() -> Library:
    whole = m.library()
    return Library(whole.human, whole.hip_height, {key: whole.clips[key] for key in FEW})


def test_what_is_saved_is_read_again(few: Library, tmp_path: Path) -> None:
    path = tmp_path / "walk.npz"
    save(few, path)
    again = load(path)
    assert (again.human, set(again.clips)) == (few.human, set(FEW))
    for key in FEW:
        np.testing.assert_allclose(again.clips[key].rotations, few.clips[key].rotations, atol=1e-4)
        np.testing.assert_allclose(again.clips[key].root, few.clips[key].root, atol=1e-5)
        np.testing.assert_array_equal(again.clips[key].bearing, few.clips[key].bearing)
        assert again.clips[key].source == few.clips[key].source


def test_saved_twice_or_read_and_saved_it_is_the_same_bytes(few: Library, tmp_path: Path) -> None:
    paths = [tmp_path / f"{name}.npz" for name in ("one", "two", "again")]
    save(few, paths[0])
    save(Library(few.human, few.hip_height, dict(reversed(list(few.clips.items())))), paths[1])
    assert paths[0].read_bytes() == paths[1].read_bytes()
    save(load(paths[0]), paths[2])
    assert load(paths[2]).clips.keys() == few.clips.keys()
    first, again = (archive.read(path, "walk library") for path in (paths[0], paths[2]))
    np.testing.assert_array_equal(first["root"], again["root"])


def test_the_sign_of_a_quaternion_is_no_matter(few: Library, tmp_path: Path) -> None:
    clip = few.clips[STRAIGHT]
    rotations = clip.rotations.copy()
    rotations[10:20] *= -1.0
    other = Library(few.human, few.hip_height, few.clips | {STRAIGHT: replace(clip, rotations=rotations)})
    save(few, tmp_path / "a.npz")
    save(other, tmp_path / "b.npz")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


def changed(path: Path, **arrays: np.ndarray) -> Path:
    whole = archive.read(path, "walk library")
    archive.write(path, whole | arrays)
    return path


@pytest.mark.parametrize(
    ("header", "said"),
    [
        ('{"version": 9, "human": "ken", "hip_height": 0.9, "clips": []}', "version 9; this program reads version 1"),
        ('{"version": 1, "human": "ken"}', "ahmss walk build"),
        ("no json", "ahmss walk build"),
        (
            '{"version":1,"human":"k","hip_height":0.9,"clips":[{"kind":"start","direction":45,"facing":0,'
            '"stride":"normal","last":"right","poses":5,"source":""}]}',
            "start_45: no clip of a walk is called so",
        ),
    ],
)
def test_a_broken_header_is_named(few: Library, tmp_path: Path, header: str, said: str) -> None:
    path = tmp_path / "walk.npz"
    save(few, path)
    with pytest.raises(DataError, match=said):
        load(changed(path, header=np.array(header)))


def test_broken_arrays_are_named(few: Library, tmp_path: Path) -> None:
    path = tmp_path / "walk.npz"
    save(few, path)
    whole = archive.read(path, "walk library")
    for name, broken, said in (
        ("root", whole["root"][:-1], "root: shape"),
        ("root", whole["root"].astype(float), "root: shape"),
        ("bearing", whole["bearing"].astype(np.int32), "bearing: shape"),
        ("rotations", np.zeros_like(whole["rotations"]), "not unit quaternions"),
    ):
        archive.write(path, whole | {name: broken})
        with pytest.raises(DataError, match=said):
            load(path)


def test_other_files_are_no_libraries(tmp_path: Path) -> None:
    path = tmp_path / "walk.npz"
    with pytest.raises(DataError):
        load(path)
    assert not is_library(path)
    path.write_bytes(b"PK no zip")
    with pytest.raises(DataError):
        load(path)
    assert not is_library(path)
    clip = m.ROOT / "objectdb" / "floor" / "stand.npz"
    assert not is_library(clip)
    with pytest.raises(DataError, match="no walk library"):
        load(clip)
    assert is_library(m.ROOT / "objectdb" / "floor" / "walk.npz")


# The shipped one


def test_the_table_has_332_clips_and_the_shipped_library_all_of_them() -> None:
    assert (len(TABLE), len(MIXED), len(ONE_STEP), len(TWO_STEP)) == (232, 100, 98, 98)
    assert len({*TABLE, *MIXED}) == 332
    assert m.library().missing == ()
    assert len(m.library().clips) == 332


def test_a_library_says_what_it_lacks(few: Library) -> None:
    assert len(few.missing) == 332 - len(FEW)
    assert Key("start", 60) in few.missing


def test_every_shipped_clip_is_a_clip() -> None:
    for key, clip in m.library().clips.items():
        assert clip.rotations.shape == (clip.frames + 1, BODY, 4), key.name
        np.testing.assert_allclose(norm(clip.rotations), 1.0, atol=1e-9)
        assert clip.bearing.any(axis=(1, 2)).all(), key.name
        turns = np.abs((clip.rotations[1:] * clip.rotations[:-1]).sum(axis=-1))
        assert np.degrees(2.0 * np.arccos(np.clip(turns, 0.0, 1.0))).max() < 16.0, key.name


def alike(q: np.ndarray, p: np.ndarray) -> np.ndarray:
    """1 where rotations are the same."""
    return np.abs((q * p).sum(axis=-1))


def test_clips_meet_where_they_are_joined() -> None:
    """Starts and ends on the straight step, and that on its own mirror image."""
    straight = m.library().clips[STRAIGHT]
    other = mirrored(straight)
    np.testing.assert_allclose(alike(straight.rotations[-1], other.rotations[0]), 1.0, atol=1e-6)
    assert straight.root[-1, 1] == pytest.approx(-straight.root[0, 1], abs=2e-5)
    assert straight.root[-1, 2] == pytest.approx(straight.root[0, 2], abs=2e-5)
    for key, clip in m.library().clips.items():
        if key.kind == "start":
            np.testing.assert_allclose(alike(clip.rotations[-1, 1:], straight.rotations[0, 1:]), 1.0, atol=1e-6)
        elif key.kind == "end":
            first = straight if key.last == "right" else other
            np.testing.assert_allclose(alike(clip.rotations[0], first.rotations[0]), 1.0, atol=1e-6)


def test_every_clip_gets_somewhere_and_the_small_stride_less_far() -> None:
    clips = m.library().clips
    for key, clip in clips.items():
        assert length_of(clip) > 0.05, key.name
        if key.stride == "small":
            assert length_of(clip) < length_of(clips[replace(key, stride="normal")]), key.name


def test_whether_a_file_is_a_library_is_seen_without_unpacking_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is asked at the beginning of a motion, whose first frames wait for it."""
    monkeypatch.setattr("numpy.lib.format.read_array", None)
    assert is_library(m.ROOT / "objectdb" / "floor" / "walk.npz")
    assert not is_library(m.ROOT / "objectdb" / "cup" / "drink.npz")
