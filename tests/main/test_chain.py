"""Motions that follow each other beside others, and one that lasts as long as these."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, to_rotation_vector
from ahmss.main.command import Do, parse
from ahmss.main.process import MainProcess
from ahmss.world.process import ServerProcess
from tests.main.conftest import write_algorithm
from tests.main.ground import steps

HOLD = """
[affordances.hold]
human_algorithm = "still"
frames = 0

[affordances.carry]
human_algorithm = "still"
hold = "keep"
frames = 0

[affordances.grab]
human_algorithm = "swing"
object_algorithm = "carry"
hold = "take"
first = "touch"
site = "top"
frames = 12
"""
STILL = """
from ahmss.algorithm import HumanTask, run

def still(task: HumanTask):
    for _ in task.frames():
        yield task.pose({"left_upper_arm": task.start.rotations[9]})

run(still)
"""


@pytest.fixture
def ken(server: Callable[..., ServerProcess], join: Callable[..., MainProcess], workspace: Path) -> MainProcess:
    write_algorithm(workspace, "still", "human", "accompanies = true\n", STILL)
    with (workspace / "objectdb/box/object.toml").open("a") as file:
        file.write(HOLD)
    main = join(server(lockstep=["ken"]), fast=True, names=("ken",))
    main.play(steps("add box as b at 0.3 0 1"))
    return main


def frames_of(ken: MainProcess, line: str) -> int:
    """How many frames a line takes, while which the arm is watched."""
    before = ken.report.frames
    for step in steps(line):
        ken.agenda.add(step)
    while not ken.agenda.done:
        ken.frame()
    return ken.report.frames - before


def made_of(ken: MainProcess, line: str) -> list[str]:
    """The actions that a line is made of, in the order in which they begin."""
    for step in steps(line):
        ken.agenda.add(step)
    made: dict[str, None] = {}
    while not ken.agenda.done:
        ken.frame()
        made |= dict.fromkeys(title.removeprefix("b ") for title, at, _ in ken.control.progress if at)
    assert ken.report.messages == []
    return list(made)


def angle(ken: MainProcess, link: str, before: np.ndarray) -> float:
    now = ken.blending.rotations[INDEX[link]]
    return float(np.linalg.norm(to_rotation_vector(multiply(conjugate(before[INDEX[link]]), now))))


def test_then_is_read_as_one_act_that_follows_another() -> None:
    line = parse("do floor walk to cup with cup reach then cup grasp after 5 with lamp look")
    assert isinstance(line, Do)
    assert [act.follows for act in line.acts] == [False, False, True, False]
    assert line.acts[2].after == 5


def test_the_second_begins_when_the_first_has_ended(ken: MainProcess) -> None:
    alone = frames_of(ken, "do b wave frames 20")
    before = ken.blending.rotations.copy()
    assert frames_of(ken, "do b bow frames 50 with b wave frames 20 then b wave frames 20") == alone + 30
    frames_of(ken, "wait 0.5")
    np.testing.assert_allclose(angle(ken, "right_upper_arm", before), 1.2, atol=0.02)
    np.testing.assert_allclose(angle(ken, "spine", before), 0.6, atol=0.02)


def test_what_is_taken_first_may_be_used_then(ken: MainProcess) -> None:
    ken.play(steps("do b take frames 12 hand right then b shake frames 20"))
    assert ken.report.messages == []
    assert ken.control.holds == {"b": "right"}


def test_what_brings_the_hand_there_comes_first_wherever_one_has_come_by_then(ken: MainProcess) -> None:
    ken.play(steps("do b step to -0.3 0 frames 5"))  # far from it, and back
    assert made_of(ken, "do b step to 0 0 frames 5 then b grab hand right then b shake frames 5") == [
        "step", "touch", "grab", "shake",
    ]  # fmt: skip
    assert ken.control.holds == {"b": "right"}


def test_a_hand_that_has_been_brought_there_is_not_brought_again(ken: MainProcess) -> None:
    assert made_of(ken, "do b touch hand right then b grab hand right") == ["touch", "grab"]


def test_who_takes_hold_waits_before_that_as_long_as_was_said(ken: MainProcess) -> None:
    line = parse("do b grab patience=25")
    assert isinstance(line, Do)
    orders = ken.database.orders(line.acts, ken.communication, ken.actor)
    assert [(order.title, order.patience) for order in orders] == [("b touch", 25.0), ("b grab", 25.0)]


def test_if_the_first_fails_the_rest_of_its_chain_is_left_out_and_others_go_on(ken: MainProcess) -> None:
    before = ken.blending.rotations.copy()
    ken.play(steps("do b bow frames 40 with b shake frames 10 then b wave frames 20"))
    assert ken.report.messages == ["b shake: ken does not hold it"]
    assert angle(ken, "right_upper_arm", before) < 1e-6
    np.testing.assert_allclose(angle(ken, "spine", before), 0.6, atol=0.02)


def test_what_accompanies_ends_with_the_others(ken: MainProcess) -> None:
    alone = frames_of(ken, "do b wave frames 40")
    assert frames_of(ken, "do b wave frames 40 with b hold") == alone
    assert frames_of(ken, "do b hold with b wave frames 40") == alone
    said = frames_of(ken, "do b wave frames 20 with b hold frames 40")
    assert alone <= said <= alone + 2


def test_what_follows_it_begins_when_it_has_ended(ken: MainProcess) -> None:
    alone = frames_of(ken, "do b wave frames 40")
    assert frames_of(ken, "do b bow frames 30 with b hold then b wave frames 10") == alone


def test_alone_it_is_over_at_once(ken: MainProcess) -> None:
    assert frames_of(ken, "do b hold") < 5
    assert ken.report.messages == []
