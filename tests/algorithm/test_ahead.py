"""What the pool learns from a request, without a pool."""

from __future__ import annotations

import numpy as np
import pytest
from algorithm_rig import walk_clip

from ahmss.algorithm import cache
from ahmss.motion import clip as clips
from ahmss.processes import ahead
from ahmss.processes.child import Request
from ahmss.walking.catalogue import STRAIGHT
from ahmss.walking.library import Library, save


@pytest.fixture
def program(tmp_path):
    path = tmp_path / "walks.py"
    path.write_text("import json\nimport shapely\nfrom ahmss.walking.library import load\nfrom weights import HEAD\n")
    return str(path)


def test_the_libraries_that_a_program_names_are_imported_and_its_own_modules_are_not(program, monkeypatch):
    named = []
    monkeypatch.setattr(ahead.importlib, "import_module", named.append)
    assert ahead.learn(Request((program,), "/"))
    assert named == ["shapely", "ahmss.walking.library"]
    assert not ahead.learn(Request((program,), "/"))


def test_a_walk_library_is_read_once_until_it_changes(program, tmp_path, monkeypatch):
    path = tmp_path / "walk.npz"
    save(Library("tester", 0.9, {STRAIGHT: walk_clip()}), path)
    assert ahead.learn(Request((program,), "/", (str(path),)))
    with monkeypatch.context() as patch:
        patch.setattr(cache.libraries, "load", None)  # it was read already
        known = cache.library(str(path))
    assert known is not None
    assert not known.clips[STRAIGHT].root.flags.writeable
    cache.touch()
    save(Library("another", 0.8, {STRAIGHT: walk_clip(6)}), path)
    assert cache.library(str(path)).human == "another"


def test_the_copies_of_a_walk_library_are_one_that_is_rehearsed_once(tmp_path):
    before = cache.known_libraries()
    paths = [tmp_path / name for name in ("walk.npz", "copy.npz", "another.npz")]
    for path, steps in zip(paths, (7, 7, 8), strict=True):
        save(Library("tester", 0.7, {STRAIGHT: walk_clip(steps)}), path)
    one, copy, another = (cache.library(str(path)) for path in paths)
    assert one is copy
    assert one is not another
    assert len(cache.known_libraries()) == len(before) + 2


def test_a_clip_is_no_walk_library(tmp_path):
    path = tmp_path / "wave.npz"
    rotations = np.tile([1.0, 0.0, 0.0, 0.0], (4, 43, 1))
    clips.save(clips.Clip(rotations, np.zeros((4, 3)), np.ones((4, 44)), np.ones((4, 2)), 60.0), path)
    assert cache.library(str(path)) is None
    assert cache.clip(str(path)).frames == 4


def test_what_is_read_beside_a_request_is_learned_as_it_is(program, tmp_path):
    path = tmp_path / "wave.npz"
    rotations = np.tile([1.0, 0.0, 0.0, 0.0], (4, 43, 1))
    clips.save(clips.Clip(rotations, np.zeros((4, 3)), np.ones((4, 44)), np.ones((4, 2)), 60.0), path)
    both = Request((), "/", ahead=True, others=(Request((program,), "/"), Request((program,), "/", (str(path),), 7)))
    assert ahead.learn(both)
    assert not ahead.learn(Request((program,), "/", (str(path),), 7))
    assert cache._resampled[str(path), 8][1].frames == 8
