"""Who does not reach so far is told what to type; what is typed does help."""

from __future__ import annotations

import re

import numpy as np
import pytest
from msgspec import structs

from ahmss.algorithm import HumanTask
from ahmss.algorithm.messages import Goal, ObjectRecord
from ahmss.errors import AlgorithmError
from ahmss.reaching.goal import Goal as Reach
from ahmss.skills.nearer import gone_nearer
from ahmss.skills.out_of_reach import come_nearer, walk_there
from ahmss.skills.reaching import Looking

from .reached import TABLE, outlined
from .scene import CUP, FLOOR, Body, record
from .test_reach import FREE
from .test_walk import start, to


def task_of(body: Body, *names: str) -> HumanTask:
    world: list[ObjectRecord] = [record(name) for name in names]
    return HumanTask(body.start(CUP, "reach", **FREE, world=world))


@pytest.mark.parametrize(("x", "facing"), [(-2.0, 0.0), (-0.1, 170.0)])
def test_who_is_far_or_has_turned_away_is_told_to_walk_there(x: float, facing: float) -> None:
    assert come_nearer(task_of(Body(x=x, facing=facing), FLOOR)) == "`do floor walk to cup` first"


def test_who_stands_before_it_already_is_told_something_else() -> None:
    assert come_nearer(task_of(Body(), FLOOR)) == "stand elsewhere, or move it nearer"


def test_who_sits_is_told_to_stand_up() -> None:
    body = Body(x=2.075, y=0.2, facing=180.0)
    body.root = np.array([2.185, 0.2, 0.55])
    told = come_nearer(task_of(body, "room/chair"))
    assert told == "one must stand to come nearer; `do room/chair stand_up` first"


def test_a_name_is_as_long_as_it_has_to_be() -> None:
    task = task_of(Body(x=-2.0), FLOOR)
    assert walk_there(task, "that place") == "walk nearer first"
    other = structs.replace(record(CUP), id=99, name="other/cup")
    two = HumanTask(Body(x=-2.0).start(CUP, "reach", **FREE, world=[record(FLOOR), other]))
    assert walk_there(two, CUP) == "`do floor walk to room/cup` first"


def test_a_reach_that_is_refused_says_so() -> None:
    body = Body(x=-2.0)
    with pytest.raises(AlgorithmError, match=r"1\.\d\d m too short for that from here; `do floor walk to cup` first"):
        body.do("reach", body.start(CUP, "reach", **FREE, world=[record(FLOOR)]))


@pytest.mark.parametrize(
    ("stands", "place"),
    [
        ((-2.0, 0.0, 0.0), (-0.6, 0.3, 1.0)),
        ((0.9, 1.08, -105.0), (1.0, 0.93, 0.06)),  # at a table: back from it, and to a side
        pytest.param((0.94, 1.17, -112.0), (1.12, 0.74, 0.13), marks=pytest.mark.long),
    ],
)
def test_of_a_place_that_a_step_brings_into_reach_the_step_is_told_and_helps(
    stands: tuple[float, float, float], place: tuple[float, float, float]
) -> None:
    body, table = Body("ken", *stands), [outlined(record(TABLE), 11)]
    with pytest.raises(AlgorithmError, match="m too short for that from here") as refused:
        body.do("reach", body.start(FLOOR, "reach", goal=Goal(place=place), hand="", world=table))
    x, y, facing = re.findall(r"`do floor walk to (\S+) (\S+) facing (\S+)` first", str(refused.value))[0]
    there = Body("ken", float(x), float(y), float(facing))
    there.do("reach", there.start(FLOOR, "reach", goal=Goal(place=place), hand="", world=table))
    palms = there.grip(0).place, there.grip(1).place
    assert min(np.linalg.norm(palm - np.array(place)) for palm in palms) < 1e-3


def test_of_a_place_that_is_too_high_no_step_is_told() -> None:
    body = Body(x=-2.0, facing=0.0)
    with pytest.raises(AlgorithmError, match="no step from here brings one nearer; say another place"):
        body.do("reach", body.start(FLOOR, "reach", goal=Goal(place=(-1.6, 0.0, 2.8)), hand=""))


def test_who_sits_is_told_to_stand_up_before_it_is_thought_of_where_to_go() -> None:
    body = Body(x=2.075, y=0.2, facing=180.0)
    body.root = np.array([2.185, 0.2, 0.55])
    task, place = task_of(body, "room/chair"), np.array([0.6, 1.0, 0.88])
    task.library = HumanTask(start(body, to(0.0, 0.0))).library
    with pytest.raises(AlgorithmError, match="one must stand to walk; `do room/chair stand_up` first"):
        next(gone_nearer(task, place, lambda _: Reach(place), Looking(task, place), []))
