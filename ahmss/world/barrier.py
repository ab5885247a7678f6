"""Lockstep: nothing happens before every main has said what comes next, and then it happens in the order of names.

Each main has a queue. A round begins when no queue is empty. If any first entry is a request, one request of each main
whose first entry is one is carried out, and its reply sent; else all first entries are frames, and together they make
the next tick. So what is carried out, and in what order, depends on what the mains send and never on when it arrives.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

from ahmss.errors import ProtocolError
from ahmss.world.schema import Request

__all__ = ["Barrier"]

_LONGEST_QUEUE = 1000


class Barrier:
    """The queues of the mains that are expected.

    Args:
        names: of their humans; each main has one.
    """

    def __init__(self, names: Iterable[str]) -> None:
        self._queues: dict[str, deque[bytes | Request]] = {name: deque() for name in sorted(names)}
        self._names: dict[bytes, str] = {}
        self._owners: dict[str, bytes] = {}

    @property
    def owners(self) -> list[bytes]:
        """The clients that take part, in the order of their humans' names."""
        return [self._owners[name] for name in self._queues if name in self._owners]

    @property
    def is_ahead(self) -> bool:
        """Whether a main alone has sent its next frame already: then a quiet tick needs no answer yet."""
        if len(self._queues) != 1:
            return False
        (queue,) = self._queues.values()
        return bool(queue) and isinstance(queue[0], bytes)

    def name_of(self, owner: bytes) -> str:
        """The human of a client that takes part, else ""."""
        return self._names.get(owner, "")

    def expects(self, name: str) -> bool:
        """Whether the human is one of the run."""
        return name in self._queues

    def enter(self, owner: bytes, name: str) -> None:
        """This client moves that human."""
        self._names[owner] = name
        self._owners[name] = owner

    def push(self, owner: bytes, entry: bytes | Request) -> None:
        """The next thing that a main says: a frame's bytes or a request. ProtocolError: it says far too much."""
        queue = self._queues[self._names[owner]]
        if len(queue) >= _LONGEST_QUEUE:
            raise ProtocolError("world protocol: far more is sent than lockstep takes; wait for the ticks")
        queue.append(entry)

    def leave(self, owner: bytes) -> list[bytes | Request]:
        """The main takes no more part; what it had said beyond."""
        name = self._names.pop(owner, "")
        self._owners.pop(name, None)
        return list(self._queues.pop(name, ()))

    def next_round(self) -> list[tuple[bytes, bytes | Request]]:
        """Who says what, in the order of names: requests, or a frame of each main; empty while one is waited for."""
        queues = self._queues
        if not queues or not all(queues.values()):
            return []
        asking = [name for name, queue in queues.items() if not isinstance(queue[0], bytes)]
        return [(self._owners[name], queues[name].popleft()) for name in asking or list(queues)]
