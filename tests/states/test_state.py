"""A state takes the values that its kind says, and no others."""

from __future__ import annotations

from ahmss.states.state import State


def test_text_is_kept_as_it_is_up_to_its_length() -> None:
    state = State("", text=5)
    assert state.parse("START") == "START"
    assert state.parse("START!") is None
    assert state.parse(12.0) == "12"
    assert state.allowed == "text of at most 5 characters"


def test_text_is_no_number() -> None:
    state = State("", text=5)
    assert not state.is_number
    assert state.share("START") == 0.0
    assert state.other("START") == ""


def test_numbers_and_values_are_told_apart() -> None:
    assert State(0.0, low=0.0, high=2.0).is_number
    assert not State("off", ("off", "on")).is_number
    assert State(0.0, low=0.0, high=2.0).share(0.5) == 0.25
    assert State("off", ("off", "on")).other("on") == "off"
