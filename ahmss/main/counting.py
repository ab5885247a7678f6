"""How many there are of something, in words."""

from __future__ import annotations

__all__ = ["counted"]


def counted(number: int, what: str) -> str:
    """As one says it: `0 failures`, `1 failure`, `2 failures`."""
    return f"{number} {what}" if number == 1 else f"{number} {what}s"
