"""How a palm is led on its way by who is carried: over things, and round the very thing that it is to take.

The way is lifted after the start, before it goes far, and before the end it is led out in front of the palm's place and
down to it, so that an open hand comes before what it takes along the palm's own x, its fingers beside it. By how much
is looked for from frame to frame, among a few ways: the shortest on which the hand stays clear, where it is carried on
meanwhile. It changes softly.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import to_matrix
from ahmss.motion.easing import minimum_jerk
from ahmss.reaching.path import Curve, lifted, sampled
from ahmss.reaching.prism import Prism, clearance

__all__ = ["Led"]

_RISE = (0.14, 0.24, 0.34, 0.44, 0.54)  # metres by which the palm is lifted after the start
_LAST = (0.1, 0.2, 0.3)  # before the end
_OUT = (0.0, 0.1, 0.2, 0.3)  # and led out in front of its place
_ENDS = sorted(((last, out) for last in _LAST for out in _OUT), key=sum)  # the shortest first
_LEAST = np.array([_RISE[0], *_ENDS[0]])
_GROWS, _FALLS, _SOON = 0.012, 0.002, 0.002  # by which these grow and fall in a frame at the most, and how soon
_AT_ONCE = 0.05  # of the time, until which they do: the palm is still where the way begins
_LEAVES, _TINY = 0.1, 1e-9  # metres by which a palm goes towards its place while it is lifted
_CLEAR, _BESIDE = 0.015, 0.02  # metres of air to things, and to what is reached for
_SEEN_TO, _LOOKS, _SOME = 0.85, 8, 3  # until when a way is looked at, how often, and every which point of a hand
_NEARS = np.linspace(0.0, 1.0, 16)  # of what is left of the time, when the same is looked at of what is reached for


class Led:
    """The way of one palm, from frame to frame."""

    def __init__(self) -> None:
        self._by, self._growing = _LEAST.copy(), np.zeros(3)

    def at(self, start: Array, palm: Array, time: float) -> Array:
        """The palm (7,) at a share of the time, between two palms (7,)."""
        rise, last, out = self._by.tolist()
        return _way(start, palm, rise, last, out).at(np.array([time]))[0]

    def step(
        self, near: Sequence[Prism], hand: tuple[Array, Array], palms: tuple[Array, Array], time: float, ahead: Array
    ) -> None:
        """Change it, by a frame, to where an open hand stays clear of things.

        Args:
            near: the things. hand: points (n, 3) and radii (n,) of the open hand as its palm sees them.
            palms: where it is from (7,), and where it comes to (7,). time: share of it.
            ahead: (3,) how far the body, and with it where the palm is from, is likely to come until the end, metres.
        """
        best = self._best(near, hand, palms, time, ahead)
        if time < _AT_ONCE:
            self._by = best
        gain = np.clip(best - self._by, -_FALLS, _GROWS) - self._growing
        self._growing = self._growing + np.clip(gain, -_SOON, _SOON)
        self._by = np.maximum(self._by + self._growing, _LEAST)

    def _best(
        self, near: Sequence[Prism], hand: tuple[Array, Array], palms: tuple[Array, Array], time: float, ahead: Array
    ) -> Array:
        """Rise, last and out (3,): the least rise that is clear, and with that the shortest way which still is.

        Where none is clear, of that which is the least deep.
        """
        others, sought = [p for p in near if not p.sought], [p for p in near if p.sought]
        some = hand[0][::_SOME], hand[1][::_SOME]
        times, nears = np.linspace(time, _SEEN_TO, _LOOKS), time + (1.0 - time) * _NEARS
        ways = [_way(*palms, rise, *_ENDS[0]) for rise in _RISE]
        rise = _RISE[_first_clear(_lack(others, some, ways, times, ahead, _CLEAR))]
        if not sought:
            return np.array([rise, *_ENDS[0]])
        ways = [_way(*palms, rise, last, out) for last, out in _ENDS]
        lack = _lack(others, some, ways, times, ahead, _CLEAR)
        lack = np.maximum(lack, _lack(sought, hand, ways, nears, ahead, _BESIDE))
        return np.array([rise, *_ENDS[_first_clear(lack)]])


def _way(start: Array, palm: Array, rise: float, last: float, out: float) -> Curve:
    """The way between two palms (7,), which rises before it goes far."""
    off = palm[:3] - start[:3]
    leaves = off * min(1.0 / 3.0, _LEAVES / max(float(np.linalg.norm(off)), _TINY))
    return lifted(start, palm, rise, last, leaves, out=out)


def _first_clear(lack: Array) -> int:
    """Of ways that lack so much air (m), metres, the first which lacks none; where all do, that which lacks least."""
    clear = np.flatnonzero(lack <= 0.0)
    return int(clear[0]) if len(clear) else int(lack.argmin())


def _lack(
    prisms: Sequence[Prism], hand: tuple[Array, Array], ways: Sequence[Curve], times: Array, ahead: Array, air: float
) -> Array:
    """Metres (m) of air to things that a hand lacks at the most on ways (m) to one palm, at shares of the time (f,).

    It comes as near to them as it is to be in the end. From the first of the times on the body comes ahead (3,).
    """
    if not prisms:
        return np.zeros(len(ways))
    points, radii = hand
    far = air + float(radii.max())
    times = np.append(times, 1.0)
    places, _ = sampled(np.stack([way.points for way in ways]), times)
    on = (times - times[0]) / max(1.0 - times[0], _TINY)
    places = places + ((1.0 - minimum_jerk(times)) * on)[:, None] * ahead
    skin = places[..., None, :] + points @ to_matrix(ways[0].turned(times)).swapaxes(-1, -2)
    gaps = (clearance(prisms, skin, far) - radii).min(axis=-1)
    least = np.minimum(gaps[:, -1:], air)
    return (least - gaps).max(axis=-1)
