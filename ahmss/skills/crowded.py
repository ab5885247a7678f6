"""What a hand closes on together with what that stands on or beside: fingers stay out of the table under a handle."""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.quaternion import to_matrix
from ahmss.grasping.field import Crowded, Field
from ahmss.reaching.prism import Prism
from ahmss.skills.reaching import prisms_of

__all__ = ["crowded"]

_ABOUT = 0.25  # metres from what is held that a hand which holds it can meet


def crowded(task: HumanTask, field: Field, place: Array) -> Field:
    """A field of the object with what is around a place (3,) of its frame; that holds the place it is not in the way.

    A thing in a shelf is within the outline of that: there no one can tell where a hand fits in.
    """
    thing = task.object
    assert thing is not None
    at = thing.frame.apply(place)[None]
    near = [
        prism
        for prism in prisms_of(task)
        if not prism.sought and prism.at_least(at)[0] < _ABOUT and float(prism.signed(at)[0]) > 0.0
    ]
    return Crowded.of(field, _Others(thing.frame, near)) if near else field


class _Others:
    """The distance from some prisms, of points in a frame (world <- frame)."""

    def __init__(self, frame: Transform, prisms: list[Prism]) -> None:
        self._place, self._turn, self._prisms = frame.place, to_matrix(frame.rotation), prisms

    def __call__(self, points: Array) -> Array:
        """Metres (...) of points (..., 3): never more than it is; negative within."""
        flat = points.reshape(-1, 3) @ self._turn.T + self._place
        nearest = np.full(len(flat), np.inf)
        for prism in self._prisms:
            away = prism.at_least(flat)
            within = np.flatnonzero(away <= 0.0)
            if len(within):
                away[within] = prism.signed(flat[within])
            nearest = np.minimum(nearest, away)
        return nearest.reshape(points.shape[:-1])
