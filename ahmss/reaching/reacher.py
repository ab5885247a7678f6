"""One arm of a human, from the palm's frame in the world to the arm's joints and back."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ahmss.body.arm import Arm, Wrist, wrist_of
from ahmss.body.arm_swing import shortest
from ahmss.body.array import Array
from ahmss.body.floor_frame import floor_frame
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, rotate
from ahmss.body.skeleton import Skeleton

__all__ = ["SIDES", "Reacher", "heading_of", "seat"]

SIDES = ("right", "left")
_SPINE = INDEX["spine"]


@dataclass(frozen=True, eq=False)
class Reacher:
    """A side's arm.

    row: of the grips and targets. links: the slice of a pose's rows for upper arm, forearm and hand. sign: 1 where
    the side is left (+y), -1 where it is right.
    """

    skeleton: Skeleton
    side: str
    row: int
    links: slice
    arm: Arm
    sign: float

    @classmethod
    def of(cls, skeleton: Skeleton, side: str) -> Reacher:
        """The "right" or "left" arm of a skeleton."""
        return _made(skeleton, side)

    @property
    def other(self) -> slice:
        """The rows of the other arm."""
        first = INDEX[f"{SIDES[1 - self.row]}_upper_arm"]
        return slice(first, first + 3)

    @property
    def length(self) -> float:
        """From shoulder to wrist, metres."""
        return float(self.arm.lengths.sum())

    @property
    def shortest(self) -> float:
        """The same of an elbow bent as far as it goes."""
        return shortest(self.arm)

    def hand(self, grip: Array) -> tuple[Array, Array]:
        """The hand link's place (..., 3) and rotation (..., 4) for palms (..., 7) in the world."""
        own = self.skeleton.grips[self.row]
        rotation = multiply(grip[..., 3:7], conjugate(own[3:]))
        return grip[..., :3] - rotate(rotation, own[:3]), rotation

    def wrist(self, grip: Array, spine: tuple[Array, Array]) -> Wrist:
        """Palms (..., 7) in the world as wrist poses of a human whose spine is there, place (..., 3), rotation."""
        return self.arm.seen(*self.hand(grip), spine)

    def palm(self, links: Array, spine: tuple[Array, Array]) -> Array:
        """The palm (..., 7) in the world of an arm (..., 3, 4) on a spine that is there."""
        wrist, turned = wrist_of(self.arm, links), multiply(spine[1], self.arm.rotation)
        rotation, own = multiply(turned, wrist.rotation), self.skeleton.grips[self.row]
        place = self.shoulder(spine) + rotate(turned, wrist.place) + rotate(rotation, own[:3])
        return np.concatenate([place, multiply(rotation, own[3:])], axis=-1)

    def missing(self, grip: Array, spine: tuple[Array, Array]) -> Array:
        """Metres (...) that the arm is too short, or, negative, that its elbow bends too little, for palms (..., 7)."""
        far = np.asarray(np.linalg.norm(self.hand(grip)[0] - self.shoulder(spine), axis=-1), np.float64)
        return far - np.clip(far, self.shortest, self.length)

    def shoulder(self, spine: tuple[Array, Array]) -> Array:
        """The shoulder's place (..., 3) in the world."""
        return spine[0] + rotate(spine[1], self.arm.place)


@lru_cache(maxsize=16)
def _made(skeleton: Skeleton, side: str) -> Reacher:
    first = INDEX[f"{side}_upper_arm"]
    sign = 1.0 if side == "left" else -1.0
    return Reacher(skeleton, side, SIDES.index(side), slice(first, first + 3), Arm.of(skeleton, side), sign)


def seat(skeleton: Skeleton, rotations: Array, root: Array) -> tuple[Array, Array]:
    """The spine link's place (..., 3) and rotation (..., 4) in the world, of poses (..., 43, 4) and roots (..., 3)."""
    hips = rotations[..., 0, :]
    place = root + rotate(hips, np.broadcast_to(skeleton.offsets[_SPINE], root.shape))
    return place, multiply(hips, rotations[..., _SPINE, :])


def heading_of(rotations: Array, root: Array) -> float:
    """Where the hips of a pose (43, 4), (3,) face, radians."""
    _, turned = floor_frame(rotations, root)
    return float(2.0 * np.arctan2(turned[3], turned[0]))
