"""What follows from a change of states."""

from __future__ import annotations

import pytest

from ahmss.errors import WorldError
from ahmss.states.behaviour import Behaviour, Consequence
from ahmss.states.condition import parse_condition
from ahmss.states.following import Change, follow
from ahmss.states.state import State

SWITCH = State("off", ("off", "on"))
POSITION = State("out", ("out", "in"))
BUTTON = Behaviour(
    {"position": POSITION},
    consequences=(
        Consequence("power", "..", parse_condition("position == in"), "toggle"),
        Consequence("light", "../lamp", parse_condition("position == in"), "on"),
    ),
)


def world(**objects: tuple[Behaviour, dict[str, str | float | bool]]):
    """`follow` in a world of these objects; `__` stands for `/`."""
    known = {name.replace("__", "/"): what for name, what in objects.items()}

    def run(*changes: Change) -> list[Change]:
        return follow(
            changes,
            lambda name: known[name][1] if name in known else None,
            lambda name: known[name][0],
        )

    return run


def test_a_button_sets_what_contains_it_and_what_is_beside_it() -> None:
    run = world(
        tv=(Behaviour({"power": SWITCH}), {"power": "on"}),
        tv__button=(BUTTON, {"position": "out"}),
        tv__lamp=(Behaviour({"light": SWITCH}), {"light": "off"}),
    )
    assert run(("tv/button", "position", "in")) == [
        ("tv/button", "position", "in"), ("tv", "power", "off"), ("tv/lamp", "light", "on"),
    ]  # fmt: skip
    assert run(("tv/button", "position", "out")) == [("tv/button", "position", "out")]


def test_only_what_comes_true_has_consequences() -> None:
    run = world(tv=(Behaviour({"power": SWITCH}), {"power": "on"}), tv__button=(BUTTON, {"position": "in"}))
    assert run(("tv/button", "position", "in")) == [("tv/button", "position", "in")]


def test_a_button_that_stands_alone_sets_nothing() -> None:
    run = world(button=(BUTTON, {"position": "out"}))
    assert run(("button", "position", "in")) == [("button", "position", "in")]


def test_a_consequence_has_consequences_and_a_circle_ends() -> None:
    ring = Behaviour(
        {"a": SWITCH, "b": SWITCH},
        consequences=(
            Consequence("b", "", parse_condition("a == on"), "on"),
            Consequence("a", "", parse_condition("b == on"), "off"),
        ),
    )
    run = world(ring=(ring, {"a": "off", "b": "off"}))
    assert run(("ring", "a", "on")) == [("ring", "a", "on"), ("ring", "b", "on")]


def test_what_was_asked_for_stands() -> None:
    tap = Behaviour(
        {"turn": State(0.0, (), 0.0, 2.0), "flow": SWITCH},
        consequences=(Consequence("turn", "", parse_condition("flow == on"), 2.0),),
    )
    run = world(tap=(tap, {"turn": 0.0, "flow": "off"}))
    assert run(("tap", "flow", "on")) == [("tap", "flow", "on"), ("tap", "turn", 2.0)]
    asked = [("tap", "flow", "on"), ("tap", "turn", 1.0)]
    assert run(*asked) == asked


@pytest.mark.parametrize(("lever", "gauge"), [(-1.0, 10.0), (0.0, 20.0), (1.0, 30.0)])
def test_a_number_is_taken_over_from_range_to_range(lever: float, gauge: float) -> None:
    behaviour = Behaviour(
        {"angle": State(-1.0, (), -1.0, 1.0)}, consequences=(Consequence("value", "../gauge", source="angle"),)
    )
    run = world(
        panel__lever=(behaviour, {"angle": 0.5}),
        panel__gauge=(Behaviour({"value": State(10.0, (), 10.0, 30.0)}), {"value": 25.0}),
    )
    assert run(("panel/lever", "angle", lever))[1:] == [("panel/gauge", "value", gauge)]


def test_a_value_that_can_not_be_is_refused_with_what_is_allowed() -> None:
    wrong = Behaviour(
        {"position": POSITION}, consequences=(Consequence("power", "..", parse_condition("position == in"), "purple"),)
    )
    run = world(tv=(Behaviour({"power": SWITCH}), {"power": "on"}), tv__b=(wrong, {"position": "out"}))
    with pytest.raises(WorldError, match='tv/b sets tv power to "purple", which it can\'t be; allowed: off, on'):
        run(("tv/b", "position", "in"))


def test_the_next_value_after_the_last_is_the_first() -> None:
    state = State("a", ("a", "b", "c"))
    assert [state.other(value) for value in "abc"] == ["b", "c", "a"]
    assert [State(0.0, (), 0.0, 4.0).other(value) for value in (0.5, 3.0)] == [4.0, 0.0]


def test_what_contains_it_says_what_a_button_does() -> None:
    panel = Behaviour(
        consequences=(
            Consequence("running", "pump", parse_condition("position == in"), "on", at="desk/start"),
            Consequence("running", "pump", parse_condition("position == in"), "off", at="desk/stop"),
            Consequence("level", "gauge", source="angle", at="lever"),
        )
    )
    button = Behaviour({"position": POSITION})
    run = world(
        panel=(panel, {}),
        panel__desk=(Behaviour(), {}),
        panel__desk__start=(button, {"position": "out"}),
        panel__desk__stop=(button, {"position": "out"}),
        panel__pump=(Behaviour({"running": SWITCH}), {"running": "off"}),
        panel__lever=(Behaviour({"angle": State(0.0, low=0.0, high=2.0)}), {"angle": 0.0}),
        panel__gauge=(Behaviour({"level": State(0.0, low=0.0, high=10.0)}), {"level": 0.0}),
    )
    start, stop = ("panel/desk/start", "position", "in"), ("panel/desk/stop", "position", "in")
    assert run(start) == [start, ("panel/pump", "running", "on")]
    assert run(stop) == [stop, ("panel/pump", "running", "off")]
    assert run(("panel/desk/start", "position", "out")) == [("panel/desk/start", "position", "out")]
    assert run(("panel/lever", "angle", 0.5)) == [("panel/lever", "angle", 0.5), ("panel/gauge", "level", 2.5)]
