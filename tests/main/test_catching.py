"""An object that asks for it is told when the hand has closed on it: by the word of the motion, or as it ends."""

from collections.abc import Callable
from pathlib import Path

import pytest

from ahmss.main.process import MainProcess
from ahmss.world.process import ServerProcess
from tests.main.conftest import write_algorithm
from tests.main.ground import steps

Start = Callable[..., ServerProcess]
Join = Callable[..., MainProcess]

CLOSES = '''
from ahmss.algorithm import HumanTask, run

def closes(task: HumanTask):
    """Fifty frames, whatever was asked for; the hand has closed in one of them, if it says so."""
    for k in range(1, 51):
        said = {"held": "here"} if k == task.parameter("says", 0) else {}
        yield task.pose({}, None, None, None, said)

run(closes)
'''
NOTES = '''
from ahmss.algorithm import ObjectTask, run

def notes(task: ObjectTask):
    """The first frame in which the hand has closed, and how many were shown."""
    first = 0
    for human in task.frames():
        first = first or (human.k if task.closed else 0)
        yield task.pose(None, None, {"first": float(first), "shown": float(human.k)})

run(notes)
'''
SAYS = '[parameters.says]\ntype = "int"\ndefault = 0\n'
KIND = """
[states.first]
range = [0, 1000]

[states.shown]
range = [0, 1000]

[affordances.shut]
human_algorithm = "closes"
object_algorithm = "notes"
hold = "take"
frames = 20

[affordances.follow]
human_algorithm = "closes"
object_algorithm = "notes"
frames = 20

[affordances.deaf]
human_algorithm = "closes"
object_algorithm = "deaf"
hold = "take"
frames = 20
"""


@pytest.fixture
def ken(server: Start, join: Join, workspace: Path) -> MainProcess:
    """A main, with a box on which a hand closes that takes longer than its action says."""
    write_algorithm(workspace, "closes", "human", "stretches = true\n" + SAYS, CLOSES)
    write_algorithm(workspace, "notes", "object", "catches = true\n", NOTES)
    write_algorithm(workspace, "deaf", "object", "", NOTES.replace("notes", "deaf"))
    with (workspace / "objectdb/box/object.toml").open("a") as file:
        file.write(KIND)
    main = join(server(lockstep=["ken"]), fast=True, names=("ken",))
    main.play(steps("add box as b at 0.3 0 1"))
    return main


def told(ken: MainProcess, line: str) -> tuple[float, float]:
    """The first frame in which the hand had closed, as the object was told, and how many it was shown."""
    ken.play(steps(line, "wait 0.2"))
    assert ken.report.messages == []
    states = ken.communication.update(complete=True).objects["b"].states
    return float(states["first"]), float(states["shown"])


def test_who_says_nothing_has_closed_when_the_motion_is_over(ken: MainProcess) -> None:
    first, shown = told(ken, "do b shut")
    assert 50 <= first <= 51 < shown


def test_who_says_it_on_the_way_has_closed_in_that_frame(ken: MainProcess) -> None:
    assert told(ken, "do b shut says=33")[0] == 33


def test_where_so_many_frames_are_asked_for_the_last_of_them_has_closed(ken: MainProcess) -> None:
    assert told(ken, "do b shut frames 40")[0] == 40


def test_what_is_not_taken_needs_no_hand_that_closes(ken: MainProcess) -> None:
    assert told(ken, "do b follow")[0] == 1


def test_who_does_not_ask_is_told_nothing(ken: MainProcess) -> None:
    first, shown = told(ken, "do b deaf")
    assert first == 0
    assert shown > 50
