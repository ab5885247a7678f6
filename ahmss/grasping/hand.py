"""A hand as what touches: balls along its fingers and in its palm, and how they move as the fingers bend.

All in the hand's frame: x along the hand, the palm towards -y of the right hand and +y of the left, the thumb -z. A
finger bends within a plane of x and the palm's direction; the thumb within a plane through x that is turned about it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import IDENTITY, between, conjugate, cross, from_axis_angle, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.grasping.field import Solid

__all__ = ["ALONG", "BALLS", "FINGERS", "Hand", "Thumb"]

FINGERS = ("index", "middle", "ring", "little")
SEGMENTS = ("proximal", "intermediate", "distal")
BALLS = 7  # balls along a link
ALONG = np.linspace(0.0, 1.0, BALLS)
ROOT = np.interp(
    ALONG, [0.0, 0.3, 0.5], [1.5, 1.15, 1.0]
)  # a first link's radius along it, of its own: the web is there
THUMB_ROOT = np.interp(ALONG, [0.0, 0.4, 0.7], [1.3, 1.25, 1.0])  # the same of the thumb
TIP = np.interp(ALONG, [0.0, 0.6, 0.8, 1.0], [1.0, 1.0, 0.93, 0.65])  # a last link's radius along it, of its own
LENGTH = 0.095  # metres of the hand of which the palm's balls were taken
# Along the hand, out of the palm, to the little finger's side; the skin there is as far out as the palm's middle is, or
# further: the middle in a line across, before the fingers, the fingers' roots, the balls of thumb and little finger,
# the web.
PALM = np.array([
    [0.076, 0.0, -0.022], [0.076, 0.0, -0.0019], [0.076, 0.0, 0.02],
    [0.0845, -0.0015, -0.024], [0.0845, -0.0015, -0.004], [0.0845, -0.0015, 0.0165],
    [0.093, 0.0, -0.0247], [0.093, 0.0, -0.0057], [0.093, 0.0, 0.0133],
    [0.030, 0.0095, -0.015], [0.046, 0.0105, -0.022], [0.034, 0.004, 0.02],
    [0.063, 0.0048, -0.029], [0.0705, 0.003, -0.0275],
])  # fmt: skip
X = np.array([1.0, 0.0, 0.0])


@dataclass(frozen=True)
class Thumb:
    """Where thumbs are: radians from along the hand, of their plane from out of the palm, and of the end's bend."""

    out: Array
    rise: Array
    bend: Array


@dataclass(frozen=True)
class Hand:
    """Lengths and radii of one hand, metres, in the hand's frame.

    roots: (4, 3) of the fingers. lengths, radii: (4, 3) of their links. thumb_root: (3,). thumb_lengths, thumb_radii:
    (2,). palm: (B, 3) middles of the palm's balls; palm_radius: of each. grip: (7,) the palm's frame.
    """

    side: str
    roots: Array
    lengths: Array
    radii: Array
    thumb_root: Array
    thumb_lengths: Array
    thumb_radii: Array
    palm: Array
    palm_radius: float
    grip: Array

    @classmethod
    def of(cls, skeleton: Skeleton, side: str) -> Hand:
        """The `"right"` or `"left"` hand of a human."""
        links = np.array([[INDEX[f"{side}_{finger}_{segment}"] for segment in SEGMENTS] for finger in FINGERS])
        thumb = np.array([INDEX[f"{side}_thumb_proximal"], INDEX[f"{side}_thumb_distal"]])
        hand = INDEX[f"{side}_hand"]
        scale = float(skeleton.tips[hand][0]) / LENGTH
        return cls(
            side, skeleton.offsets[links[:, 0]], skeleton.tips[links][..., 0], skeleton.radii[links],
            skeleton.offsets[thumb[0]], skeleton.tips[thumb][:, 0], skeleton.radii[thumb],
            scale * PALM * np.array([1.0, -1.0 if side == "right" else 1.0, 1.0]),
            float(abs(skeleton.grips[0][1])), skeleton.grips[0 if side == "right" else 1],
        )  # fmt: skip

    @property
    def towards(self) -> float:
        """The sign of y on the palm's side."""
        return -1.0 if self.side == "right" else 1.0

    def finger_balls(self, flexion: Array) -> tuple[Array, Array]:
        """Middles (..., 4, 3, BALLS, 3) of the balls along the fingers' links, and their radii (4, 3, BALLS).

        Args:
            flexion: (..., 4, 3) radians at knuckle, middle and end joint.
        """
        bent = np.cumsum(flexion, axis=-1)
        along = np.stack([np.cos(bent), self.towards * np.sin(bent), np.zeros_like(bent)], axis=-1)
        along = along * self.lengths[..., None]
        starts = self.roots[:, None] + np.cumsum(along, axis=-2) - along
        radii = np.repeat(self.radii[..., None], BALLS, axis=-1)
        radii[:, 0] *= ROOT
        radii[:, 2] *= TIP
        return starts[..., None, :] + ALONG[:, None] * along[..., None, :], radii

    def thumb_balls(self, thumb: Thumb) -> tuple[Array, Array]:
        """Middles (..., 2, BALLS, 3) of the balls along the thumb's two links, and their radii (2, BALLS)."""
        bent = np.stack([thumb.out, thumb.out - thumb.bend], axis=-1)
        along = self._thumb_along(bent, thumb.rise[..., None]) * self.thumb_lengths[:, None]
        starts = self.thumb_root + np.cumsum(along, axis=-2) - along
        radii = np.repeat(self.thumb_radii[:, None], BALLS, axis=-1)
        radii[0] *= THUMB_ROOT
        radii[1] *= TIP
        return starts[..., None, :] + ALONG[:, None] * along[..., None, :], radii

    def _thumb_along(self, out: Array, rise: Array) -> Array:
        """Directions (..., 3) of a thumb's links."""
        level = np.sin(out) * np.cos(rise)
        return np.stack([np.cos(out), self.towards * level, -np.sin(out) * np.sin(rise)], axis=-1)

    def balls(self, rotations: Array) -> tuple[Array, Array]:
        """Middles (..., 14, BALLS, 3) of the balls along links turned by (..., 14, 4), and their radii (14, BALLS)."""
        middles = np.empty((*rotations.shape[:-2], 14, BALLS, 3))
        radii = np.empty((14, BALLS))
        thumb, others = _chains(self.side)
        ends = (THUMB_ROOT, TIP), (ROOT, 1.0, TIP)
        roots, lengths = (self.thumb_root[None], self.roots), (self.thumb_lengths[None], self.lengths)
        wide = self.thumb_radii[None], self.radii
        for chain, of_ends, start, length, radius in zip((thumb, others), ends, roots, lengths, wide, strict=True):
            turned = np.broadcast_to(IDENTITY, (len(chain), 4))
            for i, end in enumerate(of_ends):  # all fingers at once
                links = chain[:, i]
                turned = multiply(turned, rotations[..., links, :])
                along = rotate(turned, length[:, i, None] * X)
                middles[..., links, :, :] = start[..., None, :] + ALONG[:, None] * along[..., None, :]
                radii[links] = radius[:, i, None] * end
                start = start + along
        return middles, radii

    def depth(self, solid: Solid, palms: Array, rotations: Array) -> float:
        """How deep the skin of fingers (F, 14, 4) is in a solid at the worst, metres, negative where all is outside.

        Args:
            solid: in the object's frame.
            palms: (F, 7) the palm's frames there.
            rotations: (F, 14, 4) of the fingers.
        """
        return -float(self.gaps(solid, palms, rotations).min())

    def gaps(self, solid: Solid, palms: Array, rotations: Array) -> Array:
        """Metres (F, 14) between the skin of each link and a solid, negative within; arguments as of `depth`."""
        middles, radii = self.balls(rotations)
        q_object_hand = multiply(palms[:, 3:], conjugate(self.grip[3:]))
        places = palms[:, :3] - rotate(q_object_hand, self.grip[:3])
        seen = places[:, None, None] + rotate(q_object_hand[:, None, None], middles)
        return (solid.clearance(seen) - radii).min(axis=-1)

    def openings(self, rotations: Array) -> Array:
        """Metres (F, 4) between the tips of the thumb and each finger, the index first, of rotations (F, 14, 4)."""
        middles, _ = self.balls(rotations)
        return np.linalg.norm(middles[:, 4::3, -1] - middles[:, 1:2, -1], axis=-1)

    def palm_depth(self, solid: Solid, palms: Array) -> Array:
        """How deep the skin of the palm is in a solid, metres (F), negative outside, its frame at places (F, 7)."""
        q_object_hand = multiply(palms[:, 3:], np.broadcast_to(conjugate(self.grip[3:]), palms[:, 3:].shape))
        balls = palms[:, None, :3] + rotate(q_object_hand[:, None], self.palm - self.grip[:3])
        return self.palm_radius - solid.clearance(balls).min(axis=-1)

    def flexion(self, rotations: Array) -> Array:
        """The flexions (..., 4, 3) of the fingers of rotations (..., 14, 4), radians."""
        first = fingers(self.side)[0]
        links = [[INDEX[f"{self.side}_{finger}_{segment}"] - first for segment in SEGMENTS] for finger in FINGERS]
        own = rotations[..., np.array(links), :]
        return 2.0 * np.arctan2(self.towards * own[..., 3], own[..., 0])

    def thumb(self, rotations: Array) -> Thumb:
        """The thumb of rotations (..., 14, 4), as `rotations` turns it."""
        along = rotate(rotations[..., 0, :], X)
        rise = np.arctan2(-along[..., 2], self.towards * along[..., 1])
        bend = 2.0 * np.arccos(np.clip(np.abs(rotations[..., 1, 0]), 0.0, 1.0))
        return Thumb(np.arccos(np.clip(along[..., 0], -1.0, 1.0)), rise, bend)

    def rotations(self, flexion: Array, thumb: Thumb) -> Array:
        """Rotations (14, 4) in the order of links, for flexions (4, 3) and one thumb."""
        first = fingers(self.side)[0]
        rotations = np.empty((14, 4))
        hinge = np.array([0.0, 0.0, self.towards])
        for finger, joints in zip(FINGERS, flexion, strict=True):
            for segment, angle in zip(SEGMENTS, joints, strict=True):
                rotations[INDEX[f"{self.side}_{finger}_{segment}"] - first] = from_axis_angle(hinge, angle)
        along = self._thumb_along(thumb.out, thumb.rise)
        rotations[0] = between(X, along)
        # The end bends about the axis about which the thumb went out, back towards the fingers.
        axis = cross(X, along)
        axis = rotate(conjugate(rotations[0]), axis / np.linalg.norm(axis))
        rotations[1] = from_axis_angle(axis, -float(thumb.bend))
        return rotations


@lru_cache(maxsize=2)
def _chains(side: str) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The links (1, 2) of a thumb and (4, 3) of the fingers, counted from a hand's first."""
    first = fingers(side)[0]
    thumb = [[INDEX[f"{side}_thumb_proximal"], INDEX[f"{side}_thumb_distal"]]]
    others = [[INDEX[f"{side}_{finger}_{segment}"] for segment in SEGMENTS] for finger in FINGERS]
    return np.array(thumb) - first, np.array(others) - first
