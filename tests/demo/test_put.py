"""A cup is grasped and put down as a newcomer says it: without a reach, onto a thing, or out of reach from here."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, rotate, to_rotation_vector
from ahmss.main.play import PlaySetup, play_script
from ahmss.motion.smoothness import worst_pop

from .conftest import CUP, ROOT
from .recorded import Recorded
from .scenario import Met, met

pytestmark = pytest.mark.timeout(180)

AGAIN = (1.05, 0.1)  # metres: at the table's other side
SCRIPT = f"""
add room
human ken body ken at -0.6 0.5 facing 0
do floor walk to cup
do cup grasp
do cup lift
do cup put to table
do cup release
do cup grasp
do cup lift
do cup put to {AGAIN[0]} {AGAIN[1]}
do cup release
do floor stand
wait 0.2
"""
BESIDE = """
add floor
add table at 0.77 0.2
add cup at 0.42 -0.15 0.88
human ken body ken at -0.05 -0.15 facing 0
do cup grasp
do cup lift
do cup put to {place}
wait 0.3
"""
LOW = """
add table at 0 0 0 facing 110.9
add cup at 0.2382 -0.3101 0.88
add floor
human ken body ken at 0.399 -0.730 facing 110.9
do cup grasp
do cup lift
do cup put to 0.088 0.082
do cup release
wait 0.2
"""
IN_THE_ROOM = """
add room
human ken body ken at 0 0 facing -20
do cup grasp
do cup lift
do cup put to 0.9 -0.2
do cup release
do cup grasp hand left
do cup lift
wait 0.2
"""
TURNS_BESIDE = """
add floor
add table at 42 0 0 facing -1.5
add cup at 41.6658 -0.2088 0.88
human ken body ken at 41.216 -0.197 facing -1.5
do cup grasp
do cup put to 42.146 -0.221
wait 0.2
"""
AMIDST = """
add floor
add table at 0.77 0.2
add table at 1.77 0.2
add table at 0.77 1.4
add table at 1.77 1.4
add table at 0.77 -1
add table at 1.77 -1
add cup at 0.42 -0.15 0.88
human ken body ken at -0.05 -0.15 facing 0
do cup grasp
do cup lift
do cup put to 1.0 -0.15
wait 0.2
"""
TOP = 0.88  # metres


@dataclass(frozen=True)
class Played:
    """What was recorded, how often the cup came to rest after it was held, and what the skin was in."""

    shown: Recorded
    rests: list[np.ndarray]
    met: list[Met]


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory) -> Played:
    folder: Path = tmp_path_factory.mktemp("put")
    (folder / "put.txt").write_text(SCRIPT)
    assert (
        play_script(folder / "put.txt", PlaySetup(workspace=str(ROOT), fast=True, record=folder / "r.rec")).failures
        == 0
    )
    shown = Recorded.read(folder / "r.rec", "ken", (CUP,))
    holders = np.array([holder == "ken" for holder in shown.holders[CUP]])
    let_go = np.flatnonzero(holders[:-1] & ~holders[1:]) + 1
    rests = [shown.objects[CUP][min(frame + 10, len(holders) - 1)] for frame in let_go]
    return Played(shown, rests, met(folder / "r.rec", "ken", ROOT, 4))


def test_it_stands_on_the_table_each_time_and_where_it_was_said(played: Played) -> None:
    assert len(played.rests) == 2
    for pose in played.rests:
        assert pose[2] == pytest.approx(TOP, abs=1e-3)
        assert rotate(pose[3:], np.array([0.0, 0.0, 1.0]))[2] > 0.9999
    np.testing.assert_allclose(played.rests[1][:2], AGAIN, atol=2e-3)
    assert np.hypot(*(played.rests[0][:2] - AGAIN)) > 0.4


def test_it_is_in_the_hand_until_it_stands(played: Played) -> None:
    cup = played.shown.objects[CUP]
    held = [k for k, holder in enumerate(played.shown.holders[CUP]) if holder == "ken"]
    assert cup[held[0] : held[-1], 2].min() > TOP - 1e-3
    steps = np.linalg.norm(np.diff(cup[:, :3], axis=0), axis=1)
    assert steps.max() < 0.05  # it falls nowhere, and nobody throws it


def test_nothing_of_the_human_is_in_the_table(played: Played) -> None:
    worst = [one for one in played.met if one.thing == "room/table"]
    assert max((one.depth for one in worst), default=0.0) < 0.004, worst[0]


def test_no_joint_pops(played: Played) -> None:
    pop = worst_pop(played.shown.rotations)
    assert pop.degrees < 5.0, pop


def said(folder: Path, place: str, then: str = "") -> tuple[Recorded, list[Met], list[str]]:
    """What is recorded of a cup that is put somewhere from beside a table, what skin is in, and what was told."""
    (folder / "put.txt").write_text(BESIDE.format(place=place) + then)
    report = play_script(folder / "put.txt", PlaySetup(workspace=str(ROOT), fast=True, record=folder / "r.rec"))
    told = [line for main in report.mains for line in main["messages"]]
    return Recorded.read(folder / "r.rec", "ken", ("cup",)), met(folder / "r.rec", "ken", ROOT, 2), told


def test_who_would_have_to_stretch_for_a_place_steps_to_it(tmp_path: Path) -> None:
    shown, skin, told = said(tmp_path, "0.9 -0.15")
    assert told == []
    assert np.linalg.norm(shown.root[-1, :2] - shown.root[0, :2]) > 0.5
    np.testing.assert_allclose(shown.objects["cup"][-1, :3], [0.9, -0.15, TOP], atol=2e-3)
    assert max((one.depth for one in skin if one.thing == "table"), default=0.0) < 0.004


@pytest.mark.long
def test_a_place_to_which_no_arm_brings_it_upright_is_refused_and_it_stays_in_the_hand(tmp_path: Path) -> None:
    shown, _, told = said(tmp_path, "-0.6 0.6 2.6")
    (line,) = told
    assert "cup put" in line
    assert "say a place" in line
    assert "stand up" not in line
    up = rotate(shown.objects["cup"][:, 3:], np.array([0.0, 0.0, 1.0]))[:, 2]
    assert up.min() > 0.85
    assert shown.holders["cup"][-1] == "ken"


@pytest.mark.long
def test_a_hand_that_has_let_go_over_a_table_is_not_let_down_through_it_as_one_walks_off(tmp_path: Path) -> None:
    shown, skin, told = said(tmp_path, "0.62 -0.2", "do cup release\ndo floor walk to -0.8 0.9\n")
    assert told == []
    assert shown.root[-1, 0] < -0.7
    assert max((one.depth for one in skin if one.thing == "table"), default=0.0) < 0.004, skin[0]


@pytest.mark.long
def test_where_the_elbow_would_be_in_the_table_one_steps_nearer(tmp_path: Path) -> None:
    """The hand would come there: 0.61 m before the shoulder, trunk and arm bent down to the board."""
    (tmp_path / "put.txt").write_text(LOW)
    setup = PlaySetup(workspace=str(ROOT), fast=True, record=tmp_path / "r.rec")
    assert play_script(tmp_path / "put.txt", setup).failures == 0
    shown = Recorded.read(tmp_path / "r.rec", "ken", ("cup",))
    np.testing.assert_allclose(shown.objects["cup"][-1, :3], [0.088, 0.082, TOP], atol=2e-3)
    skin = met(tmp_path / "r.rec", "ken", ROOT, 2)
    assert max((one.depth for one in skin if one.thing == "table"), default=0.0) < 0.004, skin[0]


@pytest.mark.long
def test_nobody_reaches_through_a_wall_and_what_was_put_far_off_is_taken_again(tmp_path: Path) -> None:
    """The nearest place to stand would be behind the room's wall, the other ways to bend flat over the table."""
    (tmp_path / "put.txt").write_text(IN_THE_ROOM)
    setup = PlaySetup(workspace=str(ROOT), fast=True, record=tmp_path / "r.rec")
    assert play_script(tmp_path / "put.txt", setup).failures == 0
    shown = Recorded.read(tmp_path / "r.rec", "ken", (CUP,))
    assert shown.root[:, 1].min() > -0.4  # the wall is at -0.5
    trunk = rotate(shown.links[1][:, INDEX["spine"]], np.array([1.0, 0.0, 0.0]))
    assert trunk[:, 2].min() > 0.4
    assert fastest_arm(shown) < 7.0
    skin = met(tmp_path / "r.rec", "ken", ROOT, 2, 0.002)
    assert [one for one in skin if one.thing != CUP] == []


def test_who_steps_to_a_put_keeps_the_free_hand_out_of_the_table_from_the_first_step_on(tmp_path: Path) -> None:
    (tmp_path / "put.txt").write_text(TURNS_BESIDE)
    setup = PlaySetup(workspace=str(ROOT), fast=True, record=tmp_path / "r.rec")
    assert play_script(tmp_path / "put.txt", setup).failures == 0
    shown = Recorded.read(tmp_path / "r.rec", "ken", ("cup",))
    np.testing.assert_allclose(shown.objects["cup"][-1, :3], [42.146, -0.221, TOP], atol=2e-3)
    assert fastest_arm(shown) < 7.0
    assert [one for one in met(tmp_path / "r.rec", "ken", ROOT, 1, 0.002) if one.thing == "table"] == []


def test_a_hand_that_lets_go_over_a_desk_keeps_its_fingers_out_of_it(tmp_path: Path) -> None:
    """They came to rest as the hand was drawn back, and were 15 mm in its top, which is 30 mm thick."""
    (tmp_path / "put.txt").write_text(
        "add floor\nadd desk at 0 0 0\nadd manual at 0.285 0 0.72 facing 0\nhuman ken body ken at 0.75 0 facing 180\n"
        "do manual take\ndo manual put to 0.15 0 0.8\n"
    )
    report = play_script(tmp_path / "put.txt", PlaySetup(workspace=str(ROOT), fast=True, record=tmp_path / "r.rec"))
    assert report.failures == 0
    skin = met(tmp_path / "r.rec", "ken", ROOT, 2)
    assert max((one.depth for one in skin if one.thing == "desk"), default=0.0) < 0.004, skin[0]


def test_on_the_floor_it_is_put_crouching(tmp_path: Path) -> None:
    shown, skin, told = said(tmp_path, "-0.5 0.6", "do cup release\ndo floor stand\n")
    assert told == []
    np.testing.assert_allclose(shown.objects["cup"][-1, :3], [-0.5, 0.6, 0.0], atol=2e-3)
    hips = shown.links[0][:, INDEX["hips"], 2]
    assert hips.min() < 0.7 < 0.85 < hips[-1]
    assert fastest_arm(shown) < 7.0
    assert max((one.depth for one in skin if one.thing != "floor"), default=0.0) < 0.002, skin[0]


def test_a_place_that_is_too_low_or_too_far_off_is_refused_before_anybody_moves(tmp_path: Path) -> None:
    shown, _, told = said(tmp_path, "-0.5 0.6 -0.4", "do cup put to 14 9\n")
    low, far = told
    assert re.search(r"-0.50 0.60 -0.40 is too low, 1.3\d m under the hips: .*; say a place that is higher", low)
    assert re.search(r"14.00 9.00 0.00 is 1\d.\d m from here, too far to step there; walk to it first", far)
    feet = shown.links[0][:, [INDEX["right_foot"], INDEX["left_foot"]]]
    assert np.ptp(feet, axis=0).max() < 0.005
    assert shown.holders["cup"][-1] == "ken"


@pytest.mark.long
def test_in_the_midst_of_tables_the_nearest_place_that_serves_is_told(tmp_path: Path) -> None:
    (tmp_path / "put.txt").write_text(AMIDST)
    report = play_script(tmp_path / "put.txt", PlaySetup(workspace=str(ROOT), fast=True))
    (line,) = [line for main in report.mains for line in main["messages"]]
    found = re.search(
        r"nobody can stand nearer to 1.00 -0.15 0.88 than \d.\d\d m; the nearest place that serves is (.*)", line
    )
    assert found, line
    x, y, z = map(float, found[1].split())
    assert z == pytest.approx(TOP)
    (tmp_path / "put.txt").write_text(AMIDST.replace("put to 1.0 -0.15", f"put to {x} {y}"))
    assert play_script(tmp_path / "put.txt", PlaySetup(workspace=str(ROOT), fast=True)).failures == 0


def fastest_arm(shown: Recorded) -> float:
    """Degrees that a joint of an arm turns in a frame at the most."""
    turned = to_rotation_vector(multiply(conjugate(shown.rotations[:-1]), shown.rotations[1:]))
    arms = [INDEX[f"{side}_{link}"] for side in ("right", "left") for link in ("upper_arm", "lower_arm", "hand")]
    return float(np.degrees(np.linalg.norm(turned[:, arms], axis=-1).max()))
