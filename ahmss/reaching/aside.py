"""Points of an arm kept out of things from frame to frame: by how much they are to be moved aside together, softly.

What comes next is guessed, so the points of several frames are looked at in one: where any of them would be in a
thing, all are moved along the shortest way out of it, and come back as soon as there is room. Three lags one after the
other make that a movement which begins and ends softly; the frames that are looked ahead are as many as it takes.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence

import numpy as np
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from ahmss.body.array import Array
from ahmss.motion.easing import minimum_jerk
from ahmss.reaching.prism import Prism, clearance

__all__ = ["AIR", "Aside", "kept_aside", "nearest", "ramp"]

AIR = 0.025
"""Metres between skin and things."""


_MOST = 0.22  # metres that an arm is moved at the most
_LAG = 0.07  # seconds of each of the lags
_COMES_BACK = 0.97  # of what an arm was to be moved by, what is left a frame later where there is room
_ROUNDS = 4  # of moving them out of one thing after the other
_BEFORE, _SOFT, _BEGINS = 16, 6.0, 24  # frames by which a known way goes aside sooner, over which softly, at first
_SPARSE = 3  # every so many frames of a known way are looked at
_ENOUGH, _STILL = 5e-4, 1e-5  # metres
_LEVEL = 0.3  # of a way out that is more upright than that
_FACES_IT = 0.3  # of a way out, what is less to the side of a body's way is none: it goes head on


class Aside:
    """How far points are moved aside, from frame to frame.

    Args:
        rate: frames a second.
    """

    def __init__(self, rate: float) -> None:
        self._share = 1.0 - np.exp(-1.0 / (_LAG * rate))
        self._wanted, self._lags = np.zeros(3), np.zeros((3, 3))

    def copy(self) -> Aside:
        """The same, to go on from here otherwise."""
        other = copy.copy(self)
        other._wanted, other._lags = self._wanted.copy(), self._lags.copy()
        return other

    @property
    def moved(self) -> Array:
        """By how much they are moved now (3,), metres."""
        return self._lags[-1]

    @property
    def still(self) -> bool:
        """Whether nothing is moved, nor about to be."""
        return float(np.abs(self._lags).max()) < _STILL and float(np.abs(self._wanted).max()) < _STILL

    def step(
        self,
        prisms: Sequence[Prism],
        points: Array,
        radii: Array,
        along: Array | None = None,
        shoulder: Array | None = None,
    ) -> Array:
        """By how much points are moved in the next frame (3,).

        Args:
            prisms: the things.
            points: (n, 3) where they are and will be if nothing moves them. radii: (n,) of the skin around them.
            along: (3,) level, of length 1: the way of the body, which goes past things and not back from them.
            shoulder: (3,) of the arm that they are of, which passes a post on the same side.
        """
        self._wanted = _out_of(prisms, points, radii + AIR, _COMES_BACK * self._wanted, along, shoulder)
        towards = self._wanted
        for lag in self._lags:
            lag += self._share * (towards - lag)
            towards = lag
        return self.moved.copy()


def kept_aside(prisms: Sequence[Prism], points: Array, radii: Array) -> Array:
    """By how much points (F, n, 3), all of whose frames are known, are to be moved out of things (F, 3), at first by 0.

    Args:
        prisms: the things. points: where they would be. radii: (n,) of the skin around them.
    """
    moved = np.zeros((len(points), 3))
    if not prisms:
        return moved
    room = radii + AIR
    seen = points[::_SPARSE]
    for _ in range(_ROUNDS):
        at = seen + moved[::_SPARSE, None]
        lack = room - clearance(prisms, at, float(room.max()))
        frame, worst = np.unravel_index(int(lack.argmax()), lack.shape)
        if lack[frame, worst] < _ENOUGH:
            break
        out = nearest(prisms, at[frame, worst]).way_out(at[frame, worst])
        needed = np.repeat(np.maximum(lack.max(axis=-1), 0.0), _SPARSE)[: len(points)]
        moved += ramp(needed)[:, None] * out
    length = np.linalg.norm(moved, axis=-1, keepdims=True)
    return moved * np.minimum(1.0, _MOST / np.maximum(length, 1e-9))


def ramp(needed: Array) -> Array:
    """What is needed at frames (F,), at first 0, sooner and later than that, softly, so that it is there in time."""
    most = maximum_filter1d(needed.astype(float), 2 * _BEFORE + 1, mode="nearest")
    return minimum_jerk(np.arange(1, len(most) + 1) / _BEGINS) * gaussian_filter1d(most, _SOFT, mode="nearest")


def nearest(prisms: Sequence[Prism], point: Array) -> Prism:
    """Of prisms the one that a point (3,) is nearest to, or deepest in."""
    away = [float(prism.at_least(point[None])[0]) for prism in prisms]
    least = (np.inf, 0)
    for i in np.argsort(away, kind="stable").tolist():
        if away[i] > least[0]:  # the others are farther
            break
        least = min(least, (float(prisms[i].signed(point)), i))
    return prisms[least[1]]


def _out_of(
    prisms: Sequence[Prism],
    points: Array,
    radii: Array,
    moved: Array,
    along: Array | None = None,
    shoulder: Array | None = None,
) -> Array:
    """By how much points (n, 3) with room of such radii (n) around them are to be moved (3,), from a guess on."""
    if not prisms or not len(points):
        return moved
    most = float(radii.max())
    for _ in range(_ROUNDS):
        at = points + moved
        lack = radii - clearance(prisms, at, most)
        worst = int(lack.argmax())
        if lack[worst] < _ENOUGH:
            break
        thing = nearest(prisms, at[worst])
        out = thing.way_out(at[worst])
        out = out if along is None else _past(thing, at[worst], out, along)
        other = 0.0 if shoulder is None else _other_side(thing, at, radii, out, shoulder)
        moved = moved + (-other if 0.0 < other < _MOST else lack[worst]) * out
    return moved * min(1.0, _MOST / max(float(np.linalg.norm(moved)), 1e-9))


def _other_side(thing: Prism, points: Array, radii: Array, out: Array, shoulder: Array) -> float:
    """Metres by which points (n, 3) come out of a thing against a way out (3,), to where the shoulder (3,) is.

    0 where the way out does not lead away from the shoulder, or all of them come out sooner on that side.
    """
    if abs(float(out[2])) > _LEVEL:
        return 0.0
    across, own = thing.ring @ out[:2], float(shoulder[:2] @ out[:2])
    if own >= float(across.min()):
        return 0.0
    within = thing.signed(points) < radii
    along, room = points[within] @ out, radii[within]
    other = float((along + room).max()) - float(across.min())
    return other if other < float(across.max()) - float((along - room).min()) else 0.0


def _past(thing: Prism, point: Array, out: Array, along: Array) -> Array:
    """The way out (3,) of a thing for a point (3,) that goes along a level way (3,): to the side of that, or up."""
    aside = out - (out @ along) * along
    length = float(np.linalg.norm(aside))
    if length > _FACES_IT:
        return aside / length
    left = np.array([-along[1], along[0], 0.0])
    middle = 0.5 * (thing.ring.min(axis=0) + thing.ring.max(axis=0))
    return left if float(left[:2] @ (point[:2] - middle)) > 0.0 else -left
