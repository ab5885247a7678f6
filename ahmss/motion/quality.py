"""How natural a motion measures: joint acceleration and jerk, pops of one frame, and feet that slide.

The figures for real capture that these compare to stand in docs/conventions.md. Smoothed figures hide a pop of a single
frame, so pops are measured on the raw rotations.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from ahmss.body.array import Array
from ahmss.body.links import LINKS
from ahmss.body.quaternion import conjugate, multiply, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.motion.contact import bearing, foot_points, runs, speeds
from ahmss.motion.resample import interpolate_rotations

__all__ = ["JointMotion", "Pop", "Quality", "Support", "joint_motion", "measure", "pops", "support", "worst_pop"]

_RATE = 60.0  # joint figures are those of motion resampled to this
_CUTOFF = 10.0  # hertz, of the zero-phase filter of angular velocity
_TRIM = 6  # frames left out at both ends, where the filter has no past or no future


@dataclass(frozen=True)
class JointMotion:
    """Angular acceleration (rad/s2), its maximum and 99th percentile over joints and frames, and jerk (rad/s3)."""

    acceleration_max: float
    acceleration_p99: float
    jerk_max: float
    joint: int  # where the acceleration is largest


@dataclass(frozen=True)
class Support:
    """How still the feet stand: speed of the slowest foot point (m/s), slide of each stance, drift of each contact (m).

    A stance is a foot's time on the ground; a contact one bearing point's.
    """

    speed_mean: float
    speed_p95: float
    slides: tuple[float, ...]
    drifts: tuple[float, ...]

    @property
    def slide_mean(self) -> float:
        """The mean slide of a stance, metres; 0 where there is none."""
        return float(np.mean(self.slides)) if self.slides else 0.0

    @property
    def drift_max(self) -> float:
        """The longest drift of a contact, metres; 0 where there is none."""
        return max(self.drifts, default=0.0)


@dataclass(frozen=True)
class Pop:
    """The step from frame to frame that differs most from the mean of its neighbours."""

    degrees: float
    frame: int  # the step leads to this frame
    joint: str


@dataclass(frozen=True)
class Quality:
    """What `measure` found."""

    joints: JointMotion
    support: Support
    pop: Pop


def measure(rotations: Array, root: Array, rate: float, skeleton: Skeleton, contacts: Array | None = None) -> Quality:
    """Measure a motion.

    Args:
        rotations: (frames, 43, 4) unit quaternions, parent <- child; at least 3 frames.
        root: (frames, 3) metres, the floor at z = 0.
        rate: frames a second.
        skeleton: the human's measures.
        contacts: (frames, 2) right and left foot, where they are known; else they are found by height and speed.
    """
    points = foot_points(skeleton, rotations, root)
    flat = points.reshape(len(points), 6, 3)
    bears = bearing(flat, rate)
    if contacts is not None:
        bears &= np.repeat(contacts > 0.5, 3, axis=1)
    return Quality(joint_motion(rotations, rate), support(points, bears.reshape(-1, 2, 3), rate), worst_pop(rotations))


def joint_motion(rotations: Array, rate: float) -> JointMotion:
    """Acceleration and jerk of joints, rotations (frames, joints, 4), as defined for real capture.

    Resampled to 60 Hz by a spline, angular velocity smoothed by a zero-phase Butterworth filter of 10 Hz, central
    differences, the ends left out. Motions shorter than half a second measure 0.
    """
    duration = (len(rotations) - 1) / rate
    if duration < 0.5:
        return JointMotion(0.0, 0.0, 0.0, 0)
    known = np.arange(len(rotations)) / rate
    at_60 = interpolate_rotations(known, rotations, np.arange(int(duration * _RATE) + 1) / _RATE)
    velocity = angular_steps(at_60) * _RATE
    smooth = sosfiltfilt(butter(2, _CUTOFF, fs=_RATE, output="sos"), velocity, axis=0)
    acceleration = np.gradient(smooth, 1.0 / _RATE, axis=0)
    jerk = np.gradient(acceleration, 1.0 / _RATE, axis=0)
    size = np.linalg.norm(acceleration, axis=-1)[_TRIM:-_TRIM]
    return JointMotion(
        acceleration_max=float(size.max()),
        acceleration_p99=float(np.percentile(size, 99.0)),
        jerk_max=float(np.linalg.norm(jerk, axis=-1)[_TRIM:-_TRIM].max()),
        joint=int(np.unravel_index(size.argmax(), size.shape)[1]),
    )


def angular_steps(rotations: Array) -> Array:
    """What joints turn from frame to frame (frames - 1, joints, 3): rotation vectors in their own frames, radians."""
    return to_rotation_vector(multiply(conjugate(rotations[:-1]), rotations[1:]))


def pops(rotations: Array) -> Array:
    """For each inner step, by how much it differs from its neighbours' mean (frames - 3, joints), degrees."""
    steps = angular_steps(rotations)
    return np.degrees(np.linalg.norm(steps[1:-1] - 0.5 * (steps[:-2] + steps[2:]), axis=-1))


def worst_pop(rotations: Array) -> Pop:
    """The largest pop; of fewer than 4 frames, none."""
    if len(rotations) < 4:
        return Pop(0.0, 0, LINKS[0])
    sizes = pops(rotations)
    step, joint = np.unravel_index(sizes.argmax(), sizes.shape)
    return Pop(float(sizes[step, joint]), int(step) + 2, LINKS[int(joint)] if len(LINKS) > joint else str(joint))


def support(points: Array, bears: NDArray[np.bool_], rate: float) -> Support:
    """How still the feet stand.

    Args:
        points: (frames, 2, n, 3) points of the right and the left foot, metres, the floor at z = 0.
        bears: (frames, 2, n) which of them bear.
        rate: frames a second.
    """
    speed = speeds(points, rate)
    slowest = speed.reshape(len(speed), -1).min(axis=1)
    feet: Any = bears.any(axis=-1)
    slides = [
        float(speed[first:last, foot].min(axis=-1).sum() / rate)
        for foot in range(2)
        for first, last in runs(feet[:, foot])
    ]
    drifts = [
        float(np.linalg.norm(points[first:last, foot, point, :2] - points[first, foot, point, :2], axis=-1).max())
        for foot in range(2)
        for point in range(points.shape[2])
        for first, last in runs(bears[:, foot, point])
    ]
    return Support(float(slowest.mean()), float(np.percentile(slowest, 95.0)), tuple(slides), tuple(drifts))
