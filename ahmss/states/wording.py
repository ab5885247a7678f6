"""Conditions and states as a person says them: "its position is out", "aiko holds something"."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ahmss.states.condition import Clause, Condition

__all__ = ["Says", "lacking", "said", "so_now"]

Says = Callable[[str, str], str]
"""How a state and words for its value are said: "position", "not out" as "its position is not out"."""

_WORDS = {"==": "", "!=": "not ", "<": "under ", ">": "over ", "<=": "at most ", ">=": "at least "}


def lacking(when: Condition, now: Mapping[str, str | float]) -> list[list[Clause]]:
    """Of each alternative the clauses that do not hold."""
    return [[clause for clause in clauses if not clause.holds(now)] for clauses in when.alternatives]


def said(alternatives: list[list[Clause]], says: Says) -> str:
    """What is asked for, in words: "its page is over 0 and its cover is open, or its light is on"."""
    return ", or ".join(
        " and ".join(says(one.state, f"{_WORDS[one.operator]}{_value(one.value)}") for one in clauses)
        for clauses in alternatives
    )


def so_now(alternatives: list[list[Clause]], now: Mapping[str, str | float], says: Says) -> str:
    """What is so instead, in words; "" where no such state is known."""
    states = dict.fromkeys(one.state for clauses in alternatives for one in clauses)
    return ", ".join(says(state, _value(now[state])) for state in states if state in now)


def _value(value: str | float) -> str:
    return value if isinstance(value, str) else f"{value:.4g}"
