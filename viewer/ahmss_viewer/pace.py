"""How fast pictures come and how old what they show is."""

from __future__ import annotations

import time
from collections import deque

__all__ = ["Pace"]

_WINDOW = 60
_MOST = 200_000
_PAUSE_S = 0.5  # a gap longer than this is no slow picture but a world that stood still


class Pace:
    """Told of each finished picture; `seconds` leaves out the pauses in which nothing new came."""

    def __init__(self) -> None:
        self.pictures = 0
        self.seconds = 0.0
        self.last = 0.0
        self.ages: list[float] = []
        self._at = 0.0
        self._recent: deque[tuple[float, float]] = deque(maxlen=_WINDOW)
        self._said = (0.0, "")

    def shown(self, age: float, *, ages: bool = True) -> None:
        """A picture of a world `age` seconds old is finished; a recording does not age."""
        now = time.perf_counter()
        self.last = min(now - self._at, _PAUSE_S) if self._at else 0.0
        if self._at and now - self._at <= _PAUSE_S:
            self.seconds += now - self._at
            self.pictures += 1
            self._recent.append((now - self._at, age))
        self._at = now
        if ages and len(self.ages) < _MOST:
            self.ages.append(age)

    def rate(self) -> float:
        """Pictures a second, of the last 60."""
        total = sum(step for step, _ in self._recent)
        return len(self._recent) / total if total else 0.0

    def text(self) -> str:
        """Two lines for the overlay, renewed twice a second; nothing before the second picture."""
        now = time.perf_counter()
        if self._recent and now - self._said[0] > 0.5:
            age = sum(age for _, age in self._recent) / len(self._recent)
            older = f"\nworld {1e3 * age:.0f} ms old" if self.ages else ""
            self._said = (now, f"{self.rate():.0f} frames/s{older}")
        return self._said[1]
