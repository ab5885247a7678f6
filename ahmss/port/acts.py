"""An act as a Python program says it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ahmss.port.schema import Act

__all__ = ["act", "place_in"]


def place_in(text: str) -> tuple[float, ...]:
    """The two or three numbers of a text, as the dialogue takes them for a place: `0.2 -0.9`; () where it is a name."""
    try:
        found = tuple(float(word) for word in text.replace(",", " ").split())
    except ValueError:
        return ()
    return found if len(found) in (2, 3) else ()


def act(
    object: str | Sequence[float], action: str, *, to: str | Sequence[float] = (), facing_deg: float | None = None,  # noqa: A002
    hand: str = "", pose: str = "", frames: int | None = None, parameters: Mapping[str, str | float] | None = None,
    after: int = 0, follows: bool = False,
) -> Act:  # fmt: skip
    """One motion of a line, for `Client.together`; arguments as `Client.do` has them, and as `Act` says.

    A text of two or three numbers is a place, as in the dialogue.
    """
    at, goal = (place_in(said) if isinstance(said, str) else tuple(said) for said in (object, to))
    return Act(
        "" if at or not isinstance(object, str) else object,
        action,
        at,
        goal,
        "" if goal or not isinstance(to, str) else to,
        facing_deg,
        hand,
        pose,
        dict(parameters or {}),
        frames,
        after,
        follows,
    )
