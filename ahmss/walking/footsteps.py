"""Where and when feet are set down: the plan that a performance follows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array

__all__ = ["LEFT", "RIGHT", "Footsteps", "Frame", "Step"]

RIGHT, LEFT = 0, 1


@dataclass(frozen=True)
class Frame:
    """A place on the floor with a heading: x, y in metres, radians."""

    x: float
    y: float
    heading: float

    def then(self, ahead: float, left: float, turn: float = 0.0) -> Frame:
        """The frame so far ahead and to the left of this one, turned."""
        cos, sin = np.cos(self.heading), np.sin(self.heading)
        return Frame(
            float(self.x + cos * ahead - sin * left), float(self.y + sin * ahead + cos * left), self.heading + turn
        )

    @property
    def place(self) -> Array:
        """(2,)."""
        return np.array([self.x, self.y])


@dataclass(frozen=True)
class Step:
    """One foot's way from where it stands to where it lands.

    foot: RIGHT or LEFT. landing: the ankle's place and the foot's heading. lift, land: seconds. body: the body's
    heading once it has landed. push, strike: how much of a full step's push-off and heel strike there is, 0 to 1.
    """

    foot: int
    landing: Frame
    lift: float
    land: float
    body: float
    push: float = 0.0
    strike: float = 0.0


@dataclass(frozen=True)
class Footsteps:
    """Feet that stand (right, left), a body heading, and the steps from there; seconds in all."""

    feet: tuple[Frame, Frame]
    body: float
    steps: Sequence[Step]
    seconds: float
