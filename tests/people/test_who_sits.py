"""One of two sits: who stands comes to before them, the cup goes from hand to hand, and who sits stays there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ahmss.body.links import INDEX
from ahmss.main.play import PlaySetup, play_script
from tests.demo.recorded import Recorded

ROOT = Path(__file__).resolve().parents[2]
MEETING = """
add floor
add table at 0.55 -0.1 0 facing 90
add cup at 0.2 -0.15 0.76
add chair at -1.3 1.2 0 facing {facing}
human ken body ken at -0.2 -0.1 facing 0
human aiko body aiko at -1.3 0.3 facing 90
aiko: do chair sit
ken: do floor walk to cup with cup reach then cup grasp then cup lift
sync
aiko: do ken receive
ken: do aiko hand_over
sync
ken: do aiko receive
aiko: do ken hand_over
sync
ken: do aiko talk seconds=1
aiko: do ken talk seconds=1
"""


def play(folder: Path, text: str) -> tuple[Path, list[list[str]]]:
    (folder / "script.txt").write_text(text)
    recording = folder / "run.rec"
    report = play_script(folder / "script.txt", PlaySetup(workspace=ROOT, fast=True, record=recording))
    return recording, [list(main["messages"]) for main in report.mains]  # type: ignore[arg-type]


@pytest.mark.timeout(120)
@pytest.mark.parametrize(
    "facing", [-90, *(pytest.param(facing, marks=pytest.mark.long) for facing in (-45, 0, 90, 180))]
)
def test_who_sits_is_given_a_cup_gives_it_back_and_talks_without_standing_up(tmp_path: Path, facing: int) -> None:
    """Who sat was to walk where the giver stood aside, and what they held out was never seen to be held out."""
    recording, said = play(tmp_path, MEETING.format(facing=facing))
    assert [[one for one in lines if "waits for" not in one] for lines in said] == [[], []]
    ken, aiko = (Recorded.read(recording, name, ("cup",)) for name in ("ken", "aiko"))
    holders = [holder for holder in ken.holders["cup"] if holder]
    assert [b for a, b in zip(["", *holders], holders, strict=False) if a != b] == ["ken", "aiko", "ken"]
    first = ken.holders["cup"].index("aiko")
    assert float(np.ptp(aiko.root[first:], axis=0).max()) < 0.05
    places, _ = aiko.links
    eyes, off = places[first, INDEX["head"], 2], ken.root[first, :2] - aiko.root[first, :2]
    assert ken.object("cup").place[first, 2] < eyes
    assert abs((np.degrees(np.arctan2(*off[::-1])) - facing + 180.0) % 360.0 - 180.0) < 45.0
    for side in (0, 1):  # both lie on the thighs at the end, none is in the seat
        assert aiko.grip(side).place[-1, 2] > aiko.root[-1, 2]


@pytest.mark.timeout(60)
def test_two_who_sit_far_apart_are_told_that_one_is_to_stand_up(tmp_path: Path) -> None:
    _, said = play(
        tmp_path,
        "add floor\nadd chair at 0 0 0 facing 0\nadd chair as other at 2.5 0 0 facing 180\n"
        "human ken body ken at 1.7 0.1 facing 0\nhuman aiko body aiko at 0.8 0.1 facing 180\n"
        "aiko: do chair sit\nken: do other sit\nsync\naiko: do ken talk seconds=1\n",
    )
    (line,) = said[0] + said[1]
    assert (
        "m off and sits on other; one must stand to meet them there; `do chair stand_up` first, or ask ken to" in line
    )


@pytest.mark.timeout(60)
def test_who_sits_is_told_of_who_stands_behind_and_does_not_come(tmp_path: Path) -> None:
    _, said = play(
        tmp_path,
        "add floor\nadd chair at 0 0 0 facing 0\n"
        "human ken body ken at -1.1 0 facing 0\nhuman aiko body aiko at 0.8 0 facing 180\n"
        "aiko: do chair sit\nsync\naiko: do ken talk seconds=1 patience=1\n",
    )
    assert any("180 degrees aside and does not come; one must stand" in line for line in said[1])


@pytest.mark.timeout(60)
def test_who_comes_to_one_who_sits_between_tables_is_told_that_they_are_to_stand_up(tmp_path: Path) -> None:
    _, said = play(
        tmp_path,
        "add floor\nadd chair at 0 0 0 facing 0\n"
        "human ken body ken at -1.6 0.2 facing 0\nhuman aiko body aiko at 0.9 0 facing 180\n"
        "aiko: do chair sit\nsync\n"
        "add table at 1.05 0 0 facing 90\nadd table as left at 0 1.05\nadd table as right at 0 -1.05\nwait 0.5\n"
        "ken: do aiko talk seconds=1\n",
    )
    (line,) = said[0] + said[1]
    assert (
        "room nowhere before aiko, who sits on chair, table, left, right being there; ask aiko to stand up, by" in line
    )
