"""Arms of who walks past somebody swing less, and hang close to the body, as people keep them in who pass closely.

Two who keep their trunks apart as they pass still swing hands into the room between them. Where oneself and the others
will be is told (`ahmss.motion.way`): an arm whose swing comes near to where somebody is by then is kept in sooner, and
swings again when there is room.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import minimum_filter1d

from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import align, slerp
from ahmss.body.skeleton import Skeleton
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.edit import floor_frame
from ahmss.motion.way import known
from ahmss.walking.walkers import Walker

__all__ = ["ArmsIn"]

_SIDES = {"right": -1.0, "left": 1.0}
_BACK, _AHEAD, _ASIDE = -0.15, 0.43, 0.27  # metres, of a stature of 1.72 m: from the hips to where a palm swings
_STATURE = 1.72
_NEAR, _FAR = 0.52, 0.8  # metres from there to somebody's hips: nearer the arm is all in, farther it swings
_MOST = 0.9  # of its swing that an arm is kept from: all of it looks stiff
_SOONER = 0.6  # seconds by which it is there sooner, for it comes
_LAG = 0.13  # seconds of each of three lags one after the other, by which it comes, and goes, softly
_NONE = 1e-4  # so little it is not kept in any more


class ArmsIn:
    """How far each arm is kept in, from piece to piece of a walk.

    Args:
        skeleton: whose. rate: frames a second. sides: the arms that are one's own.
    """

    def __init__(self, skeleton: Skeleton, rate: float, sides: Sequence[str]) -> None:
        self._rate, self._sides = rate, list(sides)
        self._pose, _ = skeleton.relaxed()
        self._size = skeleton.stature / _STATURE
        self._share = 1.0 - np.exp(-1.0 / (_LAG * rate))
        self._levels = np.zeros((3, len(self._sides)))
        self._after = np.zeros((0, 3, len(self._sides)))

    def over(self, rows: Array, others: Sequence[Walker]) -> Array:
        """POSE rows (n, 260 or 272) of a walk, the first of them the next frame, past others as they are now."""
        if not self._sides or not (others or self._levels.max() >= _NONE):
            self._after = np.repeat(self._levels[None], len(rows), axis=0)
            return rows
        shares = self._followed(self._wanted(rows, others))
        if shares.max() < _NONE:
            return rows
        made = rows.copy()
        rotations = made[:, 4:176].reshape(-1, 43, 4)
        for side, share in zip(self._sides, shares.T, strict=True):
            arm = slice(INDEX[f"{side}_upper_arm"], INDEX[f"{side}_hand"] + 1)
            end = align(np.broadcast_to(self._pose[arm], rotations[:, arm].shape), rotations[:, arm])
            rotations[:, arm] = slerp(rotations[:, arm], end, share[:, None])
        made[:, 4:176] = rotations.reshape(-1, 172)
        return made

    def keep(self, count: int) -> None:
        """Of the last piece so many frames were shown: the arms go on as after these."""
        self._levels = self._after[count - 1].copy()

    def _followed(self, wanted: Array) -> Array:
        """How far arms are in (n, s), softly on their way to what is wanted (n, s)."""
        self._after = np.empty((len(wanted), *self._levels.shape))
        levels = self._levels.copy()
        for k, towards in enumerate(wanted):
            for level in levels:
                level += self._share * (towards - level)
                towards = level
            self._after[k] = levels
        self._levels = levels
        return self._after[:, -1]

    def _wanted(self, rows: Array, others: Sequence[Walker]) -> Array:
        """How far the arms shall be in at each frame (n, s), 0 to _MOST."""
        sooner = round(_SOONER * self._rate)
        own, left = _course(rows, sooner, self._rate)
        seconds = np.arange(1, len(own) + 1) / self._rate
        ahead, away = np.stack([left[:, 1], -left[:, 0]], axis=-1), np.full((len(own), len(self._sides)), np.inf)
        for other in others:
            off = (other.after(seconds) - own) / self._size
            along, across = (off * ahead).sum(axis=-1), (off * left).sum(axis=-1)
            beyond = along - np.clip(along, _BACK, _AHEAD)
            for i, side in enumerate(self._sides):
                away[:, i] = np.minimum(away[:, i], np.hypot(beyond, across - _SIDES[side] * _ASIDE))
        nearest = minimum_filter1d(away, sooner + 1, axis=0, mode="nearest", origin=-(sooner // 2))[: len(rows)]
        return _MOST * minimum_jerk((_FAR - nearest) / (_FAR - _NEAR))


def _course(rows: Array, more: int, rate: float) -> tuple[Array, Array]:
    """Where the hips are (n + more, 2) in POSE rows and will be after these, and which way is left of them there."""
    root = rows[:, 1:3]
    way = known(rows[-1, 260:]) if rows.shape[1] > 260 else None
    speed = (root[-1] - root[-2]) * rate if len(root) > 1 else np.zeros(2)
    then = Walker(root[-1], speed, way=way).after(np.arange(1, more + 1) / rate)
    _, turned = floor_frame(rows[:, 4:176].reshape(-1, 43, 4), rows[:, 1:4])
    heading = 2.0 * np.arctan2(turned[:, 3], turned[:, 0])
    left = np.stack([-np.sin(heading), np.cos(heading)], axis=-1)
    return np.concatenate([root, then]), np.concatenate([left, np.repeat(left[-1:], more, axis=0)])
