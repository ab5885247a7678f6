"""What was probably meant: the nearest of some names, and how what was typed is said as a line."""

from __future__ import annotations

import difflib
import itertools
from collections.abc import Iterable, Sequence
from typing import Protocol

from ahmss.errors import AhmssError

__all__ = ["Offers", "as_a_line", "nearest", "some"]

_MOST = 12  # names that a sentence lists
_IN_WORDS = 2  # names that differ by their number only, and are listed all the same
_LOOKED_AT = 200  # objects whose actions are looked at
_GOALS = ("grasp", "reach", "press")  # whoever affords one of these is what one walks to, for an example


class Offers(Protocol):
    """The objects in the world, what they afford now, and what that asks for."""

    def objects(self) -> Named:
        """The objects."""
        ...

    def actions(self, name: str) -> Named:
        """What one of them affords."""
        ...

    def asks(self, name: str, action: str) -> tuple[Sequence[str], int]:
        """What an action asks for, and its frames."""
        ...


class Named(Protocol):
    """Something that has names."""

    @property
    def names(self) -> tuple[str, ...]:
        """The names."""
        ...


def nearest(text: str, names: Iterable[str]) -> str:
    """The name that is most like a text, by all of it or by its last part; "" where none is."""
    last = [name.rpartition("/")[2] for name in names]
    near = difflib.get_close_matches(text.rpartition("/")[2], last, 1)
    return near[0] if near else ""


def some(names: Iterable[str]) -> str:
    """Names as a sentence lists them: all, or the first and how many more there are.

    Of more than two that are numbered, in a row, the first and the last stand for all: `panel/lever_1 to _10`.
    """
    every = [_row(list(row)) for _, row in itertools.groupby(names, _stem)]
    more = f" and {len(every) - _MOST} more" if len(every) > _MOST else ""
    return (", ".join(every[:_MOST]) or "none") + more


def _stem(name: str) -> str:
    """A name without the number at its end, if it has one after an underscore."""
    stem, _, number = name.rpartition("_")
    return f"{stem}_" if number.isdecimal() else name


def _row(names: Sequence[str]) -> str:
    """Names of one stem, in words."""
    return f"{names[0]} to _{names[-1].rpartition('_')[2]}" if len(names) > _IN_WORDS else ", ".join(names)


def as_a_line(text: str, offers: Offers) -> str:
    """How an action that was typed without its object, or without `do`, is said: a line that can be typed; or ""."""
    words = text.split()
    afforded = _afforded(offers)
    for name in words:
        own = [full for full in afforded if full == name or full.endswith(f"/{name}")]
        action = next((word for word in words if own and word in afforded[own[0]]), "")
        if action:
            return f"do {name} {action}{_goal(offers, afforded, own[0], action)}"
    for word in words[:1]:
        found = next((full for full, actions in afforded.items() if word in actions), "")
        if found:
            return f"do {found.rpartition('/')[2]} {word}{_goal(offers, afforded, found, word)}"
    return ""


def _afforded(offers: Offers) -> dict[str, tuple[str, ...]]:
    """The actions of the objects; a broken file hides its own kind only."""
    found: dict[str, tuple[str, ...]] = {}
    for name in offers.objects().names[:_LOOKED_AT]:
        try:
            found[name] = offers.actions(name).names
        except AhmssError:
            continue
    return found


def _goal(offers: Offers, afforded: dict[str, tuple[str, ...]], name: str, action: str) -> str:
    """What an action asks for, as an example of a line has it."""
    asks, _ = offers.asks(name, action)
    if "goal_position" in asks:
        others = [other for other in afforded if other != name and not name.startswith(f"{other}/")]
        best = [other for other in others if any(one in afforded[other] for one in _GOALS)] or others
        return f" to {best[0].rpartition('/')[2]}" if best else " to 1 0"
    return " facing 90" if "facing" in asks else ""
