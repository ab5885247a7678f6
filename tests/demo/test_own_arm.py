"""What one hand carries goes past the other, which is held up where it has let go, and not through it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import conjugate, rotate
from ahmss.database import Workspace
from ahmss.main.play import PlaySetup, play_script

from .conftest import ROOT
from .made import workspace_with
from .recorded import Recorded
from .skin import Skin

pytestmark = pytest.mark.timeout(180)

LOW, HIGH = np.array([-0.03, -0.025, 0.0]), np.array([0.03, 0.025, 0.12])  # of the box, metres
SITE = 'position = [0.0, 0.0, 0.08]\norientation = [0.70710678, -0.70710678, 0.0, 0.0]\ngrip = "precision"'
SCRIPT = """
add floor
add table at 0.77 0.2
add carton as thing at 0.42 -0.157 0.88 facing -20
human aiko body aiko at -0.05 -0.022 facing 16
wait 0.2
do thing grasp hand right
do thing put to 0.45 0.05
do thing release
do thing grasp hand left
do thing put to table
"""
DEEPEST = 0.004  # metres


@pytest.mark.long
def test_what_a_hand_carries_goes_past_the_other_hand(tmp_path: Path) -> None:
    box = trimesh.creation.box(bounds=[LOW, HIGH])
    workspace_with(tmp_path, "carton", np.array(box.vertices[box.faces]), SITE)
    (tmp_path / "own.txt").write_text(SCRIPT)
    setup = PlaySetup(workspace=tmp_path, fast=True, record=tmp_path / "own.rec")
    assert play_script(tmp_path / "own.txt", setup).failures == 0
    played = Recorded.read(tmp_path / "own.rec", "aiko", ("thing",))
    skin = Skin.read(Workspace(ROOT).humans.shape("aiko").glb, played.skeleton)
    chosen = np.flatnonzero(np.isin(skin.link, [INDEX["right_hand"], *fingers("right")]))
    frame, holder = played.object("thing"), np.array(played.holders["thing"])
    let_go = int(np.flatnonzero((holder[:-1] != "") & (holder[1:] == ""))[0]) + 1
    moves = np.linalg.norm(np.diff(frame.place, axis=0), axis=1) > 1e-4
    carried = np.flatnonzero(moves[let_go:]) + let_go
    assert len(carried) > 30
    for k in carried[::2]:
        points = skin.posed(played.rotations[k], played.root[k], chosen) - frame.place[k]
        seen = rotate(conjugate(frame.rotation[k]), points)
        assert np.minimum(seen - LOW, HIGH - seen).min(axis=-1).max() < DEEPEST, int(k)
