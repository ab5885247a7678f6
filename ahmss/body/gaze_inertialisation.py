"""Inertialisation of spine and head, after the gaze has turned them: whatever looks somewhere, and ceases to.

What is smoothed are the turns themselves. A place that is looked at, moved over from one side of the head to another,
would pass close to the eyes, and a share of looking there that fades has no bound in degrees.
"""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.inertialisation import FARTHER, Rotations, Rows
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, from_rotation_vector, multiply, to_rotation_vector

__all__ = ["TURNED", "GazeInertialiser"]

TURNED = [INDEX["spine"], INDEX["head"]]
_FASTEST = np.radians(200.0)  # a second, by which a difference decays: 3.3 degrees a frame at 60 Hz
_STOP = 0.2  # seconds in which a turn comes to rest that is not gone on with
_SECONDS = 0.5  # how long what it went on until then takes to go back: at 0.3 of the turn's speed at the most
_SAME = np.radians(0.05)  # by which what turns them may differ from what did to be the same: an arm hangs on the spine


class GazeInertialiser:
    """Smooths spine and head of one human, each across the changes of what turns it."""

    def __init__(self, rate: float) -> None:
        """Smooth at a rate, frames a second."""
        self._turns = Rotations(2, rate, _SECONDS, _FASTEST, _STOP)
        self._source: Array | None = None  # (2, 4), that came last
        self._stop = max(int(np.ceil(_STOP * rate)), 2)

    @property
    def settled(self) -> bool:
        """Whether nothing decays."""
        return self._turns.settled

    def place(self, rotations: Array) -> None:
        """Stand still in a pose (43, 4)."""
        self._turns.place(rotations[TURNED])
        self._source = None

    def settle(self, rotations: Array) -> None:
        """Tell the pose (43, 4) that came out."""
        self._turns.settle(rotations[TURNED])

    def step(self, rotations: Array, switched: Rows) -> Array:
        """The smoothed rotations (2, 4) of spine and head.

        Two motions that look at the same thing, one after the other, are one gaze: it goes on as it was.

        Args:
            rotations: (43, 4) with the gaze solved.
            switched: (2,) what turns them is another from this frame on, or nothing does: see `rest`.
        """
        source = rotations[TURNED]
        if self._source is not None and not self.settled:
            turned = to_rotation_vector(multiply(conjugate(self._source), source))
            switched = switched & (np.linalg.norm(turned, axis=-1) > _SAME)
        out = self._turns.step(source, switched)
        self._source = None if self.settled else source
        return out

    def rest(self, before: Array, present: Array) -> Array:
        """Where (2, 4) spine and head come to rest, a frame farther and then softly; of the last two poses (43, 4)."""
        turn = to_rotation_vector(multiply(conjugate(before[TURNED]), present[TURNED]))
        return multiply(present[TURNED], from_rotation_vector((1.0 + FARTHER * self._stop) * turn))
