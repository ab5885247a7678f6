"""Where the world comes from: a server, followed or asked, or a recording."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from ahmss.errors import Unreachable, WorldError
from ahmss.world.client import WorldClient
from ahmss.world.keys import read_client
from ahmss.world.recording import Reader
from ahmss.world.schema import HumanRecord
from ahmss.world.view import World

__all__ = ["Live", "Replay"]

_SILENCE_S = 1.5  # without a snapshot for so long the server counts as gone


class Live:
    """The newest world of a server. It may come and go; what was last seen stays.

    Args:
        address: `HOST` or `HOST:PORT`.
        keys: the directory of this client's keys, for another machine.
        request: ask and wait for each world, as the thesis's viewer did, instead of following the published ones.
    """

    def __init__(self, address: str = "", *, keys: Path | None = None, request: bool = False) -> None:
        self._client = WorldClient(address, keys=None if keys is None else read_client(keys), follow=not request)
        self.name = str(self._client.address)
        self._request = request
        self._heard = time.monotonic()
        self._shown = (-1, 0.0)
        self.world: World = self._client.world

    def wait(self, seconds: float) -> bool:
        """Take the newest world; wait at most so long for one that was not seen yet. False where there is none."""
        limit = time.monotonic() + seconds
        while True:
            if self._request:
                self._ask(limit)
            else:
                self._client.poll()
            now = time.monotonic()
            stamp = (self.world.tick, self.world.time)
            if self.world.revision >= 0 and stamp != self._shown:
                self._shown, self._heard = stamp, now
                return True
            if now >= limit:
                return False
            self._client.rest(min(limit - now, 0.05))

    def _ask(self, limit: float) -> None:
        """One question and its answer; a server that is not there is asked again later."""
        self._client.timeout = max(0.2, limit - time.monotonic())
        try:
            self._client.refresh()
        except (Unreachable, WorldError):
            time.sleep(min(0.05, max(0.0, limit - time.monotonic())))

    @property
    def silent(self) -> bool:
        """No world has come for a while."""
        return self.silence() > _SILENCE_S

    def silence(self) -> float:
        """Seconds since the newest world came."""
        return time.monotonic() - self._heard

    def age(self) -> float:
        """Seconds since the shown world was made, by the clocks of both machines."""
        return max(0.0, time.time() - self.world.time)

    def asset(self, name: str) -> bytes:
        """A shape or texture by its hash."""
        return self._client.get_asset(name)

    def skeleton(self, human: HumanRecord) -> dict[str, Any]:
        """A human's skeleton record."""
        return self._client.skeleton(human)

    def close(self) -> None:
        """Disconnect."""
        self._client.close()


class Replay:
    """A recording, tick by tick."""

    def __init__(self, path: Path) -> None:
        self._reader = Reader(path)
        self.world = World()
        self.path = path

    def __len__(self) -> int:
        """How many ticks it holds."""
        return len(self._reader)

    @property
    def rate(self) -> float:
        """Ticks a second."""
        return self._reader.rate

    def show(self, tick: int) -> World:
        """The world at a tick, from 0."""
        return self._reader.show(tick, self.world)

    def asset(self, name: str) -> bytes:
        """A shape or texture by its hash."""
        return self._reader.asset(name)

    def skeleton(self, human: HumanRecord) -> dict[str, Any]:
        """A human's skeleton record."""
        return self._reader.skeleton(human)

    def close(self) -> None:
        """Close the file."""
        self._reader.close()
