"""Lines of a script at which humans wait for each other."""

from __future__ import annotations

from dataclasses import dataclass, field

__all__ = ["Meetings"]

_MOST_LEFT = 10_000


@dataclass
class _Meeting:
    names: frozenset[str]
    here: dict[str, tuple[bytes, int]] = field(default_factory=dict[str, tuple[bytes, int]])


class Meetings:
    """All lines at which somebody waits. A human that has left its group is waited for no more."""

    def __init__(self) -> None:
        self._open: dict[tuple[str, str], _Meeting] = {}
        self._left: dict[tuple[str, str], None] = {}

    def join(self, group: str, name: str) -> None:
        """A human is in the world, or again."""
        self._left.pop((group, name), None)

    def leave(self, group: str, name: str) -> None:
        """A human has left."""
        self._left[group, name] = None
        if len(self._left) > _MOST_LEFT:
            del self._left[next(iter(self._left))]

    def come(self, group: str, line: str, name: str, names: list[str], whom: tuple[bytes, int]) -> None:
        """A human has come to a line; `whom` (client, request number) is told when all have."""
        meeting = self._open.setdefault((group, line), _Meeting(frozenset(names)))
        meeting.here[name] = whom

    def complete(self) -> list[tuple[bytes, int]]:
        """Whom to tell that all have come, in the order of names; they are waited for no more."""
        told: list[tuple[bytes, int]] = []
        for (group, line), meeting in list(self._open.items()):
            if all(name in meeting.here or (group, name) in self._left for name in meeting.names):
                told += [meeting.here[name] for name in sorted(meeting.here)]
                del self._open[group, line]
        return told
