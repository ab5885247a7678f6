"""Words of a command line, each with the column where it stands."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ahmss.errors import CommandError

__all__ = ["Word", "split"]

_WORD = re.compile(
    r"""\s*(?:
        (?P<comment>\#.*)
      | "(?P<double>[^"]*)"
      | '(?P<single>[^']*)'
      | (?P<sign>==|!=|<=|>=|[=<>:])
      | (?P<plain>[^\s:=<>!"']+)
      | (?P<wrong>\S)
    )""",
    re.VERBOSE,
)


@dataclass(frozen=True, slots=True)
class Word:
    """One word: its text, the column (1 is the first) and whether it stood in quotes, where no word is a keyword."""

    text: str
    column: int
    quoted: bool = False


def split(text: str) -> tuple[Word, ...]:
    """The words of one line, without its comment.

    Raises:
        CommandError: a quote that is not closed or a character that no word has; begins with `column N: `.
    """
    words: list[Word] = []
    for match in _WORD.finditer(text.rstrip()):
        kind = str(match.lastgroup)
        if kind == "comment":
            break
        quoted = kind in ("double", "single")
        column = match.start(kind) + (0 if quoted else 1)
        if kind == "wrong":
            sign = match.group("wrong")
            reason = "this quote is not closed" if sign in "\"'" else f"no word has a {sign!r}; put it in quotes"
            raise CommandError(f"column {column}: {reason}")
        words.append(Word(match.group(kind), column, quoted))
    return tuple(words)
