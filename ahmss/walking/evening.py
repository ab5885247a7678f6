"""A turn that a foot makes in one swing, spread over it: by how it is spread a leg that turns far is fast or not."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array

__all__ = ["done", "evened"]

_FAST = np.radians(5.0)  # in a frame
_RAMP = 0.2  # of the swing, in which the turn comes to its pace, and in which it ends
_SHARES = np.linspace(0.0, 1.0, 9)


def evened(heading: Array) -> Array:
    """A foot's heading (n,), radians, from the last frame in which it stands to that in which it lands.

    Where it would turn by more than 5 degrees in a frame it turns at a more even pace, by as much as is needed.
    """
    if len(heading) < 3 or float(np.abs(np.diff(heading)).max()) <= _FAST:
        return heading
    at = np.linspace(0.0, 1.0, len(heading))
    even = heading[0] + done(at) * (heading[-1] - heading[0])
    some = heading + _SHARES[:, None] * (even - heading)
    fastest = np.abs(np.diff(some, axis=1)).max(axis=1)
    slow = np.flatnonzero(fastest <= _FAST)
    return some[slow[0] if len(slow) else fastest.argmin()]


def done(share: Array) -> Array:
    """How much (n,) is done at shares (n,) of the time, the pace rising and falling smoothly at the ends."""
    return (_gone(share) - _gone(share - (1.0 - _RAMP))) / (1.0 - _RAMP)


def _gone(since: Array) -> Array:
    """How far (n,) it is gone at a pace that has risen to 1 since so long (n,)."""
    rising = np.clip(since / _RAMP, 0.0, 1.0)
    return _RAMP * (rising**3 - 0.5 * rising**4) + np.maximum(since - _RAMP, 0.0)
