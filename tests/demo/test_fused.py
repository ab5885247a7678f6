"""Captured motions are fused with others: the head looks elsewhere meanwhile, and nothing jumps when it comes back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.main.play import PlaySetup, play_script
from ahmss.motion.quality import worst_pop

from .conftest import DOOR, ROOT
from .recorded import Recorded

SCRIPTS = {
    "door": (
        "human ken body ken at -0.47 0 facing -20", "do door play_open with television look after 30", "do floor stand",
    ),
    "chair": (
        "human ken body ken at 1.80 0.2 facing 180", "do chair sit with television look after 20",
        "do chair stand_up with television look frames 60 after 10",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", ["door", pytest.param("chair", marks=pytest.mark.long)])
def test_the_head_looks_aside_meanwhile_and_nothing_pops(name: str, tmp_path: Path) -> None:
    (tmp_path / "script.txt").write_text("\n".join(["add room", *SCRIPTS[name]]) + "\n")
    setup = PlaySetup(workspace=str(ROOT), fast=True, record=tmp_path / "played.rec")
    assert play_script(tmp_path / "script.txt", setup).failures == 0
    played = Recorded.read(tmp_path / "played.rec", "ken", (DOOR,))
    assert worst_pop(played.rotations).degrees < 1.5
    _, world = played.links
    gaze = rotate(world[:, INDEX["head"]], np.array([0.0, 0.0, -1.0]))
    aside = np.degrees(np.arccos(np.clip(gaze @ gaze[0], -1.0, 1.0)))
    assert aside.max() > 30.0
    if name == "door":
        turned = np.degrees(
            2.0 * np.arccos(np.clip(np.abs(played.objects[DOOR][:, 3:] @ played.objects[DOOR][0, 3:]), 0, 1))
        )
        assert turned.max() > 28.0
