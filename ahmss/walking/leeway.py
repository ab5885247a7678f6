"""Feet of a walk whose body is moved aside for a while: where they stand they stay, in the air they go with it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.motion.contact import runs
from ahmss.motion.easing import minimum_jerk

__all__ = ["Leeway", "bump"]


@dataclass(frozen=True)
class Leeway:
    """By how much a walk is moved, metres on the floor.

    body: (F, 2) the hips. swings: of the right and the left foot (n, 2), half-way between each footprint and the next,
    more than the body.
    """

    body: Array
    swings: tuple[Array, Array]

    @classmethod
    def none(cls, frames: int, swings: tuple[int, int]) -> Leeway:
        """Of so many frames, and so many swings of the right and the left foot."""
        return cls(np.zeros((frames, 2)), (np.zeros((swings[0], 2)), np.zeros((swings[1], 2))))

    def copy(self) -> Leeway:
        """The same, in arrays of its own."""
        return Leeway(self.body.copy(), (self.swings[0].copy(), self.swings[1].copy()))

    def foot(self, bears: NDArray[np.bool_], foot: int) -> Array:
        """By how much a foot is moved at each frame (F, 2).

        Where it stands it is moved as the body is when that passes over it, but not where it stands first and last:
        there it is where it is, and shall be. Half-way through the air it is moved as the body is then, and by its own.

        Args:
            bears: (F,) whether the foot is on the ground.
            foot: 0 the right.
        """
        body, own = self.body, self.swings[foot]
        out = np.zeros_like(body)
        spans = runs(bears)
        stood = [body[(first + end - 1) // 2] for first, end in spans]
        if stood:
            stood[0], stood[-1] = np.zeros(2), np.zeros(2)
        for i, (first, end) in enumerate(spans):
            out[first:end] = stood[i]
            if i + 1 == len(spans):
                break
            lift, land = end - 1, spans[i + 1][0]
            u = np.arange(1, land - lift)[:, None] / (land - lift)
            share = minimum_jerk(u)
            more = body[(lift + land) // 2] - 0.5 * (stood[i] + stood[i + 1]) + own[i]
            out[end:land] = (1.0 - share) * stood[i] + share * stood[i + 1] + bump(u) * more
        return out


def bump(u: Array) -> Array:
    """From 0 at both ends to 1 half-way (...), without a speed or an acceleration where a foot stands."""
    return 64.0 * (u * (1.0 - u)) ** 3
