"""How smoothly joints turn: angular acceleration and jerk as they are known of real capture, and pops of one frame.

Smoothed figures hide a pop of a single frame, so pops are measured on the raw rotations.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, sosfiltfilt
from scipy.spatial.transform import Rotation, RotationSpline

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, to_rotation_vector

__all__ = ["SHORTEST", "TRIM", "JointMotion", "Pop", "angular_steps", "joint_motion", "pops", "smoothed", "worst_pop"]

SHORTEST = 0.5  # seconds of motion under which joints are not judged
TRIM = 6  # frames left out at both ends, where the filter has no past or no future

_RATE = 60.0  # joint figures are those of motion resampled to this
_CUTOFF = 10.0  # hertz, of the zero-phase filter of angular velocity
_XYZW = [1, 2, 3, 0]
_STILL = 1e-6  # radians: a joint that never turns by more from one frame to the next has no motion to resample


@dataclass(frozen=True)
class JointMotion:
    """Angular acceleration (rad/s2), its maximum and 99th percentile over joints and frames, and jerk (rad/s3)."""

    acceleration_max: float
    acceleration_p99: float
    jerk_max: float
    joint: int  # where the acceleration is largest


@dataclass(frozen=True)
class Pop:
    """The step from frame to frame that differs most from the mean of its neighbours."""

    degrees: float
    frame: int  # the step leads to this frame
    joint: int


def joint_motion(rotations: Array, rate: float, counted: int | None = None) -> JointMotion:
    """Acceleration and jerk of joints as defined for real capture.

    Resampled to 60 Hz by a rotation spline, angular velocity smoothed by a zero-phase Butterworth filter of 10 Hz,
    central differences, six frames left out at both ends. Motions shorter than half a second measure 0.

    Args:
        rotations: (frames, joints, 4) unit quaternions, parent <- child.
        rate: frames a second.
        counted: how many of the joints, the first, the percentile is of; all of them if left out.
    """
    if (len(rotations) - 1) / rate < SHORTEST:
        return JointMotion(0.0, 0.0, 0.0, 0)
    acceleration, jerk = smoothed(rotations, rate)
    size = acceleration[TRIM:-TRIM]
    return JointMotion(
        acceleration_max=float(size.max()),
        acceleration_p99=float(np.percentile(size[:, :counted], 99.0)),
        jerk_max=float(jerk[TRIM:-TRIM].max()),
        joint=int(np.unravel_index(size.argmax(), size.shape)[1]),
    )


def smoothed(rotations: Array, rate: float) -> tuple[Array, Array]:
    """The sizes of acceleration (rad/s2) and jerk (rad/s3) of joints, smoothed as `joint_motion` has it.

    Args:
        rotations: (frames, joints, 4) unit quaternions, parent <- child; at least 12 frames.
        rate: frames a second.

    Returns:
        Two arrays (steps, joints) at 60 Hz, a row for each step from a frame to the next; the outer `TRIM` rows of them
        are not to be judged.
    """
    velocity = angular_steps(_at_60(rotations, rate)) * _RATE
    smooth = sosfiltfilt(butter(2, _CUTOFF, fs=_RATE, output="sos"), velocity, axis=0)
    acceleration = np.gradient(smooth, 1.0 / _RATE, axis=0)
    jerk = np.gradient(acceleration, 1.0 / _RATE, axis=0)
    return np.linalg.norm(acceleration, axis=-1), np.linalg.norm(jerk, axis=-1)


def _at_60(rotations: Array, rate: float) -> Array:
    """The rotations at 60 Hz, each joint by a spline with continuous angular acceleration."""
    if rate == _RATE:
        return rotations
    known = np.arange(len(rotations)) / rate
    times = np.arange(int(known[-1] * _RATE + 1e-6) + 1) / _RATE
    out = np.repeat(rotations[:1], len(times), axis=0)
    turning = np.abs(angular_steps(rotations)).max(axis=(0, 2)) > _STILL
    for joint in np.flatnonzero(turning):
        spline = RotationSpline(known, Rotation.from_quat(rotations[:, joint, _XYZW]))
        out[:, joint] = spline(np.minimum(times, known[-1])).as_quat()[:, [3, 0, 1, 2]]
    return out


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
        return Pop(0.0, 0, 0)
    sizes = pops(rotations)
    step, joint = np.unravel_index(sizes.argmax(), sizes.shape)
    return Pop(float(sizes[step, joint]), int(step) + 2, int(joint))
