"""Typed parameters of an algorithm: what algorithm.toml declares, object.toml gives and a person types."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import msgspec

from ahmss.states.state import State

__all__ = ["Parameter", "fill", "within"]

TYPES = ("float", "int", "bool", "str", "floats")


class Parameter(msgspec.Struct, frozen=True):
    """One parameter: its type (float, int, bool, str, floats), default and range; no default: it must be given.

    bounds: the name of the parameter that names the object's state in whose range this one is to be, where the object
    has such a state; its default, which is no place in it, may be outside, and is not to be typed.
    """

    type: str
    default: Any = None
    minimum: float | None = None
    maximum: float | None = None
    unit: str = ""
    sentence: str = ""
    bounds: str = ""

    def convert(self, value: Any) -> Any:
        """A value out of TOML, or typed as text, as this parameter takes it.

        Raises:
            ValueError: it has another type or is out of range; the message says what is allowed.
        """
        out = self._typed(value)
        if self.bounds and out == self.default:
            return out
        for number in out if isinstance(out, list) else [out]:
            low = self.minimum is not None and number < self.minimum
            if low or (self.maximum is not None and number > self.maximum):
                raise ValueError(f"{number:g} is out of range; allowed: {self._range()}")
        return out

    def _typed(self, value: Any) -> Any:
        if self.type == "str":
            if isinstance(value, str):
                return value
            if isinstance(value, int | float) and not isinstance(value, bool):
                return f"{value:g}"  # a word of digits
        elif self.type == "bool":
            if isinstance(value, bool) or value in ("true", "false"):
                return value in (True, "true")
        elif self.type == "floats":
            items = value.split(",") if isinstance(value, str) else value
            if isinstance(items, list):
                return [self._number(item) for item in items]  # pyright: ignore[reportUnknownVariableType]
        else:
            number = self._number(value)
            if self.type == "float" or number == int(number):
                return number if self.type == "float" else int(number)
        raise ValueError(f"{value!r} is no {self.type}")

    def _number(self, value: Any) -> float:
        try:
            number = float("nan") if isinstance(value, bool) else float(value)
        except (TypeError, ValueError):
            number = float("nan")
        if number - number != 0.0:
            bounded = self.minimum is not None or self.maximum is not None
            raise ValueError(f"{value!r} is no finite number" + (f"; allowed: {self._range()}" if bounded else ""))
        return number

    def _range(self) -> str:
        low = "any" if self.minimum is None else f"{self.minimum:g}"
        high = "any" if self.maximum is None else f"{self.maximum:g}"
        return f"{low} to {high}" + (f" {self.unit}" if self.unit else "")


def within(
    declared: Mapping[str, Parameter], given: Mapping[str, Any], states: Mapping[str, State]
) -> dict[str, Parameter]:
    """Parameters as they are for an object with these states: bounded by a state's range where they say so."""
    out = dict(declared)
    for name, parameter in declared.items():
        if parameter.bounds in declared:
            state = states.get(str(given.get(parameter.bounds, declared[parameter.bounds].default)))
            if state is not None and state.is_number:
                out[name] = msgspec.structs.replace(parameter, minimum=state.low, maximum=state.high, bounds="")
    return out


def fill(
    declared: Mapping[str, Parameter] | None, given: Mapping[str, Any], states: Mapping[str, State] | None = None
) -> dict[str, Any]:
    """The values that an algorithm gets: those given that it declares, converted, and its defaults for the rest.

    states: of the object, whose ranges bound some.

    Raises:
        ValueError: one has the wrong type, or one without a default is missing; the message starts with its name.
    """
    if declared is None:
        return dict(given)
    out: dict[str, Any] = {}
    for name, parameter in within(declared, given, states or {}).items():
        if name in given:
            try:
                out[name] = parameter.convert(given[name])
            except ValueError as error:
                raise ValueError(f"{name}: {error}") from None
        elif parameter.default is not None:
            out[name] = parameter.default
        else:
            raise ValueError(f"{name}: missing; it is {parameter.type} without a default")
    return out
