"""How deep a hand is in the part that it takes: as it comes to it, goes with it, and leaves it where it then is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.grasping.field import Field
from ahmss.grasping.hand import Hand
from ahmss.skills.part_ways import Part
from ahmss.skills.rolling_on import brought

__all__ = ["InPart"]

_NEAR = 0.25  # metres from its site within which a palm's fingers may be in it
_EVERY = 2  # frames of what is made


class InPart:
    """The part of a task's object that a hand takes, as far as its shape is known."""

    def __init__(self, task: HumanTask) -> None:
        self._task, self._field = task, _field_of(task)

    def at_rest(self, side: str, part: Part, palms: Array, shapes: Array) -> float:
        """Metres by which fingers (n, 14, 4) on palms (n, 7) are in it where it is now; negative outside."""
        there = part.at(np.zeros(1))
        return self._deepest(
            side, Transform(*(np.repeat(a, len(palms), axis=0) for a in (there.place, there.rotation))), palms, shapes
        )

    def depth(self, side: str, part: Part, palms: Array, shapes: Array, way: Array, held: NDArray[np.bool_]) -> float:
        """The same of a hand that brings it along shares (n) of its way in the frames in which it is held (n)."""
        on = np.flatnonzero(held)
        carried = brought(part, palms[on], way[on])
        frame = np.clip(np.arange(len(palms)) - on[0], 0, len(on) - 1)[::_EVERY]
        site = Transform(carried.place[frame], carried.rotation[frame])
        return self._deepest(side, site, palms[::_EVERY], shapes[::_EVERY])

    def off(self, side: str, part: Part, palms: Array, shapes: Array, way: Array, held: NDArray[np.bool_]) -> float:
        """Metres by which the thumb or all other fingers are off it at the most while it is held; as of `depth`."""
        on = np.flatnonzero(held)[::_EVERY]
        gaps = self._gaps(side, brought(part, palms[on], way[on]), palms[on], shapes[on])
        if gaps is None:
            return 0.0
        return float(np.maximum(gaps[:, :2].min(axis=1), gaps[:, 2:].min(axis=1)).max())

    def _deepest(self, side: str, site: Transform, palms: Array, shapes: Array) -> float:
        """The same, the part's site being at such places (n)."""
        near = np.linalg.norm(palms[:, :3] - site.place, axis=1) < _NEAR
        gaps = self._gaps(side, Transform(site.place[near], site.rotation[near]), palms[near], shapes[near])
        return -np.inf if gaps is None else -float(gaps.min())

    def _gaps(self, side: str, site: Transform, palms: Array, shapes: Array) -> Array | None:
        """Metres (n, 14) between the skin of each link and it, negative within; None where nobody knows."""
        if self._field is None or not len(palms):
            return None
        thing = self._task.object
        assert thing is not None
        assert self._task.site is not None
        at_rest = thing.frame.inverse().then(self._task.site)
        seen = at_rest.then(site.inverse().then(Transform.of(palms))).row()
        return Hand.of(self._task.human, side).gaps(self._field, seen, shapes)


def _field_of(task: HumanTask) -> Field | None:
    """The distances from the part around the action's site; None where the shape has none of its own."""
    thing = task.object
    if thing is None or thing.shape is None or task.site is None:
        return None
    place = thing.frame.inverse().then(task.site).place
    part = thing.shape.part(place)
    return None if part is None else part.field(place)
