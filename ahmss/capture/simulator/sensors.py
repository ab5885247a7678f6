"""Sensors on a body: how each sits on its link, and what it would measure."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import IDENTITY, conjugate, multiply, normalize, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.capture.config import TransmitterConfig
from ahmss.capture.performance import Performance
from ahmss.capture.stations import TRACKED
from ahmss.motion import archive

__all__ = ["Mounts", "measure", "save_truth"]

_SENSORS = len(TRACKED)


@dataclass(frozen=True, eq=False)
class Mounts:
    """How the sensors sit: constant while the skin holds still (Ichiguchi 2000, figure 5.10).

    rotations (15, 4): link <- sensor, unit. places (15, 3): of the sensors in their links' frames, metres.
    """

    rotations: Array
    places: Array

    @classmethod
    def straight(cls) -> Mounts:
        """Sensors on the joints, turned as their links are."""
        return cls(np.tile(IDENTITY, (_SENSORS, 1)), np.zeros((_SENSORS, 3)))

    @classmethod
    def askew(cls, skeleton: Skeleton, seed: int) -> Mounts:
        """Sensors on the skin, somewhere in the middle third of each link, turned in any way."""
        random = np.random.default_rng([seed, 1])
        rotations = normalize(random.standard_normal((_SENSORS, 4)))
        along = random.uniform(1.0 / 3.0, 2.0 / 3.0, _SENSORS)
        round_it = random.uniform(-np.pi, np.pi, _SENSORS)
        out = np.stack([np.zeros(_SENSORS), np.cos(round_it), np.sin(round_it)], axis=-1)
        places = along[:, None] * skeleton.tips[:_SENSORS] + skeleton.radii[:_SENSORS, None] * out
        return cls(rotations, places)


def measure(performance: Performance, mounts: Mounts, transmitter: TransmitterConfig) -> tuple[Array, Array]:
    """What perfect sensors measure, in the transmitter's frame.

    Returns:
        rotations (F, 15, 4) unit, transmitter <- sensor, and positions (F, 15, 3) in metres.
    """
    joints, links = performance.links()
    world = joints + rotate(links, np.broadcast_to(mounts.places, joints.shape))
    to_transmitter = conjugate(transmitter.rotation)
    positions = rotate(to_transmitter, world - np.array(transmitter.position))
    return multiply(to_transmitter, multiply(links, mounts.rotations)), positions


def save_truth(path: Path, performance: Performance, mounts: Mounts, transmitter: TransmitterConfig) -> None:
    """Write what a recorder can't know: the mounting, and how the body really moved.

    The file holds sensor_to_link (15, 4), the constant of (5.1), sensor <- link; sensor_places (15, 3) in the links'
    frames, metres; transmitter (7,), place and rotation in the world; links (F, 15, 4) and joints (F, 15, 3) in the
    world; rate; upright (2,), the first frame of the still pose and the one after its last.
    """
    joints, links = performance.links()
    content = {
        "sensor_to_link": conjugate(mounts.rotations),
        "sensor_places": mounts.places,
        "transmitter": np.array([*transmitter.position, *transmitter.rotation]),
        "links": links,
        "joints": joints,
        "rate": np.float64(performance.rate),
        "upright": np.array(performance.upright),
    }
    archive.write(path, content)
