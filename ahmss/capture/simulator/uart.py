"""The sending half of a serial line: ten bits a byte, one byte after another, so long and no shorter."""

from __future__ import annotations

import math
from collections import deque

__all__ = ["BITS", "Uart"]

BITS = 10
"""On the line for each byte: a start bit, eight of data, a stop bit."""


class Uart:
    """Bytes go in when they are ready, and come out when their last bit has left the line."""

    def __init__(self, baud: int) -> None:
        self._byte = BITS / baud
        self._queue: deque[tuple[float, bytes]] = deque()  # when the first of these bytes begins
        self.free = -math.inf
        """When the last byte will be out."""

    def load(self, data: bytes, at: float) -> None:
        """Send these bytes, from a time on at the earliest."""
        start = max(at, self.free)
        self._queue.append((start, data))
        self.free = start + len(data) * self._byte

    def gone(self, now: float) -> bytes:
        """The bytes whose last bit has left by now, and were not told before."""
        out: list[bytes] = []
        while self._queue:
            start, data = self._queue[0]
            count = min(math.floor((now - start) / self._byte + 1e-6), len(data))
            if count <= 0:
                break
            out.append(data[:count])
            self._queue.popleft()
            if count < len(data):
                self._queue.appendleft((start + count * self._byte, data[count:]))
                break
        return b"".join(out)

    def next_time(self) -> float | None:
        """When the next byte will be out; None while the line is quiet."""
        return self._queue[0][0] + self._byte if self._queue else None

    def clear(self) -> None:
        """Forget what has not left."""
        self._queue.clear()
        self.free = -math.inf
