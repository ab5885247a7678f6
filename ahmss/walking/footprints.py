"""Where the feet of a walk stand: before and after it, and one time after the other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array

__all__ = ["Ends", "Footprints"]


@dataclass(frozen=True)
class Ends:
    """Where the feet are before and after, right and left: places (2, 2) of the ankles, headings (2,)."""

    first: Array
    first_heading: Array
    last: Array
    last_heading: Array


@dataclass(frozen=True)
class Footprints:
    """Where a foot stands one time after the other: since which frames, the flat foot's ankle (n, 2), heading (n,)."""

    since: NDArray[np.intp]
    places: Array
    headings: Array

    def at(self, frame: int) -> tuple[Array, float]:
        """The one at a frame, or before it where the foot is in the air."""
        i = int(np.searchsorted(self.since, frame, side="right")) - 1
        return self.places[i], float(self.headings[i])
