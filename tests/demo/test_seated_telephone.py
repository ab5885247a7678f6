"""A telephone used from a chair that was drawn out from the desk: picked up, held at the ear, hung up, and again."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ahmss.body.links import INDEX
from ahmss.main.play import PlaySetup, play_script
from tests.demo.recorded import Recorded

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = """
add floor
add desk
add castor_chair at 0.72 0.1 0 facing 180
add telephone at 0.22 0.1 0.72
human aiko body aiko at 1.6 0.6 facing 180
do castor_chair draw_out
do castor_chair sit
do castor_chair roll to 0.62 0.1
do telephone pick_up
do handset carry frames 30
do telephone hang_up
"""
FASTEST = np.radians(5.3)  # in a frame: what any joint turns by where its source changes


@pytest.fixture(scope="module")
def used(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    folder = tmp_path_factory.mktemp("seated")
    (folder / "script.txt").write_text(SCRIPT)
    recording = folder / "run.rec"
    report = play_script(folder / "script.txt", PlaySetup(workspace=ROOT, fast=True, record=recording))
    assert [main["messages"] for main in report.mains] == [[]]
    return Recorded.read(recording, "aiko", ("telephone/handset",))


def test_who_sits_hangs_up_and_the_chair_sat_on_is_not_in_the_way(used: Recorded) -> None:
    """The arm was said to be 98 mm in something: in the chair, of which all up to its back counts as full."""
    handset = used.object("telephone/handset").place
    assert used.holders["telephone/handset"][-1] == ""
    assert np.linalg.norm(handset[-1] - handset[0]) < 0.005
    assert used.root[-1, 2] < 0.65


def test_the_head_does_not_whirl_round_where_a_walk_begins_after_a_pause_for_thought(used: Recorded) -> None:
    """It turned by 38 degrees in a frame, and on past the shoulder: its one leap was taken for its speed."""
    head = used.rotations[:, INDEX["head"]]
    turned = 2.0 * np.arccos(np.clip(np.abs((head[1:] * head[:-1]).sum(axis=1)), 0.0, 1.0))
    assert turned.max() < FASTEST
