"""What `ahmss walk build` refuses before it sets to work."""

from __future__ import annotations

from pathlib import Path

import pytest

from ahmss.errors import CommandError
from ahmss.main.walklibrary import build_library


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
