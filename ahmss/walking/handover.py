"""From one walk into another in mid-step: the new one takes over from the old one's continuation, little by little.

Both stand on the same feet at the seam. What the old walk would have done next and what the new one does are mixed, the
new one's share rising from 0 to 1 at no speed and no acceleration while the free foot swings: so nothing that moves
changes suddenly, be it that the walker turns in, makes a shorter step, goes slower or stops.
"""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import rotate, slerp
from ahmss.body.skeleton import Skeleton
from ahmss.motion.easing import minimum_jerk
from ahmss.walking.legs import solve_legs
from ahmss.walking.shaping import TOUCHING, Shaped, Shaping
from ahmss.walking.soles import CLEAR, rolled, sole_angles, turned

__all__ = ["Handover"]

_MIRROR = np.array([1.0, -1.0, 1.0])


class Handover:
    """The frames of a new walk, its first ones mixed with those that the old one would have had.

    Args:
        skeleton: of who walks.
        before: the old walk. seam: its frame that is the new one's frame 0.
        after: the new walk.
        frames: by which one the new one has taken over; the foot that swings must not have landed by then.
        since: the frame at which it begins to: up to there all is as it would have been.
    """

    def __init__(
        self, skeleton: Skeleton, before: Shaping | Handover, seam: int, after: Shaping, frames: int, since: int = 0
    ) -> None:
        self._skeleton, self._seam, self._after = skeleton, seam, after
        self._soles = np.stack([skeleton.soles, skeleton.soles * _MIRROR])
        self._mixed = min(frames, before.frames - seam, after.frames)
        self._before: Shaping | Handover | None = before
        self._share = minimum_jerk((np.arange(self._mixed) - since) / (frames - since))
        self._level = after.level.copy()
        share, old = self._share[:, None], before.level[seam : seam + self._mixed]
        self._level[: self._mixed] = (1.0 - share) * old + share * self._level[: self._mixed]

    @property
    def frames(self) -> int:
        """How many there are, the present one included."""
        return self._after.frames

    @property
    def level(self) -> Array:
        """Where the hips are on the floor (F, 2), metres: all of it, at any time."""
        return self._level

    def footprint(self, foot: int, frame: int) -> tuple[Array, float]:
        """Where a foot, 0 the right, stands at a frame or stood before it: the flat foot's ankle (2,) and heading."""
        return self._after.footprint(foot, frame)

    def part(self, first: int, end: int) -> Shaped:
        """The frames from `first` to the one before `end`, and the footprints known so far."""
        new = self._after.part(first, end)
        mixed = min(end, self._mixed) - first
        if self._before is None or mixed <= 0:
            self._before = None  # it is not needed any more, nor what came before it
            return new
        old = self._before.part(self._seam + first, self._seam + first + mixed)
        share = self._share[first : first + mixed]
        rotations, root, ankles, feet = (a.copy() for a in (new.rotations, new.root, new.ankles, new.feet))
        part = slice(0, mixed)
        rotations[part] = slerp(old.rotations, rotations[part], share[:, None])
        root[part] = _mixed(old.root, root[part], share)
        feet[part] = slerp(old.feet, feet[part], share[:, None])
        ankles[part] = _mixed(old.ankles, ankles[part], share)
        # Whoever's share is greater says whether a foot stands: mixed, one that stands and one that is off would drag.
        stands = np.where((share < 0.5)[:, None], old.bearing.any(axis=-1), new.bearing[part].any(axis=-1))
        bearing = new.bearing.copy()
        for foot, prints in enumerate(new.footprints):
            place, heading = prints.at(first)
            own = slice(None), foot
            yaw, pitch = sole_angles(feet[part][own])
            on = stands[:, foot]
            ankles[part][own][on] = rolled(place, heading, yaw, pitch, self._soles[foot])[on]
            feet[part][own][on] = turned(yaw, pitch)[on]
        lowest = (ankles[part, :, None] + rotate(feet[part, :, None], self._soles))[..., 2]
        ankles[part, :, 2] += np.maximum(np.where(stands, 0.0, CLEAR) - lowest.min(axis=-1), 0.0)
        bearing[part] = stands[..., None] & (lowest < TOUCHING)
        solve_legs(self._skeleton, rotations[part], root[part], ankles[part], feet[part])
        return Shaped(rotations, root, ankles, feet, bearing, new.footprints)


def _mixed(old: Array, new: Array, share: Array) -> Array:
    share = share.reshape(-1, *[1] * (old.ndim - 1))
    return (1.0 - share) * old + share * new
