"""The clip file: what is written comes back, the same bytes every time, and what is wrong is said with its place."""

import json
import zipfile
from dataclasses import replace

import numpy as np
import pytest

from ahmss.errors import DataError
from ahmss.motion.clip import ClipHeader, load, save


@pytest.fixture
def path(tmp_path):
    return tmp_path / "swing.npz"


def rewrite(path, **changes):
    """The file with some arrays replaced, or left out where None."""
    with np.load(path) as archive:
        arrays = {name: archive[name] for name in archive.files}
    arrays |= changes
    np.savez(path, **{name: array for name, array in arrays.items() if array is not None})


def header(**changes):
    return np.array(json.dumps({"version": 1} | changes))


def test_what_is_saved_is_loaded(swing, path):
    save(swing, path)
    back = load(path)
    assert back.header == swing.header
    assert (back.rate, back.frames, back.duration) == (60.0, 61, 1.0)
    for name in ("rotations", "root", "importance", "contacts", "targets"):
        assert np.allclose(getattr(back, name), getattr(swing, name), atol=2e-6), name
        assert getattr(back, name).dtype == np.float64
    assert np.allclose(np.linalg.norm(back.rotations, axis=-1), 1.0, atol=1e-15)


def test_targets_may_be_left_out(swing, path):
    save(replace(swing, targets=None), path)
    assert load(path).targets is None


def test_the_same_clip_gives_the_same_bytes(swing, path, tmp_path):
    save(swing, path)
    save(swing, tmp_path / "again.npz")
    assert path.read_bytes() == (tmp_path / "again.npz").read_bytes()


def test_numpy_alone_reads_it(swing, path):
    save(swing, path)
    with np.load(path, allow_pickle=False) as archive:
        assert set(archive.files) == {"rotations", "root", "importance", "contacts", "targets", "rate", "header"}
        assert json.loads(str(archive["header"]))["origin"] == "made here"


def test_keyframe_times_survive(swing, path):
    keys = replace(
        swing, rotations=swing.rotations[:3], root=swing.root[:3], importance=swing.importance[:3],
        contacts=swing.contacts[:3], targets=None, header=ClipHeader(times=(0.2, 0.5, 1.0)),
    )  # fmt: skip
    save(keys, path)
    assert load(path).header.times == (0.2, 0.5, 1.0)


BAD = {
    "unknown array": ({"speed": np.ones(3)}, "speed", "unknown array"),
    "missing array": ({"root": None}, "root", "missing"),
    "frames disagree": ({"root": np.zeros((60, 3))}, "root", r"\(frames, 3\)"),
    "links are 42": ({"rotations": np.zeros((61, 42, 4))}, "rotations", r"\(frames, 43, 4\)"),
    "no frames": ({"rotations": np.zeros((0, 43, 4))}, "rotations", "shape"),
    "a scalar": ({"rotations": np.float64(1.0)}, "rotations", "shape"),
    "not a number": ({"root": np.full((61, 3), np.nan)}, "root", "frame 0: not a finite number"),
    "not unit": ({"rotations": np.full((61, 43, 4), 0.7)}, "rotations", "unit quaternions"),
    "negative importance": ({"importance": np.full((61, 44), -0.1)}, "importance", "not negative"),
    "contact above 1": ({"contacts": np.full((61, 2), 1.5)}, "contacts", "from 0 to 1"),
    "weight above 1": ({"targets": np.full((61, 5, 8), 2.0)}, "targets", "unit quaternions, or all 0"),
    "text for numbers": ({"root": np.full((61, 3), "x")}, "root", "must be numbers"),
    "rate 0": ({"rate": np.float64(0.0)}, "rate", "number > 0"),
    "rate of two": ({"rate": np.array([30.0, 60.0])}, "rate", "one number"),
    "header no JSON": ({"header": np.array("{")}, "header", "JSON"),
    "header key": ({"header": header(author="me")}, "header", "author"),
    "header frame": ({"header": header(frame="world")}, "header", "frame"),
    "newer version": ({"header": header(version=2)}, "header", "version 2; this program reads version 1"),
    "times too few": ({"header": header(times=[0.5, 1.0])}, "header.times", "2 times for 61 frames"),
    "times fall": ({"header": header(times=[1.0 - k / 100 for k in range(61)])}, "header.times", "rise"),
}


@pytest.mark.parametrize(("changes", "place", "message"), BAD.values(), ids=BAD)
def test_what_is_wrong_is_named_with_file_and_place(swing, path, changes, place, message):
    save(swing, path)
    rewrite(path, **changes)
    with pytest.raises(DataError, match=message) as error:
        load(path)
    assert str(path) in str(error.value)
    assert error.value.place == place


def test_pickles_are_refused(swing, path):
    save(swing, path)
    rewrite(path, root=np.array([{"a": 1}] * 61, dtype=object))
    with pytest.raises(DataError, match="not a motion clip"):
        load(path)


def test_a_file_that_unpacks_to_too_much_is_refused_before_it_is_unpacked(path, monkeypatch):
    monkeypatch.setattr("ahmss.motion.archive._LARGEST", 2**20)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("rotations.npy", bytes(2**20 + 1))
    with pytest.raises(DataError, match="at most"):
        load(path)


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 not really", b"{}"])
def test_garbage_is_refused(path, content):
    path.write_bytes(content)
    with pytest.raises(DataError, match="not a motion clip"):
        load(path)


def test_no_flipped_or_cut_file_is_more_than_a_sentence(swing, path):
    save(swing, path)
    whole = path.read_bytes()
    rng = np.random.default_rng(0)
    refused = []
    for _ in range(80):
        broken = bytearray(whole)
        broken[rng.integers(len(broken))] ^= 1 << int(rng.integers(8))
        path.write_bytes(bytes(broken[: rng.integers(1, len(broken) + 1)] if rng.random() < 0.3 else broken))
        try:
            load(path)
        except DataError as error:
            refused.append(str(error))
    assert len(refused) > 40
    assert all(str(path) in message for message in refused)


def test_a_missing_file_is_said(path):
    with pytest.raises(DataError, match="no such motion clip"):
        load(path)


def test_a_broken_clip_is_not_saved(swing, path):
    with pytest.raises(DataError, match="unit"):
        save(replace(swing, rotations=swing.rotations * 2.0), path)
    assert not path.exists()
