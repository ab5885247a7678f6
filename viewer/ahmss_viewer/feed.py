"""What a window shows next: the newest world of a server, or a recording that plays by the clock."""

from __future__ import annotations

import time

from ahmss.world.view import World
from ahmss_viewer.source import Live, Replay

__all__ = ["LiveFeed", "ReplayFeed"]


class LiveFeed:
    """A server's newest world."""

    def __init__(self, source: Live) -> None:
        self._source = source
        self.name = source.name

    @property
    def world(self) -> World:
        """What was taken last."""
        return self._source.world

    @property
    def silent(self) -> bool:
        """No world has come for a while."""
        return self._source.silent

    def wait(self, seconds: float) -> bool:
        """Whether there is a new world, waiting at most so long."""
        return self._source.wait(seconds)

    def age(self) -> float:
        """Seconds since the shown world was made."""
        return self._source.age()

    def hold(self, paused: bool) -> None:
        """The world goes on whether somebody looks or not."""

    def jump(self, seconds: float) -> None:
        """A server's world has no past."""

    def lines(self) -> list[str]:
        """What the overlay says of it."""
        if not self.silent:
            return [] if len(self.world.human_ids) else ["nobody is here yet"]
        seconds = self._source.silence()
        if self.world.revision < 0:
            return [f"no server answers at {self.name} yet"]
        return [f"no news from {self.name} for {seconds:.0f} s; this is the last that was seen"]


class ReplayFeed:
    """A recording at its own rate, over and over."""

    silent = False

    def __init__(self, source: Replay) -> None:
        self._source = source
        self.name = str(source.path)
        self._tick = -1
        self._at = 0.0  # seconds into the recording at `_since`
        self._since = time.monotonic()
        self._paused = False

    @property
    def world(self) -> World:
        """The world at the present time."""
        return self._source.world

    def wait(self, seconds: float) -> bool:
        """Show the frame that is due."""
        limit = time.monotonic() + seconds
        while True:
            tick = int(self._now() * self._source.rate) % max(1, len(self._source))
            if tick != self._tick and len(self._source):
                self._tick = tick
                self._source.show(tick)
                return True
            left = limit - time.monotonic()
            if left <= 0.0:
                return False
            time.sleep(min(left, 0.25 / self._source.rate))

    def age(self) -> float:
        """A recording does not age."""
        return 0.0

    def hold(self, paused: bool) -> None:
        """Stop the clock, or let it go on."""
        self._at, self._since, self._paused = self._now(), time.monotonic(), paused

    def jump(self, seconds: float) -> None:
        """Back or on by some seconds, not before the start."""
        self._at, self._since = max(0.0, self._now() + seconds), time.monotonic()

    def lines(self) -> list[str]:
        """What the overlay says of it."""
        return [f"frame {max(0, self._tick)} of {len(self._source)}"]

    def _now(self) -> float:
        return self._at if self._paused else self._at + time.monotonic() - self._since
