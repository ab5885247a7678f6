"""A foot's way through the air that curls, as one turns far meanwhile: brought nearer to the straight, even one."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.walking.evening import done
from ahmss.walking.library import RATE

__all__ = ["uncurled"]

_FAST = 4.5 / RATE  # metres in a frame: what a foot of a straight walk at an ordinary pace has at the most
_NEARLY = 1.02  # times as fast as the slowest of the ways: where that is too fast itself, so fast is slow enough
_SHARES = np.linspace(0.0, 1.0, 11)[:, None, None]


def uncurled(way: Array) -> Array:
    """A foot's places on the floor (n, 2), metres, from the last frame in which it stands to that in which it lands.

    Where it would be faster than 4.5 m/s it goes straighter and at a more even pace, by as much as is needed.
    """
    if len(way) < 3 or float(_steps(way).max()) <= _FAST:
        return way
    even = way[0] + done(np.linspace(0.0, 1.0, len(way)))[:, None] * (way[-1] - way[0])
    some = way + _SHARES * (even - way)
    fastest = _steps(some).max(axis=-1)
    return some[np.argmax(fastest <= max(_FAST, _NEARLY * float(fastest.min())))]


def _steps(way: Array) -> Array:
    """How far it is from each place (..., n, 2) to the next (..., n - 1)."""
    return np.linalg.norm(np.diff(way, axis=-2), axis=-1)
