"""Somebody behind one's back: one turns around on the spot, and then looks, waves or points."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.main.play import PlaySetup, play_script
from ahmss.reaching.reacher import heading_of
from tests.demo.recorded import Recorded

ROOT = Path(__file__).resolve().parents[2]
AIKO = np.array([-1.8, 0.3])
SCRIPT = """
add floor
human ken body ken at 0 0 facing 0
human aiko body aiko at -1.8 0.3 facing 0
ken: do aiko {action}
"""


def played(tmp_path: Path, action: str) -> Recorded:
    (tmp_path / "script.txt").write_text(SCRIPT.format(action=action))
    recording = tmp_path / "run.rec"
    report = play_script(tmp_path / "script.txt", PlaySetup(workspace=str(ROOT), fast=True, record=recording))
    assert report.failures == 0, report
    return Recorded.read(recording, "ken", ())


def looked(ken: Recorded) -> Array:
    """How far (F,) aside of aiko the face is, level, degrees."""
    places, turned = ken.links
    head = INDEX["head"]
    ahead, way = rotate(turned[:, head], np.array([0.0, 0.0, -1.0]))[:, :2], AIKO - places[:, head, :2]
    cosine = (ahead * way).sum(axis=1) / np.linalg.norm(ahead, axis=1) / np.linalg.norm(way, axis=1)
    return np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))


@pytest.mark.parametrize(
    ("action", "seconds"),
    [("wave", 2.0), pytest.param("look", 1.5, marks=pytest.mark.long), ("point_out to 3 0.2 1.2", 1.0)],
)
def test_who_is_behind_is_turned_to_first(tmp_path: Path, action: str, seconds: float) -> None:
    ken = played(tmp_path, action)
    if action.startswith("point_out"):  # what is pointed out is ahead: nobody turns from it
        assert abs(np.degrees(heading_of(ken.rotations[-1], ken.root[-1]))) < 10.0
        return
    assert np.linalg.norm(ken.root[-1, :2] - ken.root[0, :2]) < 0.1  # on the spot
    assert (looked(ken) < 15.0).sum() > 60 * seconds
    palms = grips(ken.skeleton, ken.rotations, ken.root)
    height = palms[..., 2].max(axis=1)
    high = int(height.argmax())
    if action == "wave":
        assert height[high] > 1.3
        assert looked(ken)[high] < 15.0
