"""Who comes to somebody stands where there is room: before them, or about them where a thing stands there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ahmss.main.play import PlaySetup, play_script
from ahmss.motion.edit import floor_frame
from tests.demo.recorded import Recorded

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = """
add floor
add table at 0.77 0.2
human ken body ken at -0.9 -0.4 facing 0
human aiko body aiko at 1.5 -0.35 facing 180
ken: do aiko talk seconds=1
"""


@pytest.mark.timeout(120)
def test_who_talks_to_somebody_behind_a_table_comes_round_it(tmp_path: Path) -> None:
    (tmp_path / "talk.txt").write_text(SCRIPT)
    recording = tmp_path / "talk.rec"
    report = play_script(tmp_path / "talk.txt", PlaySetup(workspace=str(ROOT), fast=True, record=recording))
    assert [main["messages"] for main in report.mains] == [[], []]
    ken, aiko = (Recorded.read(recording, name, ("table",)) for name in ("ken", "aiko"))
    here, rotation = floor_frame(ken.rotations[-1], ken.root[-1])
    there, _ = floor_frame(aiko.rotations[-1], aiko.root[-1])
    way = (there - here)[:2]
    assert 0.85 < float(np.hypot(*way)) < 1.3
    facing = 2.0 * np.arctan2(rotation[3], rotation[0])
    assert abs((np.arctan2(way[1], way[0]) - facing + np.pi) % (2.0 * np.pi) - np.pi) < np.radians(26.0)
    off = np.abs(here[:2] - [0.77, 0.2]) - [0.5, 0.6]
    assert off.max() > 0.2  # beside the table


@pytest.mark.timeout(120)
def test_who_talks_beside_somebody_goes_to_their_other_side_where_a_table_is_at_the_nearer(tmp_path: Path) -> None:
    (tmp_path / "talk.txt").write_text(
        "add floor\nadd table at 0 1.1\nhuman ken body ken at 1.4 0.3 facing 180\n"
        "human aiko body aiko at 0 0 facing 0\nken: do aiko talk beside=true seconds=1\n"
    )
    recording = tmp_path / "talk.rec"
    report = play_script(tmp_path / "talk.txt", PlaySetup(workspace=str(ROOT), fast=True, record=recording))
    assert [main["messages"] for main in report.mains] == [[], []]
    ken = Recorded.read(recording, "ken", ("table",))
    here, _ = floor_frame(ken.rotations[-1], ken.root[-1])
    assert -0.96 < here[1] < -0.5
    assert abs(here[0]) < 0.5


@pytest.mark.timeout(60)
def test_where_tables_stand_at_both_sides_both_are_named(tmp_path: Path) -> None:
    """The table at the nearer side alone was told, as if nobody had looked at the other."""
    (tmp_path / "talk.txt").write_text(
        "add floor\nadd table at 0.1 0.9\nadd table as other at 0.1 -0.9\nhuman aiko body aiko at 0 0 facing 0\n"
        "human ken body ken at -0.8 1.6 facing 0\nken: do aiko talk beside=true seconds=1\n"
    )
    report = play_script(tmp_path / "talk.txt", PlaySetup(workspace=str(ROOT), fast=True))
    (said,) = (message for main in report.mains for message in main["messages"])
    assert "room at neither side of aiko, table and other being there" in said
