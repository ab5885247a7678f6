"""How far a main in lockstep is ahead of the world, and the frames that wait to be sent together."""

from __future__ import annotations

from collections.abc import Callable

from ahmss.world import frame as frames

__all__ = ["Ahead"]

_BUNDLE = 8
_AHEAD = 32


class Ahead:
    """The frames of one client in lockstep: published, sent, and completed by the world.

    A main alone waits for nobody: its frames go several in a message, and it may be many ahead of the world, but while
    something falls each frame must see the one before.

    Args:
        send: sends what is to be sent.
    """

    def __init__(self, send: Callable[[bytes], bool]) -> None:
        self.alone = False
        self._send = send
        self._published = self._completed = self._calm = 0  # calm: the frame after which nothing falls
        self._unsent: list[bytes] = []

    def begin(self, tick: int = 0) -> None:
        """The world is at this frame, and so is the main: it has joined, or there is a new connection (frame 0)."""
        self._published = self._completed = tick

    def forget(self) -> None:
        """At a new connection: nothing waits, nothing falls."""
        self.begin()
        self._calm = 0
        self._unsent.clear()

    def falls(self, ticks: int) -> None:
        """For so many ticks from now on something falls."""
        self._calm = max(self._calm, self._published + ticks)

    def publish(self, data: bytes) -> None:
        """The next frame; it may wait for others."""
        self._published += 1
        self._unsent.append(data)
        if not self.alone or len(self._unsent) >= _BUNDLE or self._published <= self._calm:
            self.send()

    def complete(self, tick: int) -> None:
        """The world has completed all up to this frame."""
        self._completed = tick

    def is_over(self, behind: int) -> bool:
        """Whether more than `behind` published frames are not completed."""
        return self._published - self._completed > behind

    def allowed(self, behind: int) -> int:
        """How many frames it may be ahead that would be `behind`; where it is not alone, all that wait are sent."""
        if self.alone and behind > 0 and self._published > self._calm:
            return _AHEAD
        self.send()
        return behind

    def send(self) -> None:
        """Send the frames that wait, several in one message."""
        if not self._unsent:
            return
        data = self._unsent[0] if len(self._unsent) == 1 else frames.bundle(self._unsent)
        self._unsent.clear()
        self._send(data)
