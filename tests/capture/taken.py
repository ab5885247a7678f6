"""Takes without a device: what perfect sensors on a performer give."""

from __future__ import annotations

from functools import cache

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply
from ahmss.body.skeleton import UPRIGHT_WORLD, Skeleton
from ahmss.capture.config import TransmitterConfig
from ahmss.capture.performance import Performance, begun_upright
from ahmss.capture.simulator.noise import Noise, NoiseLevel
from ahmss.capture.simulator.sensors import Mounts, measure
from ahmss.capture.subject import perform
from ahmss.capture.take import Take, TakeHeader

SUBJECT = Skeleton.of(1.70, "female")
RATE = 60.0


def heading(degrees: float) -> Array:
    """A turn about the vertical."""
    return from_axis_angle(np.array([0.0, 0.0, 1.0]), np.radians(degrees))


def performed(name: str = "lift", facing_deg: float = 0.0) -> Performance:
    """One of the subject's performances, facing where it shall."""
    return turned(_performed(name), facing_deg)


@cache
def _performed(name: str) -> Performance:
    return perform(name, SUBJECT)


def turned(performance: Performance, facing_deg: float) -> Performance:
    rotations = performance.rotations.copy()
    rotations[:, 0] = multiply(heading(facing_deg), rotations[:, 0])
    return Performance(
        rotations, performance.root, performance.rate, performance.skeleton, performance.name, performance.upright
    )


def reversed_in_time(performance: Performance) -> Performance:
    """The same backwards: upright at the end."""
    first, end = performance.upright
    count = performance.frames
    return Performance(
        performance.rotations[::-1], performance.root[::-1], performance.rate, performance.skeleton, "backwards",
        (count - end, count - first),
    )  # fmt: skip


def take_of(
    performance: Performance, *, seed: int = 0, noise: NoiseLevel = "none", transmitter: TransmitterConfig | None = None
) -> tuple[Take, Mounts]:
    """What the tracker gives of it, and how the sensors sit."""
    transmitter = transmitter or TransmitterConfig()
    mounts = Mounts.askew(performance.skeleton, seed)
    rotations, positions = measure(performance, mounts, transmitter)
    if noise != "none":
        disturb = Noise(noise, seed)
        both = [disturb(*row, frame) for frame, row in enumerate(zip(rotations, positions, strict=True))]
        rotations, positions = (np.array([row[i] for row in both]) for i in (0, 1))
    w, x, y, z = transmitter.rotation.tolist()
    header = TakeHeader(origin="a test", transmitter_rotation=(w, x, y, z), transmitter_place=transmitter.position)
    count = len(rotations)
    status = np.zeros((count, 15), np.uint8)
    return Take(np.arange(count) / RATE, rotations, positions, status, RATE, header), mounts


def degrees_between(one: Array, other: Array) -> Array:
    """How far rotations are from one another."""
    return np.degrees(2.0 * np.arccos(np.clip(np.abs(np.einsum("...i,...i->...", one, other)), 0.0, 1.0)))


def standing(seconds: float) -> Performance:
    """Somebody who only stands upright."""
    rotations, root = SUBJECT.upright()
    motion = rotations[None].repeat(2, axis=0), root[None].repeat(2, axis=0)
    return begun_upright(motion, RATE, SUBJECT, seconds, "stands", going=0.1)


def upright_links(facing_deg: float) -> Array:
    return multiply(heading(facing_deg), UPRIGHT_WORLD[:15])


def inverse_mounts(mounts: Mounts) -> Array:
    """Sensor <- link, the constant of (5.1)."""
    return conjugate(mounts.rotations)
