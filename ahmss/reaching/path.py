"""The palm's way: a smooth curve, raised as far as what is in the way of a straight line asks.

Of a family of curves, each lifted differently at either end, the shortest is taken on which hand and forearm stay
clear; a few others, each of another kind, are kept for where the solved arm shows that this one will not do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from ahmss.body.array import Array
from ahmss.body.quaternion import rotate, slerp
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.steps import Steps
from ahmss.reaching.prism import Prism
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.skin import MARGIN, gaps

__all__ = ["TURNED_LATE", "Curve", "clear_curves", "curves", "lifted", "sampled"]

TURNED_BY = 0.62
"""The share of the time by which the hand has its orientation: by then three quarters of the way are done."""

TURNED_LATE = 0.3, 0.92
"""The same of a hand that comes off something first, turned as it is: from when on it turns, and by when it has."""

# Metres by which the curve is lifted after the start and before the end.
_FIRST, _LAST = (0.03, 0.12, 0.25, 0.42, 0.6), (0.02, 0.1, 0.22)
_BACK = (0.0, 0.18, 0.36)  # metres by which it goes back first
_INTO, _NO_LOOP = 0.06, 0.12  # metres by which it arrives along the palm's x; way below which it is less curved
_UP = np.array([0.0, 0.0, 1.0])
_SAMPLES = 20
_EVENLY = np.linspace(0.0, 1.0, 48)
_SHORTEST, _TINY = 1e-4, 1e-9  # metres
_LEAVING, _ARRIVING = 0.25, 0.7  # shares of the time
_AT_ONCE = 10  # curves, that are looked at between two pauses
_CLOSE, _INSIDE = 900.0, 20000.0  # what a square metre of being too near, and of being inside, costs in metres of way
_KEPT = 4  # curves


@dataclass(frozen=True, eq=False)
class Curve:
    """A cubic Bezier curve (4, 3), metres, the rotations (4,) at its ends, and in which shares of the time it turns."""

    points: Array
    start: Array
    end: Array
    turns: tuple[float, float] = (0.0, TURNED_BY)

    @property
    def length(self) -> float:
        """Metres."""
        return float(self._passed()[-1])

    def at(self, time: Array) -> Array:
        """Palms (n, 7) at shares of the time (n), from rest to rest; the rotation is there before the place."""
        passed, done = self._passed(), minimum_jerk(time)
        if passed[-1] > _SHORTEST:  # evenly along the curve, whose parameter is not its length
            done = np.clip(CubicSpline(passed / passed[-1], _EVENLY)(done), 0.0, 1.0)
        return np.concatenate([_bezier(self.points, done), self.turned(time)], axis=-1)

    def turned(self, time: Array) -> Array:
        """The palm's rotations (n, 4) at shares of the time (n)."""
        first, last = self.turns
        return slerp(self.start, self.end, minimum_jerk((time - first) / (last - first)))

    def _passed(self) -> Array:
        """The length up to even steps of the parameter, metres; it always grows."""
        steps = np.linalg.norm(np.diff(_bezier(self.points, _EVENLY), axis=0), axis=-1)
        return np.concatenate([[0.0], np.cumsum(np.maximum(steps, _TINY))])


def curves(start: Array, end: Array, ahead: float) -> list[Curve]:
    """The family of curves between two palms (7,): lifted, and drawn back first, each by so much.

    Args:
        start: where the palm is. end: where it shall be; it arrives along its own x.
        ahead: the heading of who reaches, radians: back is the other way.
    """
    back = -np.array([np.cos(ahead), np.sin(ahead), 0.0])
    return [lifted(start, end, first, last, by * back) for by in _BACK for first in _FIRST for last in _LAST]


def lifted(
    start: Array, end: Array, first: float, last: float, back: Array | None = None, *, out: float = 0.0
) -> Curve:
    """The curve between two palms (7,) that rises by so many metres after the start, and comes down by so many.

    back: (3,) where it goes first, metres, in place of towards the end. out: by how many metres more than else it is
    led out in front of the end, to arrive along the palm's x.
    """
    a, b = start[:3], end[:3]
    distance = float(np.linalg.norm(b - a))
    into = rotate(end[3:7], np.array([1.0, 0.0, 0.0]))
    leave = (b - a) / 3.0 if back is None or not back.any() else back
    arrive = (a - b) / 3.0 - (min(_INTO, 0.25 * distance) + out) * into
    shrink = min(1.0, distance / _NO_LOOP)  # a hand that is there already makes no loop
    points = np.stack([a, a + shrink * (leave + first * _UP), b + shrink * (arrive + last * _UP), b])
    return Curve(points, start[3:7], end[3:7])


def clear_curves(
    reacher: Reacher, family: Sequence[Curve], seats: tuple[Array, Array], present: Array, prisms: Sequence[Prism]
) -> Steps[list[Curve]]:
    """The curve of a family that costs least, the shortest that stays clear; then some of the others, the best first.

    Args:
        reacher: the arm.
        family: the curves, between the same two palms.
        seats: places (20, 3) and rotations (20, 4) of the spine link at even shares of the time, in the world.
        present: (3, 4) the arm's links at the start.
        prisms: what is to be kept clear of.
    """
    time = np.linspace(0.0, 1.0, _SAMPLES)
    places, lengths = sampled(np.stack([curve.points for curve in family]), time)
    rising = np.argsort(lengths)
    costs = lengths.copy()  # of those that are not looked at what they cost at least
    turned, least = family[0].turned(time), np.inf
    for first in range(0, len(family) if prisms else 0, _AT_ONCE):
        some = rising[first : first + _AT_ONCE]
        if lengths[some[0]] >= least:  # what is longer costs more even where it is clear
            break
        if first:
            yield
        palms = np.concatenate([places[some], np.broadcast_to(turned, (len(some), _SAMPLES, 4))], axis=-1)
        costs[some] += _nearness(gaps(reacher, palms, seats, present, prisms), time)
        least = min(least, float(costs[some].min()))
    return _of_each_kind(family, np.argsort(costs, kind="stable").tolist())


def _of_each_kind(family: Sequence[Curve], order: Sequence[int]) -> list[Curve]:
    """The first of an order, and then the first of each other kind: those that leave alike are one kind."""
    kinds: dict[tuple[float, ...], Curve] = {}
    for i in order:
        points = family[i].points
        kinds.setdefault(tuple((points[1] - points[0]).round(6).tolist()), family[i])
    return list(kinds.values())[:_KEPT]


def _nearness(between: Array, time: Array) -> Array:
    """What gaps (m, n, 15) to things cost (m), at shares of the time (n), by how much they are too small.

    Where a way begins or ends nearer to a thing than the margin, it may be so near there.
    """
    first, last = (np.minimum(between[:, [end]], MARGIN) for end in (0, -1))
    least = np.where(time[:, None] < _LEAVING, first, np.where(time[:, None] > _ARRIVING, last, MARGIN))
    near, deep = np.maximum(least - between, 0.0), np.maximum(np.minimum(least, 0.0) - between, 0.0)
    return (_CLOSE * near**2 + _INSIDE * deep**2).mean(axis=1).sum(axis=-1)


def sampled(points: Array, time: Array) -> tuple[Array, Array]:
    """Places (m, n, 3) of curves (m, 4, 3) at shares of the time (n), to a millimetre or two, and their lengths (m)."""
    fine = _weights(_EVENLY) @ points
    passed = np.cumsum(np.maximum(np.linalg.norm(np.diff(fine, axis=1), axis=-1), _TINY), axis=-1)
    passed = np.concatenate([np.zeros((len(points), 1)), passed], axis=-1)
    done = minimum_jerk(time)
    along = np.stack([np.interp(done, way / way[-1], _EVENLY) for way in passed])
    return np.einsum("mnk,mkc->mnc", _weights(along), points), passed[:, -1]


def _bezier(points: Array, s: Array) -> Array:
    """Places (n, 3) of a cubic Bezier curve at its parameter (n)."""
    return _weights(s) @ points


def _weights(s: Array) -> Array:
    """How much each of its four points counts (..., 4) at a cubic Bezier curve's parameter (...)."""
    r = 1.0 - s
    return np.stack([r**3, 3.0 * r**2 * s, 3.0 * r * s**2, s**3], axis=-1)
