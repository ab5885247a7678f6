"""What `ahmss walk build` refuses before it sets to work; the library that `info` and `export` mean."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ahmss.database import Workspace
from ahmss.errors import CommandError
from ahmss.main.walklibrary import build_library, export_clip, show_library
from ahmss.motion import clip as clips
from ahmss.motion.quality import beyond_limits
from ahmss.walking.legs import foot_frames
from ahmss.walking.library import load

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("nowhere", "there is no such folder; name one"),
        ("walk.bvh", "it is a file; name the folder that holds it"),
        ("empty", "no motions in this folder"),
    ],
)
def test_a_folder_that_is_none_is_told_from_one_without_motions(tmp_path: Path, name: str, said: str) -> None:
    (tmp_path / "walk.bvh").touch()
    (tmp_path / "empty").mkdir()
    with pytest.raises(CommandError) as told:
        build_library(tmp_path / name, "ken", tmp_path / "walk.npz", None, force=False, as_json=False)
    assert str(told.value).startswith(f"{tmp_path / name}: {said}")
    assert not (tmp_path / "walk.npz").exists()


def test_without_a_library_the_floors_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    show_library(None, ROOT, as_json=False)
    shown = capsys.readouterr().out
    assert "objectdb/floor/walk.npz: 332 clips of ken" in shown
    assert "start_90" in shown


def test_without_a_library_a_clip_of_the_floors_is_written(tmp_path: Path) -> None:
    export_clip(None, "start_90", tmp_path / "left.npz", ROOT, force=False)
    assert clips.load(tmp_path / "left.npz").header.origin == "walk.npz: start_90"


def test_a_clip_that_is_written_has_the_legs_of_a_walk(tmp_path: Path) -> None:
    skeleton = Workspace(ROOT).humans.get("ken").skeleton
    export_clip(None, "start_180", tmp_path / "round.npz", ROOT, force=False)
    written = clips.load(tmp_path / "round.npz")
    walk = next(clip for key, clip in load(ROOT / "objectdb/floor/walk.npz").clips.items() if key.name == "start_180")
    own, _ = foot_frames(skeleton, walk.rotations, walk.root)
    shown, _ = foot_frames(skeleton, written.rotations, written.root)
    np.testing.assert_allclose(shown, own, atol=1e-4)
    assert beyond_limits(written.rotations, skeleton).degrees < 15.0


def test_a_library_named_before_its_clip_is_told_the_order(tmp_path: Path) -> None:
    with pytest.raises(CommandError, match=r"name the clip first, as in `ahmss walk export start_90 my/walk.npz`"):
        export_clip(Path("start_90"), "my/walk.npz", tmp_path / "left.npz", ROOT, force=False)


def test_a_clip_that_is_none_is_told_where_they_are_listed(tmp_path: Path) -> None:
    with pytest.raises(CommandError, match=r'no clip "start_91"; `ahmss walk info` lists them'):
        export_clip(None, "start_91", tmp_path / "left.npz", ROOT, force=False)
