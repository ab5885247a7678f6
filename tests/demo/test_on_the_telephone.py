"""Who has a handset at the ear and looks about: the head turns away from it, and not into it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, rotate
from ahmss.main.play import PlaySetup, play_script
from tests.demo.recorded import Recorded

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = """
add floor
add table at 0.45 1.55 0 facing 90
add telephone at 0.15 1.2 0.88 facing -90
add television as right at 2.5 0.5 0 facing 180
add desk as left at -2.0 0.9 0
human ken body ken at 0.15 0.75 facing 90
do telephone pick_up
do handset carry with {thing} look frames 90
"""


@pytest.mark.parametrize(("thing", "least", "most"), [("right", -8.0, 2.0), ("left", 25.0, 45.0)])
def test_the_head_turns_away_from_a_handset_and_not_into_it(
    tmp_path: Path, thing: str, least: float, most: float
) -> None:
    """It turned by 60 degrees to the hand's side, the handset 20 mm in it."""
    (tmp_path / "script.txt").write_text(SCRIPT.format(thing=thing))
    recording = tmp_path / "run.rec"
    report = play_script(tmp_path / "script.txt", PlaySetup(workspace=ROOT, fast=True, record=recording))
    assert [main["messages"] for main in report.mains] == [[]]
    ken = Recorded.read(recording, "ken", ())
    _, turned = ken.links
    head = multiply(conjugate(turned[-60:, 0]), turned[-60:, INDEX["head"]])
    _, left, back = rotate(head, np.array([0.0, 0.0, -1.0])).T
    yaw = np.degrees(np.arctan2(left, -back))
    assert least < yaw[-1] < most
    assert yaw.min() > -8.0
