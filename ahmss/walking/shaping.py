"""A walk shrunk, turned and bent to where it shall go: feet that bear stay, legs are solved again (A.3.2).

The thesis takes a part's place along and across the straight line of its own way, a x + b y, and sets it along and
across the line of the way wanted, a x' + b y'. Here that line may be a curve: x' is its tangent and y' its normal where
the part is, and a is how far along it one has come. A foot that has landed is fixed; the thesis lets the error at
lift-off stand, here it is spread over the swing. The upper body keeps its rotations against the hips, which are turned
with the line, so that bones keep their lengths.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.contact import runs
from ahmss.motion.easing import minimum_jerk
from ahmss.walking.course import Course
from ahmss.walking.legs import foot_frames, hip_joints, reach, solve_legs
from ahmss.walking.nominal import Nominal

__all__ = ["Ends", "Footprints", "Line", "Shaped", "shape", "sole_angles"]

_UP, _LEFT, _FORWARD = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0])
_PIVOTING = np.radians(12.0)  # a foot that turns by more while it bears pivots; by less, it errs
_LEAST = 0.35  # of a step's heel rise and strike that even the shortest keeps
_FLAT = 1e-6
_LEVEL = np.radians(0.5)
_TOUCHING = 3e-4  # metres
_STRETCH = 0.9985  # of a leg's length that a leg may have
_STEEPEST = 0.25  # of its length that a part of the way keeps at least where all of it is shrunk


@dataclass(frozen=True)
class Line:
    """The line of the way, and how far along it each part gets.

    course: the line. length: nominal, in all. first, last: where on the nominal line the start is over and the end
    begins, metres; who walks already has no start, and one clip alone is all start. start, end: by which those two are
    shrunk. turn_first, turn_last: how much the body is turned more than
    in the clips at its beginning and its end, radians.
    """

    course: Course
    length: float
    first: float
    last: float
    start: float
    end: float
    turn_first: float = 0.0
    turn_last: float = 0.0

    def along(self, x: Array) -> tuple[Array, Array]:
        """Nominal places x (...) as arc lengths (...) on the course, and by how much lengths shrink there.

        What is shrunk is shrunk more towards its outer end, so that nothing changes suddenly where parts meet.
        """
        if self.first >= self.length:
            return self.start * x, np.full(np.shape(x), self.start)
        middle = self.start * self.first
        s, ratio = middle + (x - self.first), np.ones(np.shape(x))
        if self.first > 0.0:
            way, slope = _shrunk((self.first - x) / self.first, self.start)
            before = x < self.first
            s, ratio = np.where(before, middle - self.first * way, s), np.where(before, slope, ratio)
        part = self.length - self.last
        way, slope = _shrunk((x - self.last) / part, self.end)
        after = x > self.last
        s = np.where(after, middle + (self.last - self.first) + part * way, s)
        return s, np.where(after, slope, ratio)


def _shrunk(u: Array, ratio: float) -> tuple[Array, Array]:
    """The way (...) done at shares u of a part, of `ratio` in all; outside it goes on as at its end."""
    lost = 1.0 - ratio
    mixed = float(np.clip((1.0 - _STEEPEST) / lost - 1.0, 0.0, 1.0)) if lost > 1e-9 else 1.0
    inside = np.clip(u, 0.0, 1.0)
    eased = 2.0 * (inside**3 - 0.5 * inside**4)
    slope = 1.0 - lost * ((1.0 - mixed) + mixed * 2.0 * (3.0 * inside**2 - 2.0 * inside**3))
    way = inside - lost * ((1.0 - mixed) * inside + mixed * eased)
    return way + (u - inside) * slope, slope


@dataclass(frozen=True)
class Ends:
    """Where the feet are before and after, right and left: places (2, 2) of the ankles, headings (2,)."""

    first: Array
    first_heading: Array
    last: Array
    last_heading: Array


@dataclass(frozen=True)
class Footprints:
    """Where a foot stands one time after the other: since which frames, the flat foot's ankle (n, 2) and heading (n,)."""

    since: NDArray[np.intp]
    places: Array
    headings: Array

    def at(self, frame: int) -> tuple[Array, float]:
        """The one at a frame, or before it where the foot is in the air."""
        i = int(np.searchsorted(self.since, frame, side="right")) - 1
        return self.places[i], float(self.headings[i])


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


def shape(skeleton: Skeleton, nominal: Nominal, line: Line, ends: Ends, standing: float) -> Shaped:
    """The walk along its line.

    Args:
        skeleton: of who walks.
        nominal: the clips, joined.
        line: the way.
        ends: where the feet stand before and where they shall stand after.
        standing: the height of the hips in standing, metres.
    """
    frames = np.arange(len(nominal.root))
    turn = _turning(nominal, line, frames)
    tracks = [_foot(skeleton, nominal, line, ends, foot, turn) for foot in (0, 1)]
    ankles, feet = (np.stack([track[i] for track in tracks], axis=1) for i in range(2))
    s, ratio = line.along(nominal.root[:, 0])
    place, heading = line.course.at(s)
    root = nominal.root.copy()
    across = np.stack([-np.sin(heading), np.cos(heading)], axis=-1)
    root[:, :2] = place + root[:, 1:2] * across
    root[:, 2] = standing - (standing - root[:, 2]) * np.minimum(ratio, 1.0)
    rotations = nominal.rotations.copy()
    rotations[:, 0] = multiply(from_axis_angle(_UP, heading + turn), rotations[:, 0])
    _look_ahead(rotations, line, s, heading)
    root[:, 2] -= _too_high(skeleton, rotations[:, 0], root, ankles)
    solve_legs(skeleton, rotations, root, ankles, feet)
    bearing = _bearing(skeleton, ankles, feet) & nominal.bearing.any(axis=-1, keepdims=True)
    return Shaped(rotations, root, ankles, feet, bearing, (tracks[0][2], tracks[1][2]))


def sole_angles(feet: Array) -> tuple[Array, Array]:
    """Heading without jumps and pitch (toes up), both (F, ...), of feet (F, ..., 4)."""
    ahead = rotate(feet, _FORWARD)
    return np.unwrap(np.arctan2(ahead[..., 1], ahead[..., 0]), axis=0), np.arcsin(np.clip(ahead[..., 2], -1.0, 1.0))


def _bearing(skeleton: Skeleton, ankles: Array, feet: Array) -> NDArray[np.bool_]:
    """Which points of the soles touch the floor (F, 2, 3)."""
    soles = np.stack([skeleton.soles, skeleton.soles * (1.0, -1.0, 1.0)])
    return (ankles[:, :, None] + rotate(feet[:, :, None], soles))[..., 2] < _TOUCHING


def _turning(nominal: Nominal, line: Line, frames: Array) -> Array:
    """What the body is turned more than in the clips (F,)."""
    contacts = nominal.bearing.any(axis=-1)
    lifts = [first for foot in (0, 1) for first, _ in runs(~contacts[:, foot])]
    lands = [end for foot in (0, 1) for _, end in runs(~contacts[:, foot])]
    if not lifts:
        return np.zeros(len(frames))
    one = len(nominal.seams) < 3
    begin, until = min(lifts), (max(lands) if one else nominal.seams[1])
    late, over = (min(lifts) if one else nominal.seams[-2]), max(lands)
    early = 1.0 - minimum_jerk((frames - begin) / max(until - begin, 1))
    return line.turn_first * early + line.turn_last * minimum_jerk((frames - late) / max(over - late, 1))


def _look_ahead(rotations: Array, line: Line, s: Array, heading: Array) -> None:
    """Turn the head into a bend before the body."""
    _, later = line.course.at(s + 0.35)
    by = np.clip(later - heading, -0.4, 0.4)
    if np.abs(by).max() < 1e-6:
        return
    by = gaussian_filter1d(by * np.clip(s / 0.3, 0.0, 1.0), 6.0, mode="nearest")
    q = multiply(rotations[:, 0], rotations[:, 1])
    world = multiply(from_axis_angle(_UP, by), multiply(q, rotations[:, 2]))
    rotations[:, 2] = multiply(conjugate(q), world)


def _too_high(skeleton: Skeleton, hips: Array, root: Array, ankles: Array) -> Array:
    """By how much the hips must come down (F,), metres, so that both legs reach their feet."""
    way = hip_joints(skeleton, hips, root) - ankles
    level = np.einsum("fsi,fsi->fs", way[..., :2], way[..., :2])
    allowed = np.sqrt(np.maximum((_STRETCH * reach(skeleton)) ** 2 - level, 1e-4))
    over = np.maximum(way[..., 2] - allowed, 0.0).max(axis=1)
    if not over.any():
        return over
    return gaussian_filter1d(maximum_filter1d(over, 13, mode="nearest"), 3.0, mode="nearest")


@dataclass
class _Stances:
    """A foot's times on the ground: first frames and those after the last; where the flat foot is, nominal and wanted."""

    first: NDArray[np.intp]
    end: NDArray[np.intp]
    place: Array
    heading: Array
    to: Array
    to_heading: Array


def _foot(
    skeleton: Skeleton, nominal: Nominal, line: Line, ends: Ends, foot: int, turn: Array
) -> tuple[Array, Array, Footprints]:
    """A foot's ankle (F, 3) and rotation (F, 4) in the world, and where it stands."""
    soles = skeleton.soles * (1.0, 1.0 if foot == 0 else -1.0, 1.0)
    places, world = foot_frames(skeleton, nominal.rotations, nominal.root)
    ankle = places[:, foot]
    yaw, pitch = sole_angles(world[:, foot])
    spans = runs(nominal.bearing[:, foot].any(axis=-1))
    loose = yaw.copy()
    stances = _stances(spans, ankle, yaw, pitch, soles)
    _wanted(stances, line, ends, foot, turn)
    moved = np.linalg.norm(np.diff(stances.to, axis=0), axis=-1)
    nominally = np.linalg.norm(np.diff(stances.place, axis=0), axis=-1)
    size = np.clip(moved / np.maximum(nominally, 1e-6), _LEAST, 1.0)
    carried = _carried(stances, size, ankle, (loose, yaw), pitch, soles)
    return *carried, Footprints(stances.first, stances.to, stances.to_heading)


def _stances(spans: list[tuple[int, int]], ankle: Array, yaw: Array, pitch: Array, soles: Array) -> _Stances:
    """The times on the ground; the headings of feet that do not pivot become constant, in place."""
    first, end = (np.array([span[i] for span in spans]) for i in (0, 1))
    seen = np.empty(len(spans), np.intp)
    for i, (a, b) in enumerate(spans):
        flat = np.flatnonzero(np.abs(pitch[a:b]) <= _LEVEL)
        # Fitted clips slide a little towards their ends: where a foot stands is told by how it first lies flat.
        seen[i] = b - 1 if i == len(spans) - 1 else a + (flat[0] if len(flat) else (b - a) // 2)
        if not _pivots(yaw[a:b], pitch[a:b]):
            yaw[a:b] = yaw[seen[i]]
    q = _turned(yaw[seen], pitch[seen])
    point = np.where((pitch[seen] > _FLAT)[:, None], soles[0], soles[2])
    contact = ankle[seen] + rotate(q, point)
    flat_at = contact - rotate(from_axis_angle(_UP, yaw[seen]), point)
    return _Stances(first, end, flat_at[:, :2], yaw[seen], flat_at[:, :2].copy(), yaw[seen].copy())


def _pivots(yaw: Array, pitch: Array) -> bool:
    """Whether a foot that bears turns on its toe, rather than sliding while it lies flat."""
    by = np.abs(np.diff(yaw))
    raised = pitch[1:] < -_LEVEL
    return float(by[raised].sum()) > _PIVOTING and float(by[~raised].sum()) < _PIVOTING


def _wanted(stances: _Stances, line: Line, ends: Ends, foot: int, turn: Array) -> None:
    """Where the feet shall stand: along and across the line; first and last where they are and shall be."""
    s, _ = line.along(stances.place[:, 0])
    place, heading = line.course.at(s)
    across = np.stack([-np.sin(heading), np.cos(heading)], axis=-1)
    stances.to = place + stances.place[:, 1:] * across
    stances.to_heading = stances.heading + heading + turn[stances.first]
    for i, where, wanted in ((0, ends.first, ends.first_heading), (-1, ends.last, ends.last_heading)):
        stances.to[i] = where[foot]
        off = wanted[foot] - stances.to_heading[i]
        stances.to_heading[i] += (off + np.pi) % (2.0 * np.pi) - np.pi


def _carried(
    stances: _Stances, size: Array, ankle: Array, yaws: tuple[Array, Array], pitch: Array, soles: Array
) -> tuple[Array, Array]:
    """The foot as it bears where it shall, and between by both its footsteps at once, the one passing into the other."""
    frames = np.arange(len(ankle))
    before = np.searchsorted(stances.first, frames, side="right") - 1
    bears = frames < stances.end[before]
    after = np.minimum(before + (~bears), len(stances.first) - 1)
    lift, land = stances.end[before] - 1, stances.first[after]
    u = np.where(bears, 0.0, (frames - lift) / np.maximum(land - lift, 1))
    share = minimum_jerk(u)
    sizes = np.concatenate([[1.0], size, [1.0]])
    own = np.where(bears, np.where(pitch > 0.0, sizes[before], sizes[before + 1]), sizes[before + 1])
    tilted = np.arcsin(own * np.sin(pitch))
    turn = stances.to_heading - stances.heading
    loose, yaw = yaws
    fixed = yaw - loose
    yaw = np.where(bears, yaw, loose + (1.0 - share) * fixed[lift] + share * fixed[land])
    heading = yaw + (1.0 - share) * turn[before] + share * turn[after]
    feet = _turned(heading, tilted)

    height = -soles[0, 2]
    level = height * np.cos(tilted) + own * (ankle[:, 2] - height * np.cos(pitch))
    nominal = ankle.copy()
    exact = _rolled(stances.place, stances.heading, before, yaw, pitch, soles)
    nominal[bears, :2] = exact[bears, :2]
    swings = ~bears
    for at, weight in ((lift, 1.0 - share), (land, share)):
        nominal[swings, :2] += (weight[:, None] * (exact[at] - ankle[at])[:, :2])[swings]
    low, high = _moved(nominal, stances, turn, before), _moved(nominal, stances, turn, after)
    out = np.empty_like(ankle)
    out[:, :2] = (1.0 - share)[:, None] * low + share[:, None] * high
    out[:, 2] = level
    standing = _rolled(stances.to, stances.to_heading, before, heading, tilted, soles)
    # A foot that rolls less than in the clip leaves and lands a little elsewhere: that too is spread over the swing.
    spread = np.zeros_like(ankle)
    for at, weight in ((lift, 1.0 - share), (land, share)):
        spread += weight[:, None] * (standing - np.c_[low, level])[at]
    out += spread
    out[bears] = standing[bears]
    sunk = -(out[:, None] + rotate(feet[:, None], soles))[..., 2].min(axis=-1)
    out[:, 2] += np.maximum(sunk, 0.0)
    return out, feet


def _rolled(place: Array, heading: Array, which: NDArray[np.intp], yaw: Array, pitch: Array, soles: Array) -> Array:
    """The ankle (F, 3) of a foot that bears, turned about its heel while its toes are up, else about its toes."""
    flat = np.concatenate([place[which], np.full((len(which), 1), -soles[0, 2])], axis=1)
    toe = flat + rotate(from_axis_angle(_UP, heading[which]), soles[2])
    heel = toe - rotate(from_axis_angle(_UP, yaw), soles[2] - soles[0])
    q = _turned(yaw, pitch)
    on_heel = (pitch > _FLAT)[:, None]
    return np.where(on_heel, heel - rotate(q, soles[0]), toe - rotate(q, soles[2]))


def _moved(nominal: Array, stances: _Stances, turn: Array, which: NDArray[np.intp]) -> Array:
    """Places (F, 2) as the footstep `which` (F,) brings them from where it is in the clip to where it shall be."""
    cos, sin = np.cos(turn[which]), np.sin(turn[which])
    d = nominal[:, :2] - stances.place[which]
    return stances.to[which] + np.stack([cos * d[:, 0] - sin * d[:, 1], sin * d[:, 0] + cos * d[:, 1]], axis=-1)


def _turned(yaw: Array, pitch: Array) -> Array:
    """Rotations (..., 4) of feet with a heading and a pitch."""
    return multiply(from_axis_angle(_UP, yaw), from_axis_angle(_LEFT, -pitch))
