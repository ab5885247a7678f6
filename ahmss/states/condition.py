"""`when = "lamp == on and cover != shut"`: under which states an action is afforded."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Mapping
from typing import Any

import msgspec

__all__ = ["Clause", "Condition", "parse_condition"]

_OPERATORS: dict[str, Callable[[Any, Any], bool]] = {
    "==": operator.eq,
    "!=": operator.ne,
    "<=": operator.le,
    ">=": operator.ge,
    "<": operator.lt,
    ">": operator.gt,
}
_CLAUSE = re.compile(r'\s*([\w-]+)\s*(==|!=|<=|>=|<|>)\s*("[^"]*"|[\w.+-]+)\s*')


class Clause(msgspec.Struct, frozen=True):
    """One comparison of a state with a value."""

    state: str
    operator: str
    value: str | float

    def holds(self, states: Mapping[str, str | float]) -> bool:
        """Whether it is true; false where there is no such state, or text meets a number in an order."""
        value = states.get(self.state)
        if value is None:
            return False
        if isinstance(value, str) != isinstance(self.value, str):
            return self.operator == "!="
        return _OPERATORS[self.operator](value, self.value)


class Condition(msgspec.Struct, frozen=True):
    """Clauses joined by `and` within `or`: true where all clauses of any alternative are."""

    text: str
    alternatives: tuple[tuple[Clause, ...], ...]

    def holds(self, states: Mapping[str, str | float]) -> bool:
        """Whether the condition is true in these states."""
        return any(all(clause.holds(states) for clause in clauses) for clauses in self.alternatives)

    def clauses(self) -> list[Clause]:
        """All clauses, in the order of the text."""
        return [clause for clauses in self.alternatives for clause in clauses]


def parse_condition(text: str) -> Condition:
    """The condition that `text` says.

    Raises:
        ValueError: it is not one; the message says how one looks.
    """
    alternatives: list[tuple[Clause, ...]] = []
    for alternative in re.split(r"\bor\b", text):
        clauses: list[Clause] = []
        for part in re.split(r"\band\b", alternative):
            match = _CLAUSE.fullmatch(part)
            if not match:
                raise ValueError(f'"{part.strip()}" is no condition; write STATE == VALUE (or != < <= > >=), and, or')
            clauses.append(Clause(match[1], match[2], _value(match[3])))
        alternatives.append(tuple(clauses))
    return Condition(text, tuple(alternatives))


def _value(text: str) -> str | float:
    try:
        return float(text)
    except ValueError:
        return text.strip('"')
