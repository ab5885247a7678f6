"""A walk shrunk, turned and bent to where it shall go: feet that bear stay, legs are solved again (A.3.2).

The thesis takes a part's place along and across the straight line of its own way, a x + b y, and sets it along and
across the line of the way wanted, a x' + b y'. Here that line may be a curve: x' is its tangent and y' its normal where
the part is, and a is how far along it one has come. The upper body keeps its rotations against the hips, which are
turned with the line, so that bones keep their lengths.

A walk is shaped as far on as it is asked for: a hundred metres take a twentieth of a second, and the first frame is
wanted in a third of that. It is the same walk in however many parts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, maximum_filter1d
from scipy.special import erf

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.easing import minimum_jerk
from ahmss.walking.leeway import Leeway
from ahmss.walking.legs import hip_joints, reach, solve_legs
from ahmss.walking.line import Line
from ahmss.walking.nominal import Nominal
from ahmss.walking.treading import Ends, Footprints, Seen, Tread

__all__ = ["TOUCHING", "Ends", "Footprints", "Line", "Shaped", "Shaping", "shape"]

_UP = np.array([0.0, 0.0, 1.0])
TOUCHING = 3e-4  # metres
# Of a leg's length that a leg may have: of who stands, and of who walks. Straighter, it takes a knee many degrees to be
# a little longer or shorter. The clips keep to a little less than the first.
_STANDING, _STRETCH = 0.9988, 0.997
_AROUND, _SIGMA = 6, 3.0  # frames before and after in which the hips come down for a leg, and how this is smoothed
_COVERED = float(erf((_AROUND + 0.5) / (_SIGMA * np.sqrt(2.0))))  # of a frame's need, after smoothing
_MARGIN = _AROUND + round(4.0 * _SIGMA)  # frames after one that it depends on


@dataclass(frozen=True)
class Shaped:
    """The walk in the world.

    rotations (F, 15, 4), root (F, 3), ankles (F, 2, 3), feet (F, 2, 4), bearing (F, 2, 3), footprints of both feet.
    """

    rotations: Array
    root: Array
    ankles: Array
    feet: Array
    bearing: NDArray[np.bool_]
    footprints: tuple[Footprints, Footprints]


class Shaping:
    """A walk along its line, shaped as far on as it is asked for.

    Args:
        skeleton: of who walks.
        nominal: the clips, joined.
        line: the way.
        ends: where the feet stand before and where they shall stand after.
        standing: the height of the hips in standing, metres.
        leeway: by how much it is moved aside; None: not at all.
    """

    def __init__(
        self, skeleton: Skeleton, nominal: Nominal, line: Line, ends: Ends, standing: float,
        leeway: Leeway | None = None,
    ) -> None:  # fmt: skip
        self._skeleton, self._nominal = skeleton, nominal
        self._line, self._ends, self._standing, self.leeway = line, ends, standing, leeway
        frames = len(nominal.root)
        turn = _turning(nominal, line, np.arange(0.0, frames))
        seen = Seen(skeleton, nominal)
        self._treads = [Tread(skeleton, nominal, seen, line, ends, foot, turn, leeway) for foot in (0, 1)]
        self._treads[0].other, self._treads[1].other = self._treads[1], self._treads[0]
        s, ratio = line.along(nominal.root[:, 0])
        place, heading = line.course.at(s)
        across = np.stack([-np.sin(heading), np.cos(heading)], axis=-1)
        self._root = nominal.root.copy()
        self._root[:, :2] = place + self._root[:, 1:2] * across
        if leeway is not None:
            self._root[:, :2] += leeway.body
        self._root[:, 2] = standing - (standing - self._root[:, 2]) * np.minimum(ratio, 1.0)
        self._turned = heading + turn
        self._looking = _looking_ahead(line, s, heading)
        self._rotations = np.empty_like(nominal.rotations)
        self._stretch = _stretch(nominal)
        self._too_high, self._looked = np.zeros(frames), 0  # frames of which it is known whether a leg is too short
        self._made = 0

    def moved(self, leeway: Leeway) -> Shaping:
        """The same walk, moved aside."""
        return Shaping(self._skeleton, self._nominal, self._line, self._ends, self._standing, leeway)

    @property
    def frames(self) -> int:
        """How many there are, the present one included."""
        return len(self._root)

    @property
    def stands(self) -> NDArray[np.bool_]:
        """Which feet are on the ground (F, 2), right and left: all of it, at any time."""
        return self._nominal.bearing.any(axis=-1)  # pyright: ignore[reportReturnType]

    @property
    def level(self) -> Array:
        """Where the hips are on the floor (F, 2), metres: all of it, at any time."""
        return self._root[:, :2]

    def footprint(self, foot: int, frame: int) -> tuple[Array, float]:
        """Where a foot, 0 the right, stands at a frame or stood before it: the flat foot's ankle (2,) and heading."""
        tread = self._treads[foot]
        tread.until(frame + 1)
        return tread.footprints.at(frame)

    def part(self, first: int, end: int) -> Shaped:
        """The frames from `first` to the one before `end`, and the footprints known so far."""
        self._until(end)
        part = slice(first, end)
        ankles, feet = self._feet(part)
        bearing = _bearing(self._skeleton, ankles, feet) & self._nominal.bearing[part].any(axis=-1, keepdims=True)
        right, left = (tread.footprints for tread in self._treads)
        return Shaped(self._rotations[part], self._root[part], ankles, feet, bearing, (right, left))

    def _feet(self, part: slice) -> tuple[Array, Array]:
        """Both feet's ankles (F, 2, 3) and rotations (F, 2, 4)."""
        right, left = self._treads
        ankles = np.stack([right.ankles[part], left.ankles[part]], axis=1)
        return ankles, np.stack([right.feet[part], left.feet[part]], axis=1)

    def _until(self, end: int) -> None:
        """Have the frames before `end`."""
        if end <= self._made:
            return
        self._look(min(end + _MARGIN, self.frames))
        part = slice(self._made, end)
        since = max(self._made - _MARGIN, 0)
        lowered = _lowered(self._too_high[since : self._looked])
        self._root[part, 2] -= lowered[self._made - since : end - since]
        if self._looking is not None:
            _turn_head(self._rotations[part], self._looking[part])
        ankles, feet = self._feet(part)
        solve_legs(self._skeleton, self._rotations[part], self._root[part], ankles, feet)
        self._made = end

    def _look(self, end: int) -> None:
        """Have the feet before `end`, the body as it is turned over them, and how much too high it is for them."""
        if end <= self._looked:
            return
        part = slice(self._looked, end)
        for tread in self._treads:
            tread.until(end)
        ankles, _ = self._feet(part)
        rotations = self._rotations[part]
        rotations[:] = self._nominal.rotations[part]
        rotations[:, 0] = multiply(from_axis_angle(_UP, self._turned[part]), rotations[:, 0])
        self._too_high[part] = _too_high(self._skeleton, rotations[:, 0], self._root[part], ankles, self._stretch[part])
        self._looked = end


def shape(skeleton: Skeleton, nominal: Nominal, line: Line, ends: Ends, standing: float) -> Shaped:
    """The whole walk along its line; the arguments are those of Shaping."""
    shaping = Shaping(skeleton, nominal, line, ends, standing)
    return shaping.part(0, shaping.frames)


def _bearing(skeleton: Skeleton, ankles: Array, feet: Array) -> NDArray[np.bool_]:
    """Which points of the soles touch the floor (F, 2, 3)."""
    soles = np.stack([skeleton.soles, skeleton.soles * (1.0, -1.0, 1.0)])
    return (ankles[:, :, None] + rotate(feet[:, :, None], soles))[..., 2] < TOUCHING


def _stretch(nominal: Nominal) -> Array:
    """Of what share of its length a leg may be (F,)."""
    stretch = np.full(len(nominal.root), _STANDING)
    walks = np.flatnonzero(~nominal.bearing.any(axis=-1).all(axis=-1))
    if len(walks):
        stretch[walks[0] : walks[-1] + 1] = _STRETCH
    return stretch


def _turning(nominal: Nominal, line: Line, frames: Array) -> Array:
    """What the body is turned more than in the clips (F,)."""
    swinging = np.flatnonzero((~nominal.bearing.any(axis=-1)).any(axis=-1))
    if not len(swinging):
        return np.zeros(len(frames))
    begin, over = int(swinging[0]), int(swinging[-1]) + 1
    one = len(nominal.seams) < 3
    until, late = (over, begin) if one else (nominal.seams[1], nominal.seams[-2])
    early = 1.0 - minimum_jerk((frames - begin) / max(until - begin, 1))
    return line.turn_first * early + line.turn_last * minimum_jerk((frames - late) / max(over - late, 1))


def _looking_ahead(line: Line, s: Array, heading: Array) -> Array | None:
    """By how much the head is turned into a bend before the body (F,), radians; None: the way is straight."""
    _, later = line.course.at(s + 0.35)
    by = np.clip(later - heading, -0.4, 0.4)
    if np.abs(by).max() < 1e-6:
        return None
    return gaussian_filter1d(by * np.clip(s / 0.3, 0.0, 1.0), 6.0, mode="nearest")


def _turn_head(rotations: Array, by: Array) -> None:
    """Turn the heads of poses about the vertical, in place."""
    q = multiply(rotations[:, 0], rotations[:, 1])
    world = multiply(from_axis_angle(_UP, by), multiply(q, rotations[:, 2]))
    rotations[:, 2] = multiply(conjugate(q), world)


def _too_high(skeleton: Skeleton, hips: Array, root: Array, ankles: Array, stretch: Array) -> Array:
    """By how much hips are higher than that legs of such shares of their length reach their feet (F,), metres."""
    way = hip_joints(skeleton, hips, root) - ankles
    level = np.einsum("fsi,fsi->fs", way[..., :2], way[..., :2])
    allowed = np.sqrt(np.maximum((stretch * reach(skeleton))[:, None] ** 2 - level, 1e-4))
    return np.maximum(way[..., 2] - allowed, 0.0).max(axis=1)


def _lowered(over: Array) -> Array:
    """By how much the hips come down (F,), so that they do so smoothly, for what they are too high."""
    if not over.any():
        return over
    highest = maximum_filter1d(over, 2 * _AROUND + 1, mode="nearest")
    return gaussian_filter1d(highest, _SIGMA, mode="nearest") / _COVERED
