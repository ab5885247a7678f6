"""What can't be used from where one stands is used from elsewhere, before it is refused."""

from __future__ import annotations

from collections.abc import Generator, Sequence

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import HumanTask, Transform
from ahmss.algorithm.messages import ObjectRecord
from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.errors import AlgorithmError
from ahmss.motion.steps import Steps
from ahmss.reaching.plan import Reaching
from ahmss.skills import elsewhere
from ahmss.skills.come_to import come_to
from ahmss.skills.reaching import Looking
from ahmss.walking.goals import Goal

from .devices import at, device
from .layouts import Control, Layout, used
from .scene import WORKSPACE, Body

PLACED = [one for one in WORKSPACE.objects.place("panel", "panel") if one.kind != "panel"]
PANEL = Layout(
    tuple(
        Control(i, one.kind, Transform(np.array(one.position), np.array(one.rotation)))
        for i, one in enumerate(PLACED, 1)
    )
)
SWITCH = next(one for one, placed in zip(PANEL.controls, PLACED, strict=True) if placed.name == "panel/switch_3")
FROM, TO = {"position": "low", "turn": 0.7854}, {"along": 0.6, "position": "off"}
SOMEBODY = ObjectRecord(-9, "somebody", "human", (0.316, 0.094, 0.0), (1.0, 0.0, 0.0, 0.0))
"""They stand before the middle of the panel, so that nobody else stands straight before the switch."""


def test_a_switch_that_the_hand_can_not_turn_from_here_is_turned_from_elsewhere() -> None:
    """From here the arm is stretched out and brings the hand into its neighbours, whichever it is."""
    body = Body("ken", 0.4988, -0.4529, 177.325)
    start = PANEL.start(SWITCH, body, "turn", FROM, parameters=TO)
    begun = body.root.copy()
    done = used(body, msgspec.structs.replace(start, world=[*start.world, SOMEBODY]), "turn")
    went = done.shown[-1].root[:2]
    assert np.linalg.norm(went - begun[:2]) > 0.1
    assert np.linalg.norm(went - np.array(SOMEBODY.place[:2])) > 0.5
    assert done.nearest(PANEL.others(SWITCH)) > -0.002
    assert len(done.shown) < 1150  # of which who looked for ways that could not serve stood there for thousands


def worked_out(task: HumanTask, attempt: elsewhere.Attempt[float], apart: Sequence[elsewhere.Worth] = ()) -> float:
    """The flaw of what is made in the end; one goes elsewhere by all of it."""
    gaze = Looking(task, np.zeros(3))
    work = elsewhere.or_elsewhere(task, gaze, attempt, lambda _: 0.0, lambda flaw: flaw, lambda flaw: flaw, apart=apart)
    while True:
        try:
            next(work)
        except StopIteration as end:
            return end.value[2]


def test_where_it_comes_off_from_none_of_the_places_that_are_best_for_either_hand_those_are_tried_that_are_for_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Either hand would have been said to be in the way however it came, while one of them does it, asked alone."""
    task = HumanTask(PANEL.start(SWITCH, Body("ken", 0.4988, -0.4529, 177.325), "turn", FROM, parameters=TO))
    tried: list[tuple[float, float]] = []

    def left(reaching: Reaching) -> float:
        return -float(reaching.start.root[0])

    def right(reaching: Reaching) -> float:
        return float(reaching.start.root[0])

    def attempt(task: HumanTask, gaze: Looking, thought: float | None, most: float) -> Generator[Array, None, float]:
        yield np.zeros((1, 260))
        at = float(task.start.root[0]), float(task.start.root[1])
        tried.append(at)
        if len(tried) < 7:  # from where one stands, and from the five that are best for either
            raise AlgorithmError("something is in the way")
        return 0.0

    def went(task: HumanTask, stand: Goal, gaze: Looking) -> Generator[Array, None, tuple[HumanTask, Looking]]:
        yield np.zeros((1, 260))
        return come_to(task, stand), gaze

    monkeypatch.setattr(elsewhere, "gone_to", went)
    assert worked_out(task, attempt, [left, right]) == 0.0
    assert len(set(tried)) == 7  # nowhere twice, but where it came off
    assert tried[6][0] == min(at[0] for at in tried)
    assert "looks for a place from where a hand has room" not in task.notes  # it took a few frames
    tried.clear()
    with pytest.raises(AlgorithmError, match="something is in the way"):
        worked_out(task, attempt)


@pytest.mark.parametrize(("frames", "told"), [(59, []), (61, ["looks for a place from where a hand has room"])])
def test_who_looks_for_a_place_for_more_than_a_second_says_so(
    monkeypatch: pytest.MonkeyPatch, frames: int, told: list[str]
) -> None:
    task = HumanTask(PANEL.start(SWITCH, Body("ken", 0.4988, -0.4529, 177.325), "turn", FROM, parameters=TO))

    def thought(*given: object) -> Generator[Array, None, list[object]]:
        for _ in range(frames):
            yield np.zeros((1, 260))
        return []

    def attempt(task: HumanTask, gaze: Looking, thought: float | None, most: float) -> Generator[Array, None, float]:
        yield np.zeros((1, 260))
        raise AlgorithmError("something is in the way")

    monkeypatch.setattr(elsewhere, "_thought", thought)
    with pytest.raises(AlgorithmError, match="something is in the way"):
        worked_out(task, attempt)
    assert task.notes == told


@pytest.mark.parametrize(("here", "there", "goes", "most"), [(0.02, 0.001, [0], 0.025), (0.02, 0.019, [], 0.025)])
def test_who_does_it_ill_from_here_goes_where_it_is_done_better(
    monkeypatch: pytest.MonkeyPatch, here: float, there: float, goes: list[int], most: float
) -> None:
    """And stays where it is done hardly better elsewhere; what is plainly worse than from here is left early."""
    task = HumanTask(PANEL.start(SWITCH, Body("ken", 0.4988, -0.4529, 177.325), "turn", FROM, parameters=TO))
    gone: list[int] = []
    given: list[float] = []

    def stands(*_: object) -> Steps[list[Goal]]:
        yield
        return [Goal(np.zeros(2), 0.0)]

    def went(task: HumanTask, stand: Goal, gaze: Looking) -> Generator[Array, None, tuple[HumanTask, Looking]]:
        gone.append(int(stand.place[0]))
        yield np.zeros((1, 260))
        return task, gaze

    def attempt(task: HumanTask, gaze: Looking, thought: float | None, most: float) -> Generator[Array, None, float]:
        yield np.zeros((1, 260))
        given.append(most)
        return here if len(given) == 1 else there

    monkeypatch.setattr(elsewhere, "_stands", stands)
    monkeypatch.setattr(elsewhere, "gone_to", went)
    assert worked_out(task, attempt) == (there if goes else here)
    assert gone == goes
    assert given[0] == np.inf
    assert given[1] == pytest.approx(most)


@pytest.mark.parametrize("fails", [1, 2])
def test_who_comes_there_and_can_not_do_it_thinks_once_more_from_there(
    monkeypatch: pytest.MonkeyPatch, fails: int
) -> None:
    """And is told at last why not from there: it was said how far it had been from where they set out."""
    task = HumanTask(PANEL.start(SWITCH, Body("ken", 0.4988, -0.4529, 177.325), "turn", FROM, parameters=TO))
    really, at = task, [0]

    def stands(*_: object) -> Steps[list[Goal]]:
        yield
        return [Goal(np.zeros(2), 0.0)]

    def went(task: HumanTask, stand: Goal, gaze: Looking) -> Generator[Array, None, tuple[HumanTask, Looking]]:
        at[0] += 1
        yield np.zeros((1, 260))
        return task, gaze

    def attempt(task: HumanTask, gaze: Looking, thought: float | None, most: float) -> Generator[Array, None, float]:
        yield np.zeros((1, 260))
        if task is really and at[0] <= fails:
            raise AlgorithmError(f"not from {at[0]}")
        return 0.0

    monkeypatch.setattr(elsewhere, "_stands", stands)
    monkeypatch.setattr(elsewhere, "gone_to", went)
    if fails == 1:
        assert worked_out(task, attempt) == 0.0
        assert at[0] == 2
    else:
        with pytest.raises(AlgorithmError, match="not from 2"):
            worked_out(task, attempt)


@pytest.mark.parametrize(
    ("flaws", "goes", "thought_of"),
    [([0.017, 0.052, 0.011], 2, 3), ([None, 0.017, 0.003, 0.0], 2, 3), ([0.0, 0.0], 0, 1)],
)
def test_of_the_places_from_where_it_comes_off_the_one_with_the_least_flaw_is_gone_to(
    monkeypatch: pytest.MonkeyPatch, flaws: list[float | None], goes: int, thought_of: int
) -> None:
    """And what was thought of there is what is made there; where next to nothing is amiss no other is looked for."""
    task = HumanTask(PANEL.start(SWITCH, Body("ken", 0.4988, -0.4529, 177.325), "turn", FROM, parameters=TO))
    places = [Goal(np.array([float(i), 0.0]), 0.0) for i in range(len(flaws))]
    gone: list[int] = []
    tried: list[tuple[float, float | None]] = []

    def stands(*_: object) -> Steps[list[Goal]]:
        yield
        return places

    def went(task: HumanTask, stand: Goal, gaze: Looking) -> Generator[Array, None, tuple[HumanTask, Looking]]:
        gone.append(int(stand.place[0]))
        yield np.zeros((1, 260))
        return task, gaze

    def attempt(task: HumanTask, gaze: Looking, thought: float | None, most: float) -> Generator[Array, None, float]:
        yield np.zeros((1, 260))
        tried.append((float(task.start.root[0]), thought))
        if thought is not None:
            return thought
        flaw = None if len(tried) == 1 else flaws[len(tried) - 2]  # first from here
        if flaw is None:
            raise AlgorithmError("it does not come off")
        return flaw

    monkeypatch.setattr(elsewhere, "_stands", stands)
    monkeypatch.setattr(elsewhere, "gone_to", went)
    worked = worked_out(task, attempt)
    assert gone == [goes]
    assert worked == flaws[goes]
    assert tried[-1][1] == flaws[goes]
    assert len(tried) == thought_of + 2


def test_who_thinks_of_a_stand_has_the_arms_as_who_comes_there() -> None:
    """Hanging, or drawn in beside a thing; else another elbow comes to it there, and one goes from place to place."""
    body, stand = Body("ken", 0.5, -0.45, 177.3), Goal(np.array([3.0, 0.0]), 0.0)
    ring, size = [(-0.2, -0.7), (0.2, -0.7), (0.2, 0.7), (-0.2, 0.7)], {"size": [0.4, 1.4, 1.0]}
    counter = msgspec.structs.replace(device("desk", at(3.46, 0.0, 0.0)), id=21, footprint=[ring], properties=size)
    for world, low, high in (([], 0.7, 0.85), ([counter], 0.95, 1.2)):
        start = msgspec.structs.replace(PANEL.start(SWITCH, body, "turn", FROM, parameters=TO), world=world)
        there = come_to(HumanTask(start), stand)
        palms = grips(body.skeleton, there.start.rotations, there.start.root)
        assert low < palms[0, 2] < high
        assert np.linalg.norm(there.start.root[:2] - stand.place) < 0.05
