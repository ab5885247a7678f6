"""How still feet stand: the slowest point's speed, what slides in a stance, how far a point that bears drifts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.motion.contact import LOW, SHORTEST, SLOW, bearing, runs, speeds

__all__ = ["Stance", "Support", "declared", "drifts", "found", "stances", "support"]

_TOUCHING = 0.01  # metres over the floor, or over the foot's lowest point, within which a point of a bearing foot bears


class Stance(NamedTuple):
    """A time in which a foot (0 right, 1 left) stands: its first frame, the one after its last, what it slides (m)."""

    foot: int
    first: int
    end: int
    slide: float


@dataclass(frozen=True)
class Support:
    """Speed of the slowest point of both feet (m/s), over frames; slide of each stance (m)."""

    speed_mean: float
    speed_p95: float
    slides: tuple[float, ...]

    @property
    def slide_mean(self) -> float:
        """The mean slide of a stance, metres; 0 where there is none."""
        return float(np.mean(self.slides)) if self.slides else 0.0


def support(points: Array, rate: float) -> Support:
    """How still the feet stand.

    Args:
        points: (frames, 2, 3, 3) ankle, ball and toe tip of the right and the left foot, metres; heights are those over
            where the point is when the foot stands flat.
        rate: frames a second.
    """
    either = speeds(points, rate).min(axis=(-2, -1))
    slides = tuple(stance.slide for stance in stances(points, rate))
    return Support(float(either.mean()), float(np.percentile(either, 95.0)), slides)


def stances(points: Array, rate: float) -> list[Stance]:
    """The stances of both feet, whose points (frames, 2, 3, 3) are those of `support`.

    A stance is a time of 0.1 s or longer in which a foot has a point lower than 5 cm and its slowest point is slower
    than 0.5 m/s; its slide is the way of the slowest point.
    """
    slowest = speeds(points, rate).min(axis=-1)
    stands = (points[..., 2] < LOW).any(axis=-1) & (slowest < SLOW)
    return [
        Stance(foot, first, end, float(slowest[first:end, foot].sum() / rate))
        for foot in range(2)
        for first, end in runs(stands[:, foot])
        if end - first >= max(round(SHORTEST * rate), 1)
    ]


def found(points: Array, rate: float) -> NDArray[np.bool_]:
    """Which points (frames, 2, n, 3) bear by their height and speed, (frames, 2, n)."""
    return bearing(points.reshape(len(points), -1, 3), rate).reshape(points.shape[:-1])


def declared(points: Array, contacts: Array) -> NDArray[np.bool_]:
    """Which points (frames, 2, n, 3) bear of feet that a clip's contacts (frames, 2) say to be on the ground.

    Speed is not asked for: a foot that is said to stand and slides must show. Of such a foot those points bear that are
    within 1 cm of the floor, or of its lowest point where all of it is higher.
    """
    heights = points[..., 2]
    ground = np.maximum(heights.min(axis=-1, keepdims=True), 0.0)
    return (contacts > 0.5)[..., None] & (heights <= ground + _TOUCHING)


def drifts(points: Array, bears: NDArray[np.bool_]) -> tuple[float, ...]:
    """How far each point (frames, 2, n, 3) gets from where it was set down, level, metres; each time that it bears."""
    return tuple(
        float(np.linalg.norm(points[first:last, foot, point, :2] - points[first, foot, point, :2], axis=-1).max())
        for foot in range(2)
        for point in range(points.shape[2])
        for first, last in runs(bears[:, foot, point])
    )
