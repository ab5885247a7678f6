"""Beside furniture, in an order that no example has: bending, rising and sitting down, one is in no table or chair."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, to_rotation_vector
from ahmss.main.play import PlaySetup, play_script

from .conftest import ROOT
from .recorded import Recorded
from .scenario import Met, met
from .test_put import fastest_arm

pytestmark = pytest.mark.timeout(180)

BOTH = ["ken", pytest.param("aiko", marks=pytest.mark.long)]
FLOOR = """
add room
add cup as two at 1.43 0.16 0
human {human} body {human} at 1.75 0.62 facing 220
do two grasp
{then}
do floor walk to 1.9 1.1
"""
SEAT = """
add room
remove room/cup
add cup at 1.1 0.1 0.88
human {human} body {human} at 1.75 0.2 facing 180
do cup grasp
do cup lift
do cup put to 1.1 0.1
do cup release
do chair sit
wait 0.2
"""
DOOR = """
add room
human {human} body {human} at 1.78 0.2 facing 180
do door open
wait 0.2
"""


def played(directory: Path, script: str, human: str) -> tuple[Recorded, list[Met]]:
    """What was shown, and where the body was in furniture by more than 3 mm."""
    (directory / "beside.txt").write_text(script)
    setup = PlaySetup(workspace=ROOT, fast=True, record=directory / "r.rec")
    assert play_script(directory / "beside.txt", setup).failures == 0
    skin = met(directory / "r.rec", human, ROOT, 3, 0.003)
    shown = Recorded.read(directory / "r.rec", human, ())
    return shown, [one for one in skin if one.thing in ("room/table", "room/chair")]


@pytest.mark.parametrize("human", BOTH)
@pytest.mark.parametrize("then", [pytest.param("", marks=pytest.mark.long), "do two lift"])
def test_what_stands_on_the_floor_beside_a_table_is_taken_and_carried_off(
    tmp_path: Path, human: str, then: str
) -> None:
    shown, skin = played(tmp_path, FLOOR.format(human=human, then=then), human)
    assert skin == []
    hips = shown.links[0][:, INDEX["hips"], 2]
    assert hips.min() < 0.62 < 0.85 < hips[-1]
    assert fastest_arm(shown) < 7.0


@pytest.mark.parametrize("human", BOTH)
def test_who_has_let_go_of_something_on_a_table_sits_down_before_it(tmp_path: Path, human: str) -> None:
    shown, skin = played(tmp_path, SEAT.format(human=human), human)
    assert skin == []
    assert shown.links[0][-1, INDEX["hips"], 2] < 0.62
    assert fastest_arm(shown) < 7.0


@pytest.mark.parametrize("human", BOTH)
def test_who_comes_to_a_door_from_afar_turns_the_head_to_its_lever_in_no_haste(tmp_path: Path, human: str) -> None:
    shown, skin = played(tmp_path, DOOR.format(human=human), human)
    assert skin == []
    head = shown.rotations[:, INDEX["head"]]
    turned = np.linalg.norm(to_rotation_vector(multiply(conjugate(head[:-1]), head[1:])), axis=-1)
    assert np.degrees(turned.max()) < 5.0


READING = """
add control_room
add table at 0.5 -1.1 0 facing -90
add cup at 0.36 -0.75 0.88
human {human} body {human} at 0.4 -0.2 facing -90
do cup grasp
do cup lift
do gauge_3 check
wait 0.2
"""


@pytest.mark.parametrize("human", BOTH)
def test_who_reads_a_gauge_over_a_console_keeps_what_is_in_the_hand_out_of_it(tmp_path: Path, human: str) -> None:
    """A cup was 113 mm in the console for eight seconds, and the hand with it."""
    (tmp_path / "beside.txt").write_text(READING.format(human=human))
    setup = PlaySetup(workspace=ROOT, fast=True, record=tmp_path / "r.rec")
    assert play_script(tmp_path / "beside.txt", setup).failures == 0
    skin = met(tmp_path / "r.rec", human, ROOT, 3, 0.004)
    assert [one for one in skin if one.thing.startswith("control_room/panel")] == []
