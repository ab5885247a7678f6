"""The error of a magnetic tracker (Ichiguchi 2000, table 5.2): a jitter, and a distortion of the field.

The table's second resolution of a position is printed "0.25 inch RMS at 5 feet" beside 0.05 inch at the same distance;
it is taken to be that at 15 feet, as with the accuracy.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import from_rotation_vector, multiply
from ahmss.capture.stations import TRACKED

__all__ = ["REACH", "Noise", "NoiseLevel"]

NoiseLevel = Literal["none", "resolution", "full"]

_INCH = 0.0254
_NEAR, REACH = 60.0 * _INCH, 180.0 * _INCH  # 5 feet, and 15: the end of the measurable range
_ANGLE_RESOLUTION, _ANGLE_ACCURACY = np.radians(0.1), np.radians(3.0)
_RESOLUTION = (0.05 * _INCH, 0.25 * _INCH)  # at 5 feet, at 15 feet
_ACCURACY = (1.0 * _INCH, 3.0 * _INCH)
_WAVES = 12
_SHORTEST, _LONGEST = 0.8, 3.0  # metres: metal some way off bends the field smoothly


class Noise:
    """Errors of the table, as root mean squares of the whole angle and of the whole distance.

    The jitter is drawn for every frame anew. The distortion is a smooth vector field over the room, the same as long as
    nobody moves the metal: a sum of waves of random direction, length 0.8 to 3 m, and phase.
    """

    def __init__(self, level: NoiseLevel, seed: int) -> None:
        self._level = level
        self._seed = seed
        random = np.random.default_rng([seed, 2])
        direction = random.standard_normal((_WAVES, 3))
        length = random.uniform(_SHORTEST, _LONGEST, _WAVES)
        self._waves = direction * (2.0 * np.pi / (length * np.sqrt((direction**2).sum(-1))))[:, None]
        self._phases = random.uniform(-np.pi, np.pi, _WAVES)
        # A cosine's mean square is 1/2, and six components share: the three of a turn, the three of a shift.
        self._turns = random.standard_normal((_WAVES, 6)) * np.sqrt(2.0 / (3.0 * _WAVES))

    def __call__(self, rotations: Array, positions: Array, frame: int) -> tuple[Array, Array]:
        """Rotations (15, 4) and positions (15, 3), in the transmitter's frame, as measured at a frame."""
        if self._level == "none":
            return rotations, positions
        away = np.sqrt((positions**2).sum(-1, keepdims=True))
        turn, shift = self._jitter(frame, away)
        if self._level == "full":
            field = np.cos(positions @ self._waves.T + self._phases) @ self._turns
            turn = turn + _ANGLE_ACCURACY * field[:, :3]
            shift = shift + _between(_ACCURACY, away) * field[:, 3:]
        return multiply(from_rotation_vector(turn), rotations), positions + shift

    def _jitter(self, frame: int, away: Array) -> tuple[Array, Array]:
        """Rotation vectors (15, 3) in radians and shifts (15, 3) in metres: white, the frame's own."""
        drawn = np.random.default_rng([self._seed, 3, frame]).standard_normal((len(TRACKED), 6)) / np.sqrt(3.0)
        return _ANGLE_RESOLUTION * drawn[:, :3], _between(_RESOLUTION, away) * drawn[:, 3:]


def _between(at: tuple[float, float], away: Array) -> Array:
    """A figure given at 5 and at 15 feet, at a distance in metres; on the line through both, never under none."""
    share = (away - _NEAR) / (REACH - _NEAR)
    return np.maximum(at[0] + share * (at[1] - at[0]), 0.0)
