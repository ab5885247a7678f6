"""One state of a kind of object: the values that it may have."""

from __future__ import annotations

import msgspec

__all__ = ["State"]


class State(msgspec.Struct, frozen=True, omit_defaults=True):
    """What may be true of an object: one of `values`, any text of at most `text` characters, or a number from `low` to
    `high`.

    verb: what is said before a value with the object's name, as in "aiko holds something"; "": "its position is".
    """

    initial: str | float
    values: tuple[str, ...] = ()
    low: float = 0.0
    high: float = 0.0
    text: int = 0
    verb: str = ""

    @property
    def is_number(self) -> bool:
        """Whether it is a number within a range."""
        return not self.values and not self.text

    def parse(self, value: str | float) -> str | float | None:
        """A value as this state takes it, or None where it can't be one."""
        if self.values:
            return str(value) if str(value) in self.values else None
        if self.text:
            words = value if isinstance(value, str) else f"{value:.15g}"
            return words if len(words) <= self.text else None
        try:
            number = float(value)
        except ValueError:
            return None
        return number if self.low <= number <= self.high else None

    def share(self, value: object) -> float:
        """How far up its range a number is, 0 to 1; 0 for what is no number."""
        if isinstance(value, bool) or not isinstance(value, int | float) or self.high <= self.low:
            return 0.0
        return min(1.0, max(0.0, (value - self.low) / (self.high - self.low)))

    def other(self, value: object) -> str | float:
        """The next of its values, after the last the first; of a range the end that is farther away; of text none."""
        if self.text:
            return ""
        if not self.values:
            return self.low if self.share(value) > 0.5 else self.high
        at = self.values.index(value) if value in self.values else -1
        return self.values[(at + 1) % len(self.values)]

    @property
    def allowed(self) -> str:
        """`off, on`, `0 to 1.57` or `text of at most 80 characters`, for a message."""
        if self.text:
            return f"text of at most {self.text} characters"
        return ", ".join(self.values) if self.values else f"{self.low:g} to {self.high:g}"
