"""Euler angles as trackers give them: azimuth, elevation, roll; intrinsic, about Z, Y', X''."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array

__all__ = ["from_euler", "to_euler"]


def from_euler(angles: Array) -> Array:
    """Unit quaternions (..., 4) wxyz of (..., 3) azimuth, elevation, roll in radians: q = q_z(az) q_y(el) q_x(roll)."""
    half = 0.5 * angles
    (cz, cy, cx), (sz, sy, sx) = np.moveaxis(np.cos(half), -1, 0), np.moveaxis(np.sin(half), -1, 0)
    out = np.empty((*angles.shape[:-1], 4))
    out[..., 0] = cz * cy * cx + sz * sy * sx
    out[..., 1] = cz * cy * sx - sz * sy * cx
    out[..., 2] = cz * sy * cx + sz * cy * sx
    out[..., 3] = sz * cy * cx - cz * sy * sx
    return out


def to_euler(q: Array) -> Array:
    """Azimuth, elevation, roll (..., 3) in radians of unit quaternions (..., 4).

    Elevation lies in [-pi/2, pi/2], the others in [-pi, pi]. Within 0.01 degrees of straight up or down only azimuth
    and roll together are determined; roll is 0 there.
    """
    w, x, y, z = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    sine = np.clip(2.0 * (w * y - z * x), -1.0, 1.0)
    level = np.abs(sine) < 1.0 - 1.5e-8
    azimuth = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    upright = np.arctan2(-2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z))
    roll = np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    return np.stack([np.where(level, azimuth, upright), np.arcsin(sine), np.where(level, roll, 0.0)], axis=-1)
