"""What an algorithm tells of its object's states: what they are as it is told, which may be long after it has begun."""

from __future__ import annotations

import re
from collections.abc import Mapping

__all__ = ["told"]

_STATE = re.compile(r"\{([A-Za-z][A-Za-z0-9_-]*)\}")


def told(text: str, states: Mapping[str, str | float]) -> str:
    """The text of a note, each `{state}` in it replaced by that state's value now; numbers to a hundredth.

    What names no state of the object stays as it is.
    """

    def value(match: re.Match[str]) -> str:
        now = states.get(match[1])
        if now is None:
            return match[0]
        return now if isinstance(now, str) else f"{now:.2f}"

    return _STATE.sub(value, text)
