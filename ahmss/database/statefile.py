"""[states], [[appearances]] and [[consequences]] of an object.toml: what may change about an object, what shows of it
and what follows from it."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping, Sequence
from typing import Any

import msgspec
import numpy as np

from ahmss.database.document import Document, one_of
from ahmss.states.behaviour import Appearance, Consequence
from ahmss.states.condition import Condition, parse_condition
from ahmss.states.state import State

__all__ = ["HELD", "ONESELF", "affording", "read_appearances", "read_condition", "read_consequences", "read_states"]

HELD = "held"
"""What `when` of an action may ask beside the object's states: who has it in the hand."""

ONESELF = "oneself"
"""What it may ask as well: whether the object is the human who acts."""

_MOST_TEXT = 1000  # characters
_WAY = re.compile(r"(\.\.(/|$))*([A-Za-z][\w-]*(/[A-Za-z][\w-]*)*)?")
_KNOWN = {HELD: State("no", ("no", "here", "elsewhere")), ONESELF: State("no", ("no", "yes"))}
Vector = tuple[float, float, float]
Place = tuple[str | int, ...]


class StateEntry(msgspec.Struct, forbid_unknown_fields=True):
    """[states.NAME]."""

    initial: str | float | None = None
    values: list[str] = []
    range: tuple[float, float] | None = None
    text: int | None = None
    verb: str = ""


class AppearanceEntry(msgspec.Struct, forbid_unknown_fields=True):
    """[[appearances]]."""

    parts: list[str]
    when: str | None = None
    shown: bool | None = None
    color: tuple[int, int, int] | None = None
    lit: float | None = None
    move: Vector = (0.0, 0.0, 0.0)
    turn_deg: float = 0.0
    axis: Vector = (0.0, 0.0, 1.0)
    pivot: Vector = (0.0, 0.0, 0.0)
    by: str = ""


class ConsequenceEntry(msgspec.Struct, forbid_unknown_fields=True, rename={"source": "from"}):
    """[[consequences]]."""

    state: str
    at: str = ""
    of: str = ""
    when: str | None = None
    to: str | float | None = None
    source: str = ""


def affording(states: Mapping[str, State]) -> dict[str, State]:
    """What the `when` of an action may ask: the states, whether the object is held, and whether it is oneself."""
    return {**states, **_KNOWN}


def read_states(document: Document, entries: Mapping[str, dict[str, Any]]) -> dict[str, State]:
    """The states of a kind.

    Raises:
        DataError: names the key with its line, and what is allowed; as all of this file.
    """
    out: dict[str, State] = {}
    for name, raw in entries.items():
        place: Place = ("states", name)
        if name in _KNOWN:
            raise document.error(place, f'"{name}" is known of every object; choose another name')
        entry = document.convert(raw, StateEntry, place)
        if [bool(entry.values), entry.range is not None, entry.text is not None].count(True) != 1:
            raise document.error(place, 'a state has values = ["off", "on"], or range = [0.0, 1.0], or text = 80')
        if entry.text is not None and not 0 < entry.text <= _MOST_TEXT:
            raise document.error((*place, "text"), f"{entry.text}; allowed: 1 to {_MOST_TEXT} characters")
        low, high = entry.range or (0.0, 0.0)
        if low > high:
            raise document.error((*place, "range"), f"{low:g} is more than {high:g}; write the lower one first")
        first = entry.values[0] if entry.values else "" if entry.text else low
        state = State(first, tuple(entry.values), low, high, entry.text or 0, entry.verb)
        initial = state.parse(first if entry.initial is None else entry.initial)
        if initial is None:
            raise document.error((*place, "initial"), f"{entry.initial!r} is not among: {state.allowed}")
        out[name] = msgspec.structs.replace(state, initial=initial)
    return out


def read_condition(document: Document, text: str | None, states: Mapping[str, State], place: Place) -> Condition | None:
    """A `when`, whose states and values must be there."""
    condition = _parsed(document, text, place)
    for clause in () if condition is None else condition.clauses():
        state = states.get(clause.state)
        if state is None:
            have = ", ".join(name for name in states if name not in _KNOWN) or "none"
            raise document.error(place, f'no state "{clause.state}"; this object has: {have}')
        if state.is_number and isinstance(clause.value, str):
            raise document.error(place, f'"{clause.state}" is a number, never "{clause.value}"')
        if state.values and clause.value not in state.values:
            raise document.error(place, f'"{clause.state}" is never "{clause.value}"; allowed: {state.allowed}')
    return condition


def _parsed(document: Document, text: str | None, place: Place) -> Condition | None:
    """A `when`, of whichever states."""
    try:
        return None if text is None else parse_condition(text)
    except ValueError as error:
        raise document.error(place, str(error)) from None


def read_appearances(
    document: Document, entries: Sequence[dict[str, Any]], states: Mapping[str, State]
) -> tuple[Appearance, ...]:
    """How parts look by states; whether the shape has these parts is seen when it is read."""
    return tuple(_appearance(document, raw, states, ("appearances", i)) for i, raw in enumerate(entries))


def _appearance(document: Document, raw: dict[str, Any], states: Mapping[str, State], place: Place) -> Appearance:
    entry = document.convert(raw, AppearanceEntry, place)
    if not entry.parts:
        raise document.error((*place, "parts"), "names no part; give the layers of the shape that it is about")
    if entry.color and not all(0 <= c <= 255 for c in entry.color):
        raise document.error((*place, "color"), "is [red, green, blue], each 0 to 255")
    if entry.lit is not None and not 0.0 <= entry.lit <= 1.0:
        raise document.error((*place, "lit"), f"{entry.lit:g}; allowed: 0 (no light of its own) to 1")
    if entry.turn_deg and not np.linalg.norm(entry.axis) > 1e-9:
        raise document.error((*place, "axis"), "has no direction; give the axis [x, y, z] that it turns about")
    if entry.shown is None and entry.color is None and entry.lit is None and not entry.turn_deg and not any(entry.move):
        raise document.error(place, "changes nothing; give one of: shown, color, lit, move, turn_deg")
    _number(document, entry.by, states, (*place, "by"))
    return Appearance(
        tuple(entry.parts), read_condition(document, entry.when, states, (*place, "when")), entry.shown, entry.color,
        entry.lit, entry.move, math.radians(entry.turn_deg), entry.axis, entry.pivot, entry.by,
    )  # fmt: skip


def _number(document: Document, name: str, states: Mapping[str, State], place: Place) -> None:
    """Refuse what is no state with a range."""
    numbers = [state for state, what in states.items() if what.is_number]
    if name and name not in numbers:
        raise document.error(place, f'no state "{name}" that is a number{one_of(name, numbers)}')


def read_consequences(
    document: Document,
    entries: Sequence[dict[str, Any]],
    states: Mapping[str, State],
    contained: Collection[str] = (),
) -> tuple[Consequence, ...]:
    """What follows from a change of states: of its own, or of those of what it contains by these names."""
    return tuple(_consequence(document, raw, states, contained, ("consequences", i)) for i, raw in enumerate(entries))


def _consequence(
    document: Document, raw: dict[str, Any], states: Mapping[str, State], contained: Collection[str], place: Place
) -> Consequence:
    entry = document.convert(raw, ConsequenceEntry, place)
    if (entry.to is None) == (not entry.source):
        raise document.error(place, "says either what the state is set `to`, or the state that it is taken `from`")
    if entry.when is None and not entry.source:
        raise document.error(place, "never happens; say `when`")
    if not _WAY.fullmatch(entry.of):
        raise document.error((*place, "of"), f'"{entry.of}" is no way to an object; as: "..", "lamp", "../lamp"')
    if not entry.of:
        _own(document, entry, states, place)
    if entry.at:  # its states are another kind's
        first = entry.at.partition("/")[0]
        if first not in contained:
            raise document.error((*place, "at"), f'contains no "{first}"{one_of(first, contained)}')
        when = _parsed(document, entry.when, (*place, "when"))
        return Consequence(entry.state, entry.of, when, entry.to, entry.source, entry.at)
    if entry.source and entry.source not in states:
        raise document.error((*place, "from"), f'no state "{entry.source}"{one_of(entry.source, states)}')
    when = read_condition(document, entry.when, states, (*place, "when"))
    return Consequence(entry.state, entry.of, when, entry.to, entry.source)


def _own(document: Document, entry: ConsequenceEntry, states: Mapping[str, State], place: Place) -> None:
    """Check what it sets of the object itself; of others the server does, which has them."""
    state = states.get(entry.state)
    if state is None:
        raise document.error((*place, "state"), f'no state "{entry.state}"{one_of(entry.state, states)}')
    if entry.to not in (None, "toggle") and state.parse(entry.to) is None:
        raise document.error((*place, "to"), f"{entry.to!r} is not among: {state.allowed}")
