"""All that falls now, and what it may come to rest on."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from ahmss.world.falling import Fall, fall_of
from ahmss.world.solids import Solids

if TYPE_CHECKING:
    from ahmss.world.things import Thing, Things

__all__ = ["Falls"]


class Falls:
    """Falls under way, by the id of what falls.

    Args:
        solids: the shapes that fall and on which they fall.
    """

    def __init__(self, solids: Solids) -> None:
        self._solids = solids
        self._falls: dict[int, tuple[Fall, float]] = {}

    @property
    def seconds(self) -> float:
        """Until all that falls rests."""
        return max((fall.seconds - passed for fall, passed in self._falls.values()), default=0.0)

    def begin(self, things: Things, thing: Thing, carried: Iterable[Thing]) -> None:
        """It falls, if nothing holds it up; what belongs where it is, as a door or a chair, does not."""
        if thing.attached or thing.holder or not things.behaviours.get(thing.behaviour).falls:
            return
        solid = self._solids.get(thing.shape, thing.behaviour)
        if solid is None:
            return
        own = {thing.id, *(part.id for part in carried)}
        around = [
            (other.id, what)
            for other in things.by_name.values()
            if not other.hand and other.id not in own and (what := self._solids.get(other.shape, other.behaviour))
        ]
        poses = things.poses.data[[things.poses.rows[number] for number, _ in around]].reshape(-1, 7)
        reach = np.array([what.radius for _, what in around]) + 3.0 * solid.radius
        pose = things.poses[thing.id].copy()
        near = np.flatnonzero(np.linalg.norm(poses[:, :2] - pose[:2], axis=1) <= reach)
        fall = fall_of(solid, pose, [(around[i][1], poses[i]) for i in near.tolist()])
        if fall is not None:
            self._falls[thing.id] = (fall, 0.0)

    def cancel(self, thing: Thing) -> None:
        """It is held, moved or removed: it falls no longer."""
        self._falls.pop(thing.id, None)

    def step(self, things: Things, seconds: float) -> None:
        """A tick's share of all falls."""
        for number, (fall, before) in list(self._falls.items()):
            thing, passed = things.by_id[number], before + seconds
            thing.fell = thing.moved = True
            things.place(b"", [thing], fall.pose(passed)[None])
            if passed < fall.seconds:
                self._falls[number] = (fall, passed)
            else:
                del self._falls[number]
                things.rest(thing)

    def ticks(self, rate: float) -> int:
        """How many ticks all of it takes."""
        return math.ceil(self.seconds * rate) + 1 if self._falls else 0
