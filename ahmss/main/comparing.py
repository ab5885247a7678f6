"""A state that is waited for: which, how it is to compare, and whether it does."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError, CommandError
from ahmss.main.description import Scene
from ahmss.main.naming import find_object
from ahmss.states.state import State
from ahmss.world.schema import StateValue

__all__ = ["Comparison", "spoken"]

_OPERATORS: dict[str, Callable[[Any, Any], bool]] = {
    "==": operator.eq, "!=": operator.ne, "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge,
}  # fmt: skip
_ORDERS = ("<", "<=", ">", ">=")


class Comparison:
    """An object's state against a value; `holds` tells whether it is so now.

    Raises:
        CommandError: no such object, state or operator, or a value that the state never has; says what there is.
    """

    def __init__(
        self, workspace: Workspace, scene: Scene, name: str, state: str, operator: str, value: StateValue
    ) -> None:
        self.object = find_object(scene, name)
        self._scene, self._state, self._value = scene, state, value
        record = scene.objects[self.object]
        if state not in record.states:
            raise CommandError(f'{self.object} has no state "{state}"; it has: {", ".join(record.states) or "none"}')
        if operator not in _OPERATORS:
            raise CommandError(f'"{operator}" compares nothing; use one of: {" ".join(_OPERATORS)}')
        self._operator = operator
        try:
            known = workspace.objects.get(record.kind).states.get(state)
        except AhmssError:  # a kind that is not known here may have any values
            known = None
        if known is not None and not isinstance(value, bool):
            self._value = self._checked(known, value)
        elif operator in _ORDERS and isinstance(self.value, str) != isinstance(value, str):
            raise CommandError(f'{self.object} {state} is "{self.value}", neither less nor more than "{value}"')

    def _checked(self, state: State, value: str | float) -> str | float:
        """The value as the state has it: 0.4 for "0.4". Refuses to wait for what never comes."""
        said, operator = f"{self.object} {self._state}", self._operator
        if operator in _ORDERS and not state.is_number:
            raise CommandError(f'{said} is no number, so it is never {operator} "{value}"; use == or !=')
        parsed = state.parse(value)
        if parsed is None:
            always = not isinstance(value, str) and (
                value > state.high if operator in ("<", "<=") else value < state.low
            )
            if operator == "==" or (operator in _ORDERS and not always):
                what = f'"{value}"' if operator == "==" else f'{operator} "{value}"'
                raise CommandError(f"{said} is never {what}; allowed: {state.allowed}")
        elif (operator, parsed) in ((">", state.high), ("<", state.low)):
            raise CommandError(f'{said} is never {operator} "{value}"; allowed: {state.allowed}')
        return value if parsed is None else parsed

    @property
    def value(self) -> StateValue:
        """What the state is now; "" where the object is gone."""
        record = self._scene.objects.get(self.object)
        return "" if record is None else record.states.get(self._state, "")

    def missed(self, seconds: float) -> str:
        """What is told of it where it did not come to hold in so many seconds."""
        said = f"{self.object} {self._state} {self._operator} {self._value}"
        return f"{said} has not come in {seconds:g} s; it is {spoken(self.value)}"

    @property
    def holds(self) -> bool:
        """Whether it compares so; a word and a number only differ."""
        value = self.value
        if isinstance(value, str) != isinstance(self._value, str):
            return self._operator == "!="
        return _OPERATORS[self._operator](value, self._value)


def spoken(value: StateValue) -> str:
    """A value as a person is told it."""
    return f"{value:.3g}" if isinstance(value, float) else str(value)
