"""What feet do in a recorded motion: when they land and lift, where its performer stands, and the walks between."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from ahmss.body.array import Array
from ahmss.motion.contact import bearing, runs, speeds

__all__ = ["Landing", "Standing", "Walk", "level_speed", "steady_contacts", "walks"]

_GAP = 0.15  # seconds; a foot that bears again so soon never left
_SHORTEST = 0.1  # seconds that a foot bears at the least
_OFF = 0.01  # metres over the height at which it stands where a foot is not on the ground yet, or no longer
_HIGH = 0.025  # metres over the floor at which a foot that hardly moves is in the air nevertheless
_STEP = 0.05  # metres that some part of a foot has moved after a step
_RESTING = 0.2  # metres a second of the slowest part of a foot that rests, or turns about one of its parts
_STILL = 0.15  # metres a second of the hips of a person who stands; walking, they are never as slow
_STANDING = 0.5  # seconds of that; between small steps people are as still for shorter times
_CUT_OFF = 0.15  # the same where the recording begins or ends
_SMOOTH = 0.05  # seconds


@dataclass(frozen=True)
class Landing:
    """A foot's way through the air: 0 right, 1 left; the last frame in which it bore, the first in which it does."""

    foot: int
    lift: int
    land: int


@dataclass(frozen=True)
class Standing:
    """A stretch of standing: its first frame and the one after its last."""

    first: int
    end: int


@dataclass(frozen=True)
class Walk:
    """Landings one after the other, and the standing before and after, None where the recording begins or ends."""

    landings: tuple[Landing, ...]
    before: Standing | None
    after: Standing | None


def steady_contacts(points: Array, rate: float) -> NDArray[np.bool_]:
    """Which feet bear (F, 2), by height and speed: without short gaps, then without short touches.

    A step may be so small that the foot is never fast: all of a foot that moves to elsewhere, slowly or not, is one.

    Args:
        points: (F, 2, 3, 3) heel, ball and toe tip of the right and the left foot, the floor at z = 0.
        rate: frames a second.
    """
    frames = len(points)
    bears = np.logical_or.reduce(bearing(points.reshape(frames, 6, 3), rate).reshape(frames, 2, 3), axis=-1)
    slowest = speeds(points, rate).min(axis=-1)
    out = np.zeros_like(bears)
    for foot in range(2):
        lowest = points[:, foot, :, 2].min(axis=-1)
        joined = _joined(bears[:, foot] & (lowest < _HIGH), rate)
        for first, end in runs(slowest[:, foot] > _RESTING):
            before, after = points[max(first - 1, 0), foot], points[min(end, frames - 1), foot]
            if np.linalg.norm(after - before, axis=-1).max() > _STEP:
                joined[first:end] = False
        for first, end in runs(_joined(joined, rate)):
            if end - first >= _SHORTEST * rate or first == 0 or end == frames:
                down = first + np.flatnonzero(lowest[first:end] < np.median(lowest[first:end]) + _OFF)
                out[down[0] : down[-1] + 1, foot] = True
    return out


def _joined(bears: NDArray[np.bool_], rate: float) -> NDArray[np.bool_]:
    """Flags (F,) without short gaps inside."""
    out = bears.copy()
    for first, end in runs(~bears):
        if first > 0 and end < len(bears) and end - first < _GAP * rate:
            out[first:end] = True
    return out


def level_speed(root: Array, rate: float) -> Array:
    """How fast the hips go over the floor (F,), metres a second."""
    if len(root) < 2:
        return np.zeros(len(root))
    velocity: Array = np.asarray(np.gradient(root[:, :2], 1.0 / rate, axis=0))
    return np.linalg.norm(gaussian_filter1d(velocity, _SMOOTH * rate, axis=0, mode="nearest"), axis=-1)


def walks(contacts: NDArray[np.bool_], root: Array, rate: float) -> tuple[Walk, ...]:
    """The walks in a motion, in order; what has no landings, as bending, is none.

    Args:
        contacts: (F, 2) whether the right and the left foot bear.
        root: (F, 3) metres.
        rate: frames a second.
    """
    landings = sorted(_landings(contacts), key=lambda landing: landing.land)
    still = contacts.all(axis=1) & (level_speed(root, rate) < _STILL)
    stands = [
        Standing(a, b) for a, b in runs(still)
        if b - a >= (_CUT_OFF if a == 0 or b == len(root) else _STANDING) * rate
    ]  # fmt: skip
    out: list[Walk] = []
    before: Standing | None = None
    for after in (*stands, None):
        begin = before.end if before else 0
        between = tuple(one for one in landings if begin <= one.land and (after is None or one.land <= after.first))
        landings = landings[len(between) :]
        if between:
            out.append(Walk(between, before, after))
        elif before and after:
            after = Standing(before.first, after.end)
        before = after
    return tuple(out)


def _landings(contacts: NDArray[np.bool_]) -> list[Landing]:
    out: list[Landing] = []
    for foot in range(2):
        lift = 0
        for first, end in runs(contacts[:, foot]):
            if first > 0:
                out.append(Landing(foot, lift, first))
            lift = end - 1
    return out
