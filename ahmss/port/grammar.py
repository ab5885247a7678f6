"""Acts as the line that a person would type: what a human model sends is read by the same grammar as the dialogue's."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

from ahmss.errors import CommandError
from ahmss.port.schema import Act

__all__ = ["line_of"]

_PLAIN = re.compile(r"[^\s:=<>!\"'#]+")
_KEYWORDS = frozenset({"do", "with", "then", "to", "at", "facing", "hand", "pose", "frames", "after"})


def line_of(acts: Sequence[Act]) -> str:
    """The `do` line of these acts.

    Raises:
        CommandError: there is none, or a name holds both kinds of quotes.
    """
    if not acts:
        raise CommandError("nothing to do: name an object and an action, as in: do door open")
    words = ["do"]
    for index, act in enumerate(acts):
        if index:
            words.append("then" if act.follows else "with")
        words += _words(act)
    return " ".join(words)


def _words(act: Act) -> list[str]:
    words = ["at", *_numbers(act.at)] if act.at and not act.object else [_name(act.object)]
    words.append(_name(act.action))
    if act.to:
        words += ["to", *_numbers(act.to)]
    elif act.to_object:
        words += ["to", _name(act.to_object)]
    if act.facing_deg is not None:
        words += ["facing", f"{act.facing_deg:.9g}"]
    for keyword, text in (("hand", act.hand), ("pose", act.pose)):
        if text:
            words += [keyword, _plain(text) if keyword == "hand" else _name(text)]
    for key, value in act.parameters.items():
        words.append(f"{_name(key)}={_name(value) if isinstance(value, str) else f'{value:.9g}'}")
    if act.frames is not None:
        words += ["frames", str(act.frames)]
    if act.after:
        words += ["after", str(act.after)]
    return words


def _numbers(place: Sequence[float]) -> list[str]:
    if not all(math.isfinite(value) for value in place):
        raise CommandError(f"{' '.join(map(str, place))} is no place: give x y or x y z, finite numbers in metres")
    return [f"{value:.9g}" for value in place]


def _name(text: str) -> str:
    """A name as one word: in quotes where it would be read as something else."""
    if _PLAIN.fullmatch(text) and text not in _KEYWORDS and not _is_number(text):
        return text
    return _quoted(text)


def _plain(text: str) -> str:
    """A keyword; what is none stays a word, which the grammar then names."""
    return text if _PLAIN.fullmatch(text) else _quoted(text)


def _quoted(text: str) -> str:
    if '"' not in text:
        return f'"{text}"'
    if "'" not in text:
        return f"'{text}'"
    raise CommandError(f"{text!r} is no name: it holds both kinds of quotes")


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
