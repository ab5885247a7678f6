"""A text file of motion read line by line, so that what is wrong is named with its line."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from ahmss.errors import DataError

__all__ = ["LARGEST", "Lines"]

LARGEST = 1e7
"""No place or angle in a file of motion is larger, whatever its unit."""


_MOST_BYTES = 1_000_000_000


@dataclass
class Lines:
    """The lines of a file that hold something, as words; those that begin with # do not, braces stand alone.

    number: of the line read last, from 1.
    """

    path: Path
    rows: Iterator[tuple[int, list[str]]]
    number: int = 0
    ahead: list[tuple[int, list[str]]] = field(default_factory=list[tuple[int, list[str]]])

    @classmethod
    def of(cls, path: Path) -> Lines:
        """The lines of a file.

        Raises:
            DataError: it can't be read.
        """
        try:
            if path.stat().st_size > _MOST_BYTES:
                raise DataError(path, "", f"larger than {_MOST_BYTES} bytes")
            text = path.read_text(encoding="utf-8-sig", errors="replace")
        except OSError as error:
            raise DataError(path, "", f"can't be read ({error.strerror})") from error
        return cls(path, _split(text))

    def peek(self) -> list[str] | None:
        """The words of the next line, which stays the next; None at the end."""
        if not self.ahead:
            self.ahead = [row for row in [next(self.rows, None)] if row is not None]
        return self.ahead[0][1] if self.ahead else None

    def next(self, wanted: str) -> list[str]:
        """The words of the next line.

        Raises:
            DataError: the file ends; says what was wanted.
        """
        if self.peek() is None:
            raise self.error(f"the file ends where {wanted} should stand; is it cut short?")
        self.number, words = self.ahead.pop()
        return words

    def value(self, word: str) -> float:
        """The number that a word is.

        Raises:
            DataError: it is none, not finite, or larger than any place or angle.
        """
        try:
            value = float(word)
        except ValueError:
            raise self.error(f'"{word[:20]}" is not a number') from None
        if not math.isfinite(value):
            raise self.error(f'"{word[:20]}" is not a finite number')
        if abs(value) > LARGEST:
            raise self.error(f'"{word[:20]}" is larger than any place or angle')
        return value

    def error(self, message: str) -> DataError:
        """The error at the line read last."""
        return DataError(self.path, f"line {self.number}", message)


def _split(text: str) -> Iterator[tuple[int, list[str]]]:
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.replace("{", " { ").replace("}", " } ").split()
        if words and not words[0].startswith("#"):
            yield number, words
