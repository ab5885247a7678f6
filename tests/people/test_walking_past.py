"""Somebody holds an arm out across another's way: it is gone round, and who is coming by is waited for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from ahmss.bench.skin import Skin
from ahmss.body.links import LINKS
from ahmss.database.workspace import Workspace
from ahmss.main.play import PlaySetup, play_script
from tests.demo.recorded import Recorded

ROOT = Path(__file__).resolve().parents[2]
ARM = ("arm", "hand", "thumb", "index", "middle", "ring", "little")
SCRIPT = """
add floor
human ken body {walks} at -2.2 0 facing 0
human aiko body {points} at 0.2 0.78 facing -90
ken: do floor walk to 2.2 0
aiko: wait {wait}
aiko: do floor point to 0.2 -3 1.1 hold=4
"""


@pytest.mark.parametrize(
    ("walks", "points", "wait", "told"),
    [
        ("ken", "aiko", 0.1, False),
        pytest.param("aiko", "ken", 0.1, False, marks=pytest.mark.long),
        ("ken", "aiko", 1.2, True),
    ],
)
def test_who_walks_past_keeps_clear_of_an_arm(tmp_path: Path, walks: str, points: str, wait: float, told: bool) -> None:
    """Held out before they come it is in their way; a moment before they are there it is held back."""
    (tmp_path / "script.txt").write_text(SCRIPT.format(walks=walks, points=points, wait=wait))
    recording = tmp_path / "run.rec"
    report = play_script(tmp_path / "script.txt", PlaySetup(workspace=str(ROOT), fast=True, record=recording))
    assert report.failures == 0
    notes = [note for main in report.mains for note in main["notes"]]
    assert ("floor point: waits for ken, who comes by" in notes) == told
    ken, aiko = (Recorded.read(recording, name, ()) for name in ("ken", "aiko"))
    assert np.linalg.norm(ken.root[-1, :2] - (2.2, 0.0)) < 0.05
    humans = Workspace(ROOT).humans
    own, other = (Skin.read(humans.shape(name).glb) for name in (walks, points))
    arm = np.array([any(part in LINKS[link] for part in ARM) for link in other.link])
    for k in range(0, min(len(ken.root), len(aiko.root)), 3):
        if np.linalg.norm(ken.root[k, :2] - aiko.root[k, :2]) < 1.3:
            theirs = other.posed(aiko.skeleton, aiko.rotations[k], aiko.root[k])[arm]
            mine = own.posed(ken.skeleton, ken.rotations[k], ken.root[k])
            assert cKDTree(mine).query(theirs)[0].min() > 0.02, k
