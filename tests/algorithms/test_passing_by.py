"""Who walks past a thing too fast to take it is told so, and holds nothing."""

from __future__ import annotations

from pathlib import Path

import pytest

from ahmss.main.play import PlaySetup, play_script
from tests.demo.recorded import Recorded

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = """
add floor
add table at 0.77 0 0
add cup at 0.444 0.311 0.88 facing 38
human ken body ken at -0.05 1.8 facing -90
do floor walk to 0.002 -1.8 with cup reach then cup grasp
do floor walk to cup
do cup grasp
do cup lift
"""


@pytest.mark.timeout(120)
def test_a_hand_that_closes_beside_a_cup_does_not_have_it(tmp_path: Path) -> None:
    """The cup stayed on the table and was held for ever after, from two metres away, and drunk from."""
    (tmp_path / "past.txt").write_text(SCRIPT)
    recording = tmp_path / "past.rec"
    report = play_script(tmp_path / "past.txt", PlaySetup(workspace=str(ROOT), fast=True, record=recording))
    (message,) = report.mains[0]["messages"]
    assert "degrees from where it holds cup, as the body went by" in message
    assert "`floor walk to cup`" in message
    ken = Recorded.read(recording, "ken", ("cup",))
    place = ken.object("cup").place
    came = ken.holders["cup"].index("ken", ken.holders["cup"].index("", ken.holders["cup"].index("ken")))
    assert (abs(place[:came] - place[0]) < 1e-6).all()  # it was not touched in passing
    assert place[-1, 2] > place[0, 2] + 0.05  # and taken when he came back to it
