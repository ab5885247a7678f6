"""Who goes to where they act has what they act on when they are there, and comes to a stand where they are stopped."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import pytest

from ahmss.main.process import MainProcess
from ahmss.world.process import ServerProcess
from tests.main.conftest import write_algorithm
from tests.main.ground import steps

Start = Callable[..., ServerProcess]
Join = Callable[..., MainProcess]
Two = tuple[MainProcess, MainProcess]

VISIT = '''
import itertools
from ahmss.algorithm import HumanTask, run

def visit(task: HumanTask):
    """A centimetre a frame for a metre, unless it is there; told to rest it stands ten frames later."""
    rests = 0
    while task.present.root[0] < 1.0 and rests < 10:
        rests += task.rests
        root = task.present.root.copy()
        root[0] += 0.01
        yield task.pose({}, root)
    task.arrived()
    task.note(f"the lid is {task.object.states['lid']}")
    for _ in range(30):
        yield task.pose({}, task.present.root.copy())

run(visit)
'''
SETTLE = '''
from ahmss.algorithm import HumanTask, run

def settle(task: HumanTask):
    """Half way the seat bears one: until then one rises where one is to rest, and then one sits."""
    for k in range(60):
        if k < 30:
            task.refuse_rest()
        yield task.pose({}, task.present.root.copy(), states={"held": "here"} if k == 30 else {})

run(settle)
'''
CARRIED = """
[affordances.fetch]
human_algorithm = "visit"
object_algorithm = "carry"
frames = 0

[affordances.push]
human_algorithm = "pass_by"
object_algorithm = "carry"
frames = 0

[affordances.put_there]
human_algorithm = "pass_by"
object_algorithm = "carry"
hold = "release"
frames = 0

[affordances.sit]
human_algorithm = "settle"
object_algorithm = "carry"
hold = "take"
needs = { free_hands = 0 }
frames = 0
"""


@pytest.fixture
def two(server: Start, join: Join, workspace: Path) -> Two:
    """A box, and two that are a metre away."""
    write_algorithm(workspace, "visit", "human", "arrives = true\ncarries = true\n", VISIT)
    write_algorithm(workspace, "pass_by", "human", "rests = true\ncarries = true\n", VISIT.replace("visit", "pass_by"))
    write_algorithm(workspace, "settle", "human", "rests = true\n", SETTLE)
    file = workspace / "objectdb" / "box" / "object.toml"
    file.write_text(f"{file.read_text()}\n{CARRIED}")
    here = server()
    ken, aiko = join(here), join(here, "aiko", body="aiko", place=(0.0, 1.0))
    add(ken, "add box as b at 1.2 0.5 1")
    go_on((ken, aiko), lambda: ken.agenda.done and "b" in aiko.communication.world.objects)
    return ken, aiko


def add(main: MainProcess, *lines: str) -> None:
    for step in steps(*lines):
        main.agenda.add(step)


def go_on(mains: tuple[MainProcess, ...], until: Callable[[], bool]) -> None:
    end = time.monotonic() + 20.0
    while not until():
        assert time.monotonic() < end, [main.report.messages for main in mains]
        for main in mains:
            main.frame()
        time.sleep(0.002)


def walked(main: MainProcess) -> float:
    return float(main.blending.root[0])


def holder(main: MainProcess) -> str:
    return main.communication.world.objects["b"].holder


def test_who_is_on_the_way_leaves_it_to_who_is_there(two: Two) -> None:
    ken, aiko = two
    add(aiko, "do b fetch")
    go_on(two, lambda: walked(aiko) > 0.3)
    assert holder(ken) == ""
    add(ken, "do b take frames 20 patience=0", "do b drop frames 10")
    until = time.monotonic() + 20.0
    while not ken.agenda.done:
        assert time.monotonic() < until, ken.report.messages
        held = ken.control.held_frames
        ken.frame()
        if ken.control.held_frames == held and ken.control.contributions:  # however long ken's algorithms take to start
            aiko.frame()
        time.sleep(0.002)
    assert walked(aiko) < 1.0
    go_on(two, lambda: aiko.agenda.done)
    assert ken.report.messages == aiko.report.messages == []


def test_who_comes_to_what_is_taken_waits_there_and_says_so(two: Two) -> None:
    ken, aiko = two
    add(ken, "do b take frames 20")
    go_on(two, lambda: holder(aiko) == "ken")
    add(aiko, "do b fetch")
    go_on(two, lambda: walked(aiko) > 0.99)
    for _ in range(60):
        for main in two:
            main.frame()
    assert not aiko.agenda.done
    assert "b fetch: waits for ken, who has b" in aiko.report.notes
    add(ken, "do b drop frames 10")
    go_on(two, lambda: holder(ken) == "aiko")
    assert walked(aiko) < 1.02  # from there, and not once more
    go_on(two, lambda: aiko.agenda.done)
    assert aiko.report.messages == []


def test_where_nobody_would_wait_it_is_refused_before_a_step(two: Two) -> None:
    ken, aiko = two
    add(ken, "do b take frames 20")
    go_on(two, lambda: holder(aiko) == "ken")
    add(aiko, "do b fetch patience=0")
    go_on(two, lambda: aiko.agenda.done)
    assert aiko.report.messages == ["b fetch: b is held by ken"]
    assert walked(aiko) < 0.01


def test_what_has_changed_on_the_way_is_planned_for_as_it_is_now(two: Two) -> None:
    ken, aiko = two
    add(aiko, "do b fetch")
    go_on(two, lambda: walked(aiko) > 0.3)
    add(ken, "set b lid open")
    go_on((ken,), lambda: ken.communication.world.objects["b"].states["lid"] == "open")  # aiko walks no further until
    go_on(two, lambda: aiko.agenda.done)
    assert "b fetch: the lid is open" in aiko.report.notes
    assert aiko.report.messages == []


def test_who_is_stopped_on_the_way_comes_to_a_stand(two: Two) -> None:
    _, aiko = two
    add(aiko, "do b fetch")
    go_on(two, lambda: walked(aiko) > 0.3)
    aiko.stop_motion()
    before = walked(aiko)
    go_on(two, lambda: aiko.agenda.done)
    assert 0.09 < walked(aiko) - before < 0.15
    assert aiko.report.notes == aiko.report.messages == []
    assert holder(aiko) == ""


def test_who_is_stopped_once_there_stops_at_once(two: Two) -> None:
    _, aiko = two
    add(aiko, "do b fetch")
    go_on(two, lambda: holder(aiko) == "aiko")
    aiko.stop_motion()
    aiko.frame()
    assert not aiko.control.busy
    go_on(two, lambda: holder(aiko) == "")


def test_who_claims_it_before_they_go_rests_on_the_way_as_well_and_once_there_stops_at_once(two: Two) -> None:
    _, aiko = two
    add(aiko, "do b push")
    go_on(two, lambda: walked(aiko) > 0.3)
    assert holder(aiko) == "aiko"
    aiko.stop_motion()
    before = walked(aiko)
    go_on(two, lambda: aiko.agenda.done)
    assert 0.09 < walked(aiko) - before < 0.15
    go_on(two, lambda: holder(aiko) == "")
    add(aiko, "do b push")
    go_on(two, lambda: walked(aiko) >= 0.999 and bool(aiko.report.notes))
    aiko.stop_motion()
    aiko.frame()
    assert not aiko.control.busy


def test_who_is_stopped_on_the_way_to_where_they_put_it_down_has_it_in_the_hand_as_before(two: Two) -> None:
    _, aiko = two
    add(aiko, "do b take frames 10", "do b put_there")
    go_on(two, lambda: walked(aiko) > 0.3)
    aiko.stop_motion()
    go_on(two, lambda: aiko.agenda.done)
    for _ in range(20):
        aiko.frame()
    assert holder(aiko) == "aiko"
    assert aiko.control.holds == {"b": "right"}


@pytest.mark.parametrize(("at", "sits"), [(10, False), (40, True)])
def test_what_bears_who_is_stopped_as_they_sit_down_is_theirs_and_else_it_is_free(
    two: Two, at: int, sits: bool
) -> None:
    _, aiko = two
    add(aiko, "do b sit")
    go_on(two, lambda: bool(aiko.control.progress) and aiko.control.progress[0][1] >= at)
    aiko.stop_motion()
    go_on(two, lambda: aiko.agenda.done)
    go_on(two, lambda: holder(aiko) == ("aiko" if sits else ""))
    assert ("b" in aiko.control.holds) == sits
