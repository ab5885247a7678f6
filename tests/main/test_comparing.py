"""A state that is waited for: what it never is, is refused in a sentence."""

from __future__ import annotations

from pathlib import Path

import pytest

from ahmss.database.workspace import Workspace
from ahmss.errors import CommandError
from ahmss.main.comparing import Comparison
from ahmss.world.schema import ObjectRecord, StateValue
from ahmss.world.view import World

WORKSPACE = Workspace(Path(__file__).resolve().parents[2])


def compared(state: str, operator: str, value: StateValue) -> Comparison:
    """A lever at 0.5 and a switch that is off, the state one of theirs."""
    world = World()
    kinds: dict[str, tuple[str, dict[str, StateValue]]] = {
        "lever_5": ("lever", {"level": 0.5}), "switch_1": ("rotary_switch", {"position": "off", "turn": 0.0}),
        "thing": ("of another workspace", {"heat": 3.0}),
    }  # fmt: skip
    for number, (name, (kind, states)) in enumerate(kinds.items()):
        world.objects[name] = ObjectRecord(number, name, kind, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), states=states)
    owner = next(name for name, (_, states) in kinds.items() if state in states)
    return Comparison(WORKSPACE, world, owner, state, operator, value)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("state", "operator", "value", "says"),
    [
        ("level", "<", "high", 'lever_5 level is never < "high"; allowed: 0 to 1'),
        ("level", "==", "high", 'lever_5 level is never "high"; allowed: 0 to 1'),
        ("level", ">", 1.0, 'lever_5 level is never > "1.0"; allowed: 0 to 1'),
        ("level", ">=", 1.5, 'lever_5 level is never >= "1.5"; allowed: 0 to 1'),
        ("level", "<", "0", 'lever_5 level is never < "0"; allowed: 0 to 1'),
        ("position", ">", "low", 'switch_1 position is no number, so it is never > "low"; use == or !='),
        ("heat", "<", "high", 'thing heat is "3.0", neither less nor more than "high"'),
    ],
)
def test_what_never_comes_is_refused(state: str, operator: str, value: StateValue, says: str) -> None:
    with pytest.raises(CommandError) as caught:
        compared(state, operator, value)
    assert str(caught.value) == says


@pytest.mark.parametrize(
    ("state", "operator", "value", "holds"),
    [
        ("level", ">", "0.4", True), ("level", ">", "0.6", False), ("level", "==", "0.5", True),
        ("level", "<=", 0.5, True), ("level", "<", 7.0, True), ("level", ">", -1.0, True), ("level", "!=", "top", True),
        ("position", "!=", "low", True), ("position", "==", "low", False), ("heat", ">", 2.0, True),
    ],
)  # fmt: skip
def test_a_number_may_be_told_as_text(state: str, operator: str, value: StateValue, holds: bool) -> None:
    assert compared(state, operator, value).holds is holds
