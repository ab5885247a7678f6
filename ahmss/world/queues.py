"""Who waits for an object that somebody else has, in the order in which they came: the first has it next.

Who waits says so again and again; who has not for a while has given up, or is gone.
"""

from __future__ import annotations

__all__ = ["Queues"]

_LAPSES = 1.5  # seconds for which who waits is waited for, without another word from them


class Queues:
    """The queues of all objects."""

    def __init__(self) -> None:
        self._now = 0.0
        self._waiting: dict[str, dict[str, float]] = {}  # of each object, when each human last said so

    def step(self, seconds: float) -> None:
        """Time passes."""
        if self._waiting:
            self._now += seconds

    def wait(self, name: str, human: str) -> None:
        """The human waits for the object, or does so still."""
        self._waiting.setdefault(name, {})[human] = self._now

    def first(self, name: str) -> str:
        """Who is to have the object next; "" where nobody waits for it."""
        queue = self._waiting.get(name)
        if queue is None:
            return ""
        for human in [human for human, said in queue.items() if self._now - said > _LAPSES]:
            del queue[human]
        if not queue:
            del self._waiting[name]
        return next(iter(queue), "")

    def leave(self, human: str, name: str | None = None) -> None:
        """The human waits for the object no more; or for none."""
        for key in [name] if name is not None else list(self._waiting):
            queue = self._waiting.get(key, {})
            queue.pop(human, None)
            if not queue:
                self._waiting.pop(key, None)
