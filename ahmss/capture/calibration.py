"""From sensors to links: the constant turn of each sensor against its link (Ichiguchi 2000, 5.1 and 5.2).

A sensor sits askew on the skin. While the subject stands upright, the links' rotations are known (table 5.3), so the
sensors' readings give the turn; it does not change until a sensor slips.

Which way the subject faces is assumed too, as the thesis does: along the transmitter's x axis, unless `facing` says
otherwise. It can't be read off the sensors' rotations, whose mounts are unknown; the places of left and right sensors
tell it to a few degrees, which serves to notice a wrong assumption (docs/motion-capture.md).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, rotate
from ahmss.body.skeleton import UPRIGHT_WORLD
from ahmss.capture.stations import TRACKED
from ahmss.capture.take import Take
from ahmss.errors import DataError
from ahmss.motion.contact import runs
from ahmss.motion.resample import continuous

__all__ = [
    "RESTLESS",
    "Calibration",
    "calibrate",
    "heading_of_sensors",
    "link_rotations",
    "mean_rotation",
    "sensor_to_link",
    "spread",
    "still_stretches",
    "transmitter_heading",
]

_SENSORS = len(TRACKED)
_UP, _X = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
_HEAD, _HANDS, _FEET = TRACKED.index("head"), [5, 11], [8, 14]
_RIGHT, _LEFT = slice(3, 9), slice(9, 15)
_LONG = 1.0  # seconds of standing still that are taken
_STILL = 2.0  # degrees RMS that the sensors of one who stands still stray from their mean
RESTLESS = 1.0
"""Degrees RMS; who strays more is taken only where nobody stands stiller."""
_AS_TALL = 0.1  # metres by which stretches may differ in height that are told apart by elbows and knees
_STRAIGHTER = np.radians(4.0)  # of elbows and knees together: as straight
_HINGES = np.array([[3, 4], [9, 10], [6, 7], [12, 13]])  # arms and legs


@dataclass(frozen=True, eq=False)
class Calibration:
    """What the upright stretch of a take tells.

    sensor_to_link (15, 4): S_Q_L of (5.1), sensor <- link. stretch: first frame of the upright pose and the one after
    its last. stillness: how far the sensors strayed from their mean over it, degrees RMS. facing: the subject's
    heading there, radians in the world, as it was assumed. heading_seen: the same as the sensors' places tell it.
    others: stretches in which they stood as still and as tall, and which therefore may have been meant.
    """

    sensor_to_link: Array
    stretch: tuple[int, int]
    stillness: float
    facing: float
    heading_seen: float
    others: tuple[tuple[int, int], ...] = ()

    @property
    def doubt(self) -> float:
        """By how much the sensors' places contradict the assumed heading, radians, -pi to pi."""
        return float((self.heading_seen - self.facing + np.pi) % (2.0 * np.pi) - np.pi)


def calibrate(
    take: Take,
    posture: Array | None = None,
    stretch: tuple[int, int] | None = None,
    facing: float | None = 0.0,
) -> Calibration:
    """The turns of all sensors against their links, from the upright pose in a take.

    Args:
        take: without drop-outs in the upright stretch, or with them filled.
        posture: (15, 4) world <- link that the subject takes in it, were they to face +x; upright if left out.
        stretch: first frame of it and the one after its last; found if left out.
        facing: where the subject faces in it against the transmitter's x axis, radians to the left; None takes it
            from the places of the left and right sensors.

    Raises:
        DataError: nobody stands still in the take, or the stretch does not lie in it.
    """
    stretch, *others = still_stretches(take) if stretch is None else [_checked(take, stretch)]
    seen = heading_of_sensors(take, stretch)
    heading = seen if facing is None else transmitter_heading(take) + facing
    links = multiply(from_axis_angle(_UP, heading), UPRIGHT_WORLD[:_SENSORS] if posture is None else posture)
    sensors = take.world_rotations()[slice(*stretch)]
    return Calibration(
        sensor_to_link=sensor_to_link(mean_rotation(sensors), links),
        stretch=stretch,
        stillness=float(np.degrees(spread(take.rotations[slice(*stretch)], stretch[1] - stretch[0])[0])),
        facing=heading,
        heading_seen=seen,
        others=tuple(others),
    )


def sensor_to_link(sensors: Array, links: Array) -> Array:
    """The constant turn S_Q_L = (W_Q_S)^-1 W_Q_L (5.1).

    Args:
        sensors: (..., 4) world <- sensor while the subject stands upright.
        links: (..., 4) world <- link in that posture.
    """
    return multiply(conjugate(sensors), links)


def link_rotations(sensors: Array, turns: Array) -> Array:
    """The links' rotations W_Q_Ld = W_Q_Sd S_Q_L (5.2).

    Args:
        sensors: (..., 15, 4) world <- sensor, any frame of the take.
        turns: (15, 4) sensor <- link, of `sensor_to_link`.
    """
    return multiply(sensors, turns)


def still_stretches(take: Take) -> list[tuple[int, int]]:
    """The seconds in which the subject may have stood upright, the likeliest first; each from a frame up to another.

    Of each time that all sensors hold still the stillest second counts. Who has the head much lower over feet and hands
    than elsewhere sits, bends or reaches. How tall the others are says little: at ease one is a few centimetres less
    so than upright. But one's elbows and knees are bent then, and that the sensors' rotations tell: seen from one
    stretch, those of a straighter one are bent beyond straight. Who is as straight in several is taken where they came
    first.

    Raises:
        DataError: nobody stands still anywhere.
    """
    length = max(round(_LONG * take.rate), 2)
    strayed = np.degrees(spread(take.rotations, length)) if take.frames >= length else np.zeros(0)
    still = runs(strayed < RESTLESS) or runs(strayed < _STILL)
    if not still:
        raise DataError(
            "take", "", f"nobody stands still for {_LONG:g} s in it; stand upright and still for two seconds at the "
            "start or the end, or say where you do with --upright FROM TO"
        )  # fmt: skip
    firsts = [first + int(strayed[first:end].argmin()) for first, end in still]
    places = take.world_places()[..., 2]
    heights = np.array([_uprightness(places[first : first + length]) for first in firsts])
    tall = [(first, first + length) for first in np.array(firsts)[heights > heights.max() - _AS_TALL].tolist()]
    bent = _bent(take, tall)
    likeliest = next(i for i, bend in enumerate(bent) if bend < bent.min() + _STRAIGHTER)
    return [tall[likeliest], *tall[:likeliest], *tall[likeliest + 1 :]]


def _bent(take: Take, stretches: list[tuple[int, int]]) -> Array:
    """By how much elbows and knees together are more bent in each stretch (n,) than in the first, radians."""
    heading = from_axis_angle(_UP, heading_of_sensors(take, stretches[0]))
    sensors = np.array([mean_rotation(take.world_rotations()[slice(*stretch)]) for stretch in stretches])
    turns = sensor_to_link(sensors[0], multiply(heading, UPRIGHT_WORLD[:_SENSORS]))
    links = link_rotations(sensors, turns)
    along = rotate(conjugate(links[:, _HINGES[:, 0]]), rotate(links[:, _HINGES[:, 1]], _X))
    return np.arctan2(-along[..., 2], along[..., 0]).sum(axis=-1)


def heading_of_sensors(take: Take, stretch: tuple[int, int]) -> float:
    """The heading, radians in the world, at which the left sensors lie to the left of the right ones in a stretch."""
    places = take.world_places()[slice(*stretch)].mean(axis=0)
    x, y, _ = (places[_LEFT] - places[_RIGHT]).sum(axis=0)
    return float(np.arctan2(-x, y))


def transmitter_heading(take: Take) -> float:
    """The heading of the transmitter's x axis in the world, radians."""
    x, y, _ = rotate(np.array(take.header.transmitter_rotation), _X)
    return float(np.arctan2(y, x))


def mean_rotation(rotations: Array) -> Array:
    """The mean (..., 4) of rotations (frames, ..., 4) that lie near one another: what turns least from all of them."""
    products = np.einsum("f...i,f...j->...ij", rotations, rotations)
    return np.linalg.eigh(products)[1][..., -1]


def spread(rotations: Array, length: int) -> Array:
    """How far sensors (F, 15, 4) stray from their mean, radians RMS, in each window (F - length + 1,) of frames.

    Of unit quaternions within half a turn, the mean's length is the mean cosine of half their angle from it.
    """
    summed = np.cumsum(continuous(rotations), axis=0)
    sums = np.concatenate([summed[length - 1 : length], summed[length:] - summed[:-length]])
    squares = np.einsum("fsi,fsi->fs", sums, sums) / length**2
    return 2.0 * np.sqrt(np.maximum(1.0 - squares, 0.0).mean(axis=-1))


def _uprightness(heights: Array) -> float:
    """How high the head is over feet and hands together, metres, in heights (frames, 15)."""
    mean = heights.mean(axis=0)
    return float(2.0 * mean[_HEAD] - mean[_FEET].mean() - mean[_HANDS].mean())


def _checked(take: Take, stretch: tuple[int, int]) -> tuple[int, int]:
    first, end = stretch
    if not 0 <= first < end <= take.frames:
        asked = f"{first / take.rate:g} to {end / take.rate:g} s"
        raise DataError("take", "upright", f"{asked}; it must lie within 0 to {take.frames / take.rate:.2f} s")
    return stretch
