"""What a hand has let go falls, and comes to rest upright on what is under it.

No physics beyond that: it falls freely from where it was let go, rights itself on the way, and stops where enough of
its base is held up; nothing bounces, tips over or is pushed. The whole fall is known when it begins, so it depends on
nothing but the world at that moment and the number of the tick.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import about_z, conjugate, multiply, rotate, slerp, to_rotation_vector
from ahmss.world.solids import Solid

__all__ = ["Fall", "Standing", "fall_of"]

Standing = tuple[Solid, Array]
"""A solid and its pose (7,) in the world: what things may come to rest on."""

_GRAVITY = 9.81
_STEP = 0.02  # metres: what is at most so much above its bottom lifts a thing that was let go a little too low
_LEVEL = 0.003  # metres by which places that hold it up together may differ
_STEEP = 0.2  # least upward share of a face's normal that holds something up
_UPRIGHT = 1.0 - 1e-9  # cosine of the lean up to which a shape counts as standing upright
_NOTHING = 5e-4  # metres
_NO_TURN = 0.01  # radians
_SETTLE_S = 0.12
_TURN_S = 0.16  # for each radian that it must right itself
_SLIDE = 0.01  # metres


@dataclass(frozen=True)
class Fall:
    """One fall from a pose to another (7,), as long as it takes. solid: what falls."""

    solid: Solid
    start: Array
    end: Array
    seconds: float

    def pose(self, time: float) -> Array:
        """(7,) at so many seconds after it was let go."""
        if time >= self.seconds:
            return self.end.copy()
        share = _smooth(time / self.seconds)
        rotation = slerp(self.start[3:], self.end[3:], share)
        place = self.start[:3] + share * (self.end[:3] - self.start[:3])
        # Leaning, it reaches lower: it stays above what it comes to rest on.
        least = self.end[2] + self.solid.low[2] - float(rotate(rotation, self.solid.corners)[:, 2].min())
        if least > self.start[2]:
            least = self.start[2] + (least - self.start[2]) * _smooth(time / _SETTLE_S)
        place[2] = max(self.start[2] - 0.5 * _GRAVITY * time**2, least)
        return np.concatenate([place, rotation])


def fall_of(solid: Solid, pose: Array, others: Iterable[Standing]) -> Fall | None:
    """The fall of what is let go in a pose (7,) above these; None where it rests already.

    What hangs over an edge with its middle falls beside it. Where nothing is under it, the ground at z = 0 is; below
    that it stays.
    """
    turn = about_z(pose[3:])
    bottom = pose[2] + solid.low[2]
    under = _Under(others, pose[:2], solid, bottom + _STEP)
    base = pose[:2] + rotate(turn, np.pad(solid.base, ((0, 0), (0, 1))))[:, :2]
    shift = np.zeros(2)
    heights = under.heights(base)
    level = _rest(base, heights)
    while level is not None and (aside := _aside(base + shift, heights, level)) is not None:
        shift = shift + aside
        if np.linalg.norm(shift) > 2.0 * solid.radius:
            shift = np.zeros(2)
            break
        heights = under.heights(base + shift)
        level = _rest(base + shift, heights)
    if level is None:
        return None
    end = np.array([*(pose[:2] + shift), level - solid.low[2], *turn])
    lean = float(np.linalg.norm(to_rotation_vector(multiply(conjugate(turn), pose[3:]))))
    if np.abs(end[:3] - pose[:3]).max() < _NOTHING and lean < _NO_TURN:
        return None
    drop = max(0.0, float(pose[2] - end[2]))
    return Fall(solid, pose.copy(), end, max(math.sqrt(2.0 * drop / _GRAVITY), _SETTLE_S, _TURN_S * lean))


class _Under:
    """The faces on which a thing may come to rest, near where it was let go and not above `top`."""

    def __init__(self, others: Iterable[Standing], middle: Array, solid: Solid, top: float) -> None:
        self.top = top
        self.ground = 0.0 if top >= 0.0 else -np.inf
        reach = 3.0 * solid.radius
        found: list[Array] = [np.zeros((0, 3, 3))]
        for other, pose in others:
            if np.linalg.norm(pose[:2] - middle) > other.radius + reach or pose[2] - other.radius > top:
                continue
            # In the other's frame: what is within reach of the fall's line there is what is within reach of it here.
            line = rotate(conjugate(pose[3:]), np.array([[*(middle - pose[:2]), 0.0], [0.0, 0.0, 1.0]]))
            upright = abs(line[1, 2]) > _UPRIGHT
            far = np.zeros(len(other.boxes), bool)
            if upright:
                far = (
                    (other.boxes[:, 0, :2] > line[0, :2] + reach) | (other.boxes[:, 1, :2] < line[0, :2] - reach)
                ).any(1)
            found.append(pose[:3] + rotate(pose[3:], other.triangles[~far]))
        faces = np.concatenate(found)
        normal = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
        flat = np.abs(normal[:, 2]) > _STEEP * np.linalg.norm(normal, axis=1)
        self._faces, self._normal = faces[flat], normal[flat]

    def heights(self, points: Array) -> Array:
        """(n,) how high it is under points (n, 2), not counting what is above the top; -inf over nothing."""
        a = self._faces[:, 0]
        area = self._normal[:, 2]
        inside = np.ones((len(points), len(a)), bool)
        for i in range(3):
            p, q = self._faces[:, i, :2], self._faces[:, (i + 1) % 3, :2]
            side = (q[:, 0] - p[:, 0]) * (points[:, 1:] - p[:, 1]) - (q[:, 1] - p[:, 1]) * (points[:, :1] - p[:, 0])
            inside &= side * np.sign(area) >= -1e-9
        z = a[:, 2] - ((points[:, None] - a[:, :2]) * self._normal[:, :2]).sum(-1) / area
        z = np.where(inside & (z <= self.top), z, self.ground)
        return z.max(axis=1, initial=self.ground)


def _rest(base: Array, heights: Array) -> float | None:
    """The highest level at which what reaches it holds the middle of the base (n, 2), its first point; None: none."""
    for level in np.unique(heights[np.isfinite(heights)])[::-1]:
        held = heights > level - _LEVEL
        if held[0] or _around(base[held] - base[0]):
            return float(level)
    return None


def _around(arms: Array) -> bool:
    """Whether the origin is among these points (n, 2): no half of the directions is free."""
    angles = np.sort(np.arctan2(arms[:, 1], arms[:, 0]))
    gaps = np.diff(np.append(angles, angles[0] + 2.0 * np.pi))
    return bool(gaps.max() < np.pi + 1e-3)


def _aside(base: Array, heights: Array, level: float) -> Array | None:
    """A step (2,) away from what stands above the level at which it would rest; None where nothing does."""
    above = heights > level + _LEVEL
    if not above.any():
        return None
    away = base[0] - base[above].mean(axis=0)
    size = float(np.linalg.norm(away))
    return _SLIDE * away / size if size > 1e-9 else None


def _smooth(share: float) -> float:
    """0 to 1 without a jump in speed."""
    share = min(1.0, max(0.0, share))
    return share * share * (3.0 - 2.0 * share)
