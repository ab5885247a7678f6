"""The same while it happens: hips from what stands, one frame after another, nothing of the future known."""

from __future__ import annotations

import math

import numpy as np

from ahmss.body.array import Array
from ahmss.body.inverse import LEFT_FOOT, RIGHT_FOOT, solve
from ahmss.body.quaternion import rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.planting import feet

__all__ = ["HipsOnline"]

_LOW = 0.02  # metres over the lowest part at which a part counts little
_LOWEST = 0.5  # of the weight that height gives
_SLOW = 0.3  # metres a second, the same for its speed over the ground
_PASSING = 0.03  # seconds over which the weight passes from one part to the next
_NOBODY = 1e-3  # a weight of all parts together below which the hips go on as they went
_SUNK = 5e-4  # metres that a foot may be in the floor
_ORIGIN = np.zeros(3)


class HipsOnline:
    """Hips that follow from the feet as they come: heels and balls weigh by how low and how slow they are.

    As `hips.from_standing_parts`, but causal: weights and height follow with a lag of some 30 ms, the way over the
    ground with none. A foot that would sink is lifted.

    Args:
        skeleton: the human's measures.
        rate: frames a second.
        place: (2,) where the hips are at first, metres.
    """

    def __init__(self, skeleton: Skeleton, rate: float, place: Array) -> None:
        self._skeleton, self._rate = skeleton, rate
        self._soles = np.stack([skeleton.soles, skeleton.soles * np.array([1.0, -1.0, 1.0])])
        self._share = 1.0 - math.exp(-1.0 / (_PASSING * rate))
        self._ground = np.asarray(place, float).copy()
        self._speed = np.zeros(2)
        self._weight = np.full(4, 0.25)
        self._parts: Array | None = None
        self._below = 0.0
        self._lift = np.zeros(2)  # of each foot, so that it does not sink; it fades

    def step(self, rotations: Array, frames: int = 1) -> tuple[Array, Array]:
        """The next pose on the ground.

        Args:
            rotations: (43, 4) unit quaternions, parent <- child; the hips' against the world.
            frames: how many frames after the one before: more than 1 where some were lost.

        Returns:
            rotations (43, 4), a sinking foot lifted, and root (3,), metres.
        """
        frames_of_feet = feet(self._skeleton, rotations, _ORIGIN)
        points = frames_of_feet[:, None, :3] + rotate(frames_of_feet[:, None, 3:], self._soles)
        parts = points[:, :2].reshape(4, 3)
        height = parts[:, 2] - parts[:, 2].min()
        low = np.exp(-((height / _LOW) ** 2))
        share = 1.0 - (1.0 - self._share) ** frames
        if self._parts is None:
            self._below = float((low * parts[:, 2]).sum() / low.sum())
        else:
            velocity = (parts[:, :2] - self._parts[:, :2]) * (self._rate / frames)
            slip = np.linalg.norm(velocity + self._speed, axis=1)
            slip -= slip[low > _LOWEST].min()  # somebody always stands: when all slip, the speed is what is wrong
            self._weight += share * (low * np.exp(-((slip / _SLOW) ** 2)) - self._weight)
            standing = -(self._weight[:, None] * velocity).sum(axis=0) + _NOBODY * self._speed
            self._speed = standing / (self._weight.sum() + _NOBODY)
            self._ground = self._ground + self._speed * (frames / self._rate)
            bearing = (self._weight * low) ** 2 + _NOBODY * (height == 0.0)
            self._below += share * (float((bearing * parts[:, 2]).sum() / bearing.sum()) - self._below)
        self._parts = parts
        root = np.array([*self._ground, -self._below])
        self._lift = np.maximum(self._below - points[..., 2].min(axis=-1), (1.0 - share) * self._lift)
        if self._lift.max() > _SUNK:
            rotations = self._lifted(rotations, root, frames_of_feet, self._lift)
        return rotations, root

    def _lifted(self, rotations: Array, root: Array, foot_frames: Array, lift: Array) -> Array:
        """The pose with the feet, of frames (2, 7) seen from the hips, lifted by (2,) metres."""
        targets = np.zeros((5, 8))
        targets[RIGHT_FOOT : LEFT_FOOT + 1, :7] = foot_frames
        targets[RIGHT_FOOT : LEFT_FOOT + 1, :3] += root
        targets[RIGHT_FOOT : LEFT_FOOT + 1, 2] += lift
        targets[RIGHT_FOOT : LEFT_FOOT + 1, 7] = lift > 0.0
        return solve(self._skeleton, rotations, root, targets)
