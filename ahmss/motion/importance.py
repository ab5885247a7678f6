"""How much each joint of a motion matters, derived from the motion itself.

Importance decides whose rotation a joint takes where motions are fused (Ichiguchi 2000, eq. 4.11). The thesis sets it
by hand; here it follows from how far a joint moves what it carries:

    s = rho sqrt(theta^2 + (tau omega)^2),    importance = s^2 / (s^2 + s_0^2)

theta is how far the joint has turned from where it is in a person who just stands, omega how fast it turns, rho the
radius of gyration about the joint of the mass that it carries, in the pose of the frame. So s is how far the joint has
moved what it carries, or will have within tau at this speed: metres, root mean square over the mass. At s_0 the
importance is a half. A joint that holds what it has reached goes on to matter; one that rests where it always rests
does not. For the root, which carries all, s = sqrt(h^2 + (tau v)^2): its speed, and how far it is below standing.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.ndimage import gaussian_filter1d

from ahmss.body.array import Array
from ahmss.body.floor_frame import floor_frame
from ahmss.body.kinematics import forward
from ahmss.body.links import LINKS, PARENTS
from ahmss.body.quaternion import conjugate, multiply, norm, rotate, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.motion.clip import Clip
from ahmss.motion.smoothness import angular_steps

__all__ = ["derive", "importance_of"]

_TAU = 0.25  # seconds: how far ahead a speed counts
_HALF = 0.05  # metres, s_0
_SMOOTH = 0.1  # seconds, the standard deviation of the Gaussian that smooths over frames


def derive(clip: Clip, skeleton: Skeleton) -> Clip:
    """The clip with the importance that its motion has; of keyframes the postures alone count, not their speed."""
    rate = clip.rate if clip.header.times is None else None
    return replace(clip, importance=importance_of(skeleton, clip.rotations, clip.root, rate))


def importance_of(skeleton: Skeleton, rotations: Array, root: Array, rate: float | None) -> Array:
    """The importance (F, 44) of joints and root, 0 to 1.

    Args:
        skeleton: the human's measures; its masses say what a joint carries.
        rotations: (F, 43, 4) unit quaternions, parent <- child.
        root: (F, 3) metres, the floor at z = 0.
        rate: frames a second; None for frames that are no samples of one motion (keyframes).
    """
    moved = np.empty((len(rotations), len(LINKS) + 1))
    turned, spinning = _turned(skeleton, rotations, root), _speed(angular_steps(rotations), rate)
    moved[:, :-1] = _gyration(skeleton, rotations, root) * np.hypot(turned, _TAU * spinning)
    sunk = root[:, 2] - skeleton.upright()[1][2]
    moved[:, -1] = np.hypot(sunk, _TAU * _speed(np.diff(root, axis=0), rate))
    importance = moved**2 / (moved**2 + _HALF**2)
    if rate is None:
        return importance
    return gaussian_filter1d(importance, _SMOOTH * rate, axis=0, mode="nearest")


def _turned(skeleton: Skeleton, rotations: Array, root: Array) -> Array:
    """How far joints are from just standing (F, 43), radians; the hips' heading counts for nothing."""
    standing, _ = skeleton.relaxed()
    own = rotations.copy()
    own[:, 0] = multiply(conjugate(floor_frame(rotations, root)[1]), rotations[:, 0])
    return np.linalg.norm(to_rotation_vector(multiply(conjugate(standing), own)), axis=-1)


def _speed(steps: Array, rate: float | None) -> Array:
    """The size (F, ...) of steps (F - 1, ..., 3), a second; the mean of the steps before and after each frame."""
    size = np.linalg.norm(steps, axis=-1) * (rate or 0.0)
    padded = np.concatenate([size[:1], size, size[-1:]]) if len(size) else np.zeros((2, *size.shape[1:]))
    return 0.5 * (padded[1:] + padded[:-1])


def _gyration(skeleton: Skeleton, rotations: Array, root: Array) -> Array:
    """The radius of gyration of what each joint carries (F, 43), metres; each link's mass lies in its middle."""
    places, world = forward(rotations, root, skeleton.offsets)
    middles = places + rotate(world, 0.5 * skeleton.tips)
    mass = np.broadcast_to(skeleton.mass, places.shape[:-1]).copy()
    first = skeleton.mass[:, None] * middles  # the moments of what each joint carries, itself included
    second = skeleton.mass * norm(middles)
    for link in range(len(LINKS) - 1, 0, -1):
        parent = PARENTS[link]
        mass[:, parent] += mass[:, link]
        first[:, parent] += first[:, link]
        second[:, parent] += second[:, link]
    inertia = second - 2.0 * np.einsum("fjc,fjc->fj", first, places) + mass * norm(places)
    return np.sqrt(np.maximum(inertia, 0.0) / mass)
