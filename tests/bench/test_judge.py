"""The judgement as a table: 23 rows with what is worse than real; and a real script played for it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ahmss.bench import judge
from ahmss.bench.acted import act
from ahmss.bench.measures import BOUNDS, UNITS
from ahmss.bench.run import main
from ahmss.bench.survey import Doing
from ahmss.database.workspace import Workspace
from ahmss.errors import CommandError
from ahmss.motion.easing import minimum_jerk

from .made import ROOT, WALK, moved, standing, stepping

DOOR, SWITCH = Doing("door", "open"), Doing("switch", "press")
WORKSPACE = Workspace.find(ROOT)
SCRIPT = """
add room
human aiko body aiko at -0.3 1.4 facing 0
wait 0.2
do floor walk to 0.6 1.4
"""


def glided() -> judge.Judgement:
    """A door opened well, a walk that slides, and a switch pressed well."""
    still = standing(240)
    way = 0.3 * minimum_jerk(np.clip((np.arange(240) - 80) / 80, 0.0, 1.0))[:, None] * np.array([1.0, 0.0, 0.0])
    doings = ((DOOR,),) * 80 + ((WALK,),) * 80 + ((SWITCH,),) * 80
    return judge.judged(replace(moved(still, way), doings=doings, failures=("cup drink: gone",)), WORKSPACE)


def test_there_are_23_items_and_what_was_not_played_says_so() -> None:
    judgement = glided()
    assert len(judgement.items) == 23
    assert [item.name for item in judgement.played] == [
        "opens, closes the door",
        "->",
        "walks",
        "->",
        "presses the switch",
    ]
    rows = judge.markdown(judgement).splitlines()
    assert rows[2].startswith("| opens, closes the door | 3.2 | 1.3 |")
    assert sum("not played" in row for row in rows) == 18
    assert all(row.count("|") == rows[0].count("|") for row in rows if row.startswith("|"))
    assert rows[-1] == "- failed: cup drink: gone"


def test_the_walk_that_slides_is_named_and_the_door_is_not() -> None:
    judgement = glided()
    door, _, walk, *_ = judgement.items
    assert door not in judgement.worse
    assert walk in judgement.worse
    text = judge.markdown(judgement)
    assert "5 of 23 items played, 3 of them worse" in text
    assert "\n- walks: slide 30.0 > 7.0 cm, drift 300.0 > 1.0 mm, feet p95 0.42" in text
    assert "| **30.0** | **300.0** |" in text


def test_the_pause_between_two_actions_is_told() -> None:
    still = standing(240)
    doings = ((DOOR,),) * 60 + ((),) * 90 + ((WALK,),) * 60 + ((SWITCH,),) * 30
    items = judge.judged(replace(still, doings=doings), WORKSPACE).items
    assert items[1].measured is not None
    assert items[1].measured.pause == pytest.approx(1.5)
    assert items[0].measured is not None
    assert items[0].measured.pause is None


def test_json_has_every_figure_and_what_it_is_compared_with() -> None:
    told = json.loads(json.dumps(judge.to_json(glided())))
    door, seam = told["items"][:2]
    assert set(UNITS) < set(door)
    assert (door["thesis"], door["real"], door["worse"]) == (3.2, "a box picked up", [])
    assert (seam["real"], seam["pause_s"]) == ("a box picked up", 0.0)
    assert told["items"][-1] == {"name": "sits down", "thesis": 3.6, "seconds": 0.0, "played": False}
    assert set(told["real"]["walking"]) == set(UNITS) - set(BOUNDS)


def test_an_item_in_which_steps_are_made_is_set_beside_walking_and_one_without_is_not() -> None:
    pressing = replace(SWITCH, carries=True)  # it would step there
    doings = ((DOOR,),) * 80 + ((WALK,),) * 80 + ((pressing,),) * 80
    door, _, walk, _, press = judge.judged(replace(stepping(standing(240), 0.3), doings=doings), WORKSPACE).played
    clips = [item.measured.bar.clips for item in (door, walk, press) if item.measured is not None]
    assert clips == ["a box picked up", "walking", "a box picked up"]


def test_a_script_is_played_and_noted_frame_by_frame(tmp_path: Path) -> None:
    path = tmp_path / "walk.txt"
    path.write_text(SCRIPT)
    acted = act(path, WORKSPACE)
    frames = len(acted.root)
    assert acted.failures == ()
    assert len(acted.doings) == frames == len(acted.wanted) == len(acted.things["room/cup"].poses)
    walking = [k for k, doings in enumerate(acted.doings) if doings == (WALK,)]
    assert walking[0] == 0
    assert walking == list(range(len(walking)))
    assert acted.root[-1, 0] - acted.root[0, 0] == pytest.approx(0.9, abs=0.02)
    assert np.isnan(acted.wanted).all()
    assert acted.things["room/cup"].kind == "cup"
    assert acted.body == "aiko"


def test_a_script_of_two_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "two.txt"
    path.write_text("add room\nhuman ken body ken at 0 0\nhuman aiko body aiko at 0 1\nken: wait 1\n")
    with pytest.raises(CommandError, match="2 humans"):
        act(path, WORKSPACE)


def test_the_command_prints_what_it_played(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "walk.txt"
    path.write_text(SCRIPT)
    assert main(["--judge", "--script", str(path), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert len(told["items"]) == 23
    assert not any(item["played"] for item in told["items"])  # a walk alone is between nothing


@pytest.mark.long
def test_all_of_the_scenario_is_played_and_measured() -> None:
    judgement = judge.judge(ROOT / judge.SCRIPT, WORKSPACE)
    assert judgement.failures == ()
    assert len(judgement.played) == 23
