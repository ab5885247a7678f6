"""A state that is waited for: which, how it is to compare, and whether it does."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError, CommandError
from ahmss.main.database import Scene, find_object
from ahmss.world.schema import StateValue

__all__ = ["Comparison"]

_OPERATORS: dict[str, Callable[[Any, Any], bool]] = {
    "==": operator.eq, "!=": operator.ne, "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge,
}  # fmt: skip


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
        if operator == "==":
            self._check_value(workspace, record.kind)

    def _check_value(self, workspace: Workspace, kind: str) -> None:
        """Refuse to wait for what never comes."""
        try:
            state = workspace.objects.get(kind).states.get(self._state)
        except AhmssError:  # a kind that is not known here may have any values
            return
        if state is not None and not isinstance(self._value, bool) and state.parse(self._value) is None:
            raise CommandError(f'{self.object} {self._state} is never "{self._value}"; allowed: {state.allowed}')

    @property
    def value(self) -> StateValue:
        """What the state is now; "" where the object is gone."""
        record = self._scene.objects.get(self.object)
        return "" if record is None else record.states.get(self._state, "")

    def missed(self, seconds: float) -> str:
        """What is told of it where it did not come to hold in so many seconds."""
        said = f"{self.object} {self._state} {self._operator} {self._value}"
        now = self.value
        return f"{said} has not come in {seconds:g} s; it is {f'{now:.3g}' if isinstance(now, float) else now}"

    @property
    def holds(self) -> bool:
        """Whether it compares so; a word and a number only differ."""
        value = self.value
        if isinstance(value, str) != isinstance(self._value, str):
            return self._operator == "!="
        return _OPERATORS[self._operator](value, self._value)
