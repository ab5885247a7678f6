"""Completion at the console: what may follow, by the grammar and by what is there."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from ahmss.errors import AhmssError
from ahmss.main.catalogue import WorldCatalogue
from ahmss.main.command import OPERATORS, expected

__all__ = ["candidates"]

_LINES = ("do", "add", "remove", "set", "wait")
_NUMBERS = frozenset({"X", "Y", "Z", "N", "DEGREES", "SECONDS", "VALUE", "NAME", "CLIP", "KEY=VALUE", "HUMAN", "BODY"})


def candidates(text: str, catalogue: WorldCatalogue, words: Sequence[str]) -> list[str]:
    """All that may stand in the place of the last word of `text`; `words` answer the present question."""
    head = text[: text.rfind(" ") + 1]
    if not head.strip():
        return [*words, *_last_parts(words), *_LINES]
    wanted, before = expected(head)
    found: list[str] = []
    for what in wanted:
        found += _named(what, before, catalogue) if what.isupper() or what == "KEY=VALUE" else [what]
    return list(dict.fromkeys(found))


def _last_parts(names: Sequence[str]) -> list[str]:
    """`cup` for `room/cup`: the last parts that mean one name only."""
    parts = Counter(name.rsplit("/", 1)[-1] for name in names)
    return [part for name in names if "/" in name and parts[part := name.rsplit("/", 1)[-1]] == 1]


def _named(what: str, before: tuple[str, ...], catalogue: WorldCatalogue) -> Sequence[str]:
    """The names that a placeholder of the grammar stands for."""
    if what in _NUMBERS:
        return ()
    try:
        if what == "OBJECT":
            names = catalogue.objects().names
            return [*names, *_last_parts(names)]
        if what == "KIND":
            return catalogue.kinds().names
        if what == "ACTION":
            return catalogue.actions(before[-1]).names
        if what == "STATE":
            return catalogue.states(before[-1])
    except AhmssError:  # an unknown object has nothing to offer; the line itself will say so
        return ()
    return OPERATORS if what == "OP" else ()
