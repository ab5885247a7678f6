"""The measures of each of the 23 items, and which of them are worse than real capture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ahmss.bench.acted import Acted
from ahmss.bench.capture import IN_PLACE, WALKING, Bar
from ahmss.bench.depth import Depth
from ahmss.bench.hands import off_target, slips
from ahmss.bench.survey import Span
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS
from ahmss.motion.contact import foot_points, runs, speeds
from ahmss.motion.footing import stances
from ahmss.motion.smoothness import TRIM, pops, smoothed

__all__ = ["BOUNDS", "UNITS", "Measured", "Series"]

_BODY = 15  # the first links: known captures have no fingers
_TOUCHING = 0.001  # metres over the floor within which a point of a sole is on it: ours stand exactly
_STANDS = 0.3  # seconds of a stance that must be among the frames: half of one in walking
_BALL = 1  # of a sole's points
_ONWARD = 0.05  # metres, level, that a foot is set on, and the hips go, where the body is carried on
_FEET = [INDEX["right_foot"], INDEX["left_foot"]]

UNITS = {
    "slide": "cm", "drift": "mm", "speed_p95": "m/s", "acceleration": "rad/s2", "acceleration_p99": "rad/s2",
    "jerk": "rad/s3", "pop": "deg", "hips": "m/s2", "floor": "mm", "hand": "mm", "slip": "mm", "depth": "mm",
}  # fmt: skip
"""The measures, in the order of the table."""

BOUNDS = {"drift": 1.0, "hand": 1.0, "slip": 2.0, "depth": 2.0}
"""Millimetres, of what capture can't say: what stands on the floor does not move on it, a real hand is where it is and
does not slip on a cup, and goes into nothing. These are the bounds that the system sets itself."""


@dataclass(frozen=True)
class Measured:
    """An item's measures by their names, the capture that they are compared with, and where the worst is.

    where: of acceleration the link, of depth "link in thing". pause: seconds between two actions, None for an action.
    """

    figures: dict[str, float]
    bar: Bar
    where: dict[str, str]
    pause: float | None = None

    def bound(self, name: str) -> float:
        """What a measure may be at the most."""
        return BOUNDS[name] if name in BOUNDS else float(getattr(self.bar, name))

    @property
    def worse(self) -> list[str]:
        """The measures that are worse than in real capture of the kind, or than the bounds."""
        return [name for name, value in self.figures.items() if value > self.bound(name)]


class Series:
    """A motion's measures frame by frame, so that any part of it can be judged with what is around it.

    depth: of its skin in things. floor: (F,) metres under the floor.
    """

    def __init__(self, acted: Acted, depth: Depth, floor: Array) -> None:
        rotations, root, rate = acted.rotations[:, :_BODY], acted.root, acted.rate
        frames = len(root)
        self._rate, self._depth, self._floor = rate, depth, floor
        self._acceleration, self._jerk, self._pops = (np.zeros((frames, _BODY)) for _ in range(3))
        acceleration, jerk = smoothed(rotations, rate)
        inner = slice(TRIM, len(acceleration) - TRIM)
        self._acceleration[1:][inner], self._jerk[1:][inner] = acceleration[inner], jerk[inner]
        self._pops[2:-1] = pops(rotations)
        self._hips = np.zeros(frames)
        self._hips[1:-1] = np.linalg.norm(np.diff(root, 2, axis=0), axis=-1) * rate**2
        soles = foot_points(acted.skeleton, acted.rotations, root)
        points = soles.copy()
        places, _ = forward(acted.rotations, root, acted.skeleton.offsets)
        points[:, :, 0] = places[:, _FEET]  # the ankle, as in the captures that the figures are compared with
        points[:, :, 0, 2] += acted.skeleton.soles[0, 2]
        self._speed = speeds(points, rate).min(axis=(1, 2))
        self._stances = stances(points, rate)
        self._slowest = speeds(points, rate).min(axis=-1) / rate
        self._soles = soles
        touches = soles[..., 2] < _TOUCHING
        self._touching = [(f, p, *run) for f in range(2) for p in range(3) for run in runs(touches[:, f, p])]
        self._hand, self._slip = off_target(acted), slips(acted)
        self._root, self._steps = root[:, :2], _steps(soles)

    def over(self, span: Span, pause: float | None = None) -> Measured:
        """The measures over some frames. Of a stance, or of a point on the floor, what is among them counts."""
        frames = slice(span.first, span.end)
        acceleration = self._acceleration[frames]
        deepest = span.first + int(self._depth.deepest[frames].argmax())
        figures = {
            "slide": 100.0 * self._slide(span),
            "drift": 1000.0 * self._drift(span),
            "speed_p95": float(np.percentile(self._speed[frames], 95.0)),
            "acceleration": float(acceleration.max()),
            "acceleration_p99": float(np.percentile(acceleration, 99.0)),
            "jerk": float(self._jerk[frames].max()),
            "pop": float(self._pops[frames].max()),
            "hips": float(self._hips[frames].max()),
            "floor": 1000.0 * float(self._floor[frames].max()),
            "hand": 1000.0 * float(self._hand[frames].max()),
            "slip": 1000.0 * float(self._slip[frames].max()),
            "depth": 1000.0 * float(self._depth.deepest[deepest]),
        }
        where = {
            "acceleration": LINKS[int(acceleration.max(axis=0).argmax())],
            "jerk": LINKS[int(self._jerk[frames].max(axis=0).argmax())],
            "pop": LINKS[int(self._pops[frames].max(axis=0).argmax())],
        }
        if figures["depth"] > 0.0:
            where["depth"] = f"{self._depth.link[deepest]} in {self._depth.thing[deepest]}"
        bar = WALKING if self._walks(frames) else IN_PLACE
        return Measured({name: round(value, 4) for name, value in figures.items()}, bar, where, pause)

    def _walks(self, frames: slice) -> bool:
        """Whether steps carry the body on in some frames."""
        goes = np.linalg.norm(self._root[frames] - self._root[frames.start], axis=-1).max()
        return bool(self._steps[frames].any() and goes > _ONWARD)

    def _slide(self, span: Span) -> float:
        """The mean way (m) of a foot's slowest point in a stance, of those that last for 0.3 s of the frames."""
        slides: list[float] = []
        for stance in self._stances:
            first, end = max(stance.first, span.first), min(stance.end, span.end)
            if end - first >= _STANDS * self._rate:
                slides.append(float(self._slowest[first:end, stance.foot].sum()))
        return float(np.mean(slides)) if slides else 0.0

    def _drift(self, span: Span) -> float:
        """The furthest (m) that a point of a sole gets, level, from where it came onto the floor."""
        furthest = 0.0
        for foot, point, start, stop in self._touching:
            first, end = max(start, span.first), min(stop, span.end)
            if first < end:
                way = self._soles[first:end, foot, point, :2] - self._soles[first, foot, point, :2]
                furthest = max(furthest, float(np.linalg.norm(way, axis=-1).max()))
        return furthest


def _steps(soles: Array) -> NDArray[np.bool_]:
    """In which frames (F,) a foot, of points (F, 2, 3, 3), is on its way through the air to where it did not stand."""
    out = np.zeros(len(soles), bool)
    aloft = soles[..., 2].min(axis=-1) >= _TOUCHING
    for foot in range(2):
        ball = soles[:, foot, _BALL, :2]
        for first, end in runs(aloft[:, foot]):
            stood, lands = ball[max(first - 1, 0)], ball[min(end, len(ball) - 1)]
            out[first:end] |= float(np.linalg.norm(lands - stood)) > _ONWARD
    return out
