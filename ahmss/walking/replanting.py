"""Feet that stand again in a clip whose joints were corrected at its ends: legs solved onto footprints.

The feet keep the way that they had before the correction, each stance moved and turned on the floor as a whole: onto
where the clip's first or last pose has the foot, if it stands in one of them. In the air a foot passes from the one to
the next. By how much it is tilted or lifted differently in the end poses fades soon.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from ahmss.body.array import Array
from ahmss.body.inverse import LEFT_FOOT, RIGHT_FOOT, solve
from ahmss.body.links import INDEX, LINKS
from ahmss.body.quaternion import conjugate, from_axis_angle, from_rotation_vector, multiply, rotate, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.motion.contact import foot_points, runs, speeds
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.planting import feet
from ahmss.walking.fitting import close_onto_mirror, close_speeds
from ahmss.walking.library import BODY, RATE, WalkClip

__all__ = ["closed", "replanted", "touching", "whole"]

_UP = np.array([0.0, 0.0, 1.0])
_FORWARD = np.array([1.0, 0.0, 0.0])
_MIRROR = np.array([1.0, -1.0, 1.0])
_LOWEST = 0.008  # metres over its lowest part at which another part of a foot counts little
_FADE = 0.12  # seconds in which what differs in an end pose fades
_TOUCHING = 0.004  # metres over the lowest part within which a part of a foot that stands bears
_RESTING = 0.12  # metres a second, the same for its speed
_STRETCH = 0.995  # of a leg's length that a leg may ask for
_STRAIGHT = 0.9994  # the same for one that was straighter
_EASE = 0.1  # seconds over which hips go lower for a leg that is too short
_LEGS = [[INDEX[f"{side}_{link}"] for link in ("upper_leg", "lower_leg", "foot")] for side in ("right", "left")]


class _Feet(NamedTuple):
    """A foot's way, F frames: rotations (F, 4), world; headings (F,); lowest (F,) how high its lowest part is.

    About pivots (F, 3) it rolls: the mean of its parts, the lower the weightier; the same in its own frame.
    """

    rotations: Array
    headings: Array
    lowest: Array
    pivots: Array
    own_pivots: Array
    ankles: Array

    @property
    def places(self) -> Array:
        """Where the ankle would be, level (F, 2), if the foot lay flat: it stays while the foot rolls."""
        return self.pivots[:, :2] - _turned(self.own_pivots[:, :2], self.headings)


class _Carry(NamedTuple):
    """A stance, frames first to before end, turned about a place by an angle and brought to another place (2,)."""

    first: int
    end: int
    turn: float
    origin: Array
    place: Array


def whole(skeleton: Skeleton, rotations: Array) -> Array:
    """Poses (F, 15, 4) with fingers, relaxed: (F, 43, 4)."""
    out = np.empty((len(rotations), len(LINKS), 4))
    out[:] = skeleton.relaxed()[0]
    out[:, :BODY] = rotations
    return out


def touching(skeleton: Skeleton, rotations: Array, root: Array, contacts: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which parts (F, 2, 3) of feet that stand (F, 2) bear: those on the ground and at rest, at least the slowest."""
    points = foot_points(skeleton, whole(skeleton, rotations), root)
    heights, speed = points[..., 2], speeds(points, RATE)
    low = heights < np.maximum(heights.min(axis=-1, keepdims=True), 0.0) + _TOUCHING
    slowest = speed == np.where(low, speed, np.inf).min(axis=-1, keepdims=True)
    return contacts[..., None] & low & ((speed < _RESTING) | slowest)


def replanted(skeleton: Skeleton, own: WalkClip, fitted: WalkClip) -> WalkClip:
    """The fitted clip with feet that stand; its first and last pose stay as they are.

    Args:
        skeleton: whose legs.
        own: the clip before it was fitted, its feet standing as its bearing says.
        fitted: the same with other joints.
    """
    contacts = _contacts(own)
    tracks = [_track(skeleton, own, foot) for foot in range(2)]
    wanted = [_track(skeleton, fitted, foot) for foot in range(2)]
    targets = [
        _between_ends(skeleton, foot, before, after, _carries(before, after, runs(contacts[:, foot])))
        for foot, (before, after) in enumerate(zip(tracks, wanted, strict=True))
    ]
    out = _solved(skeleton, fitted, targets, contacts)
    rotations = out.rotations.copy()
    rotations[[0, -1]] = fitted.rotations[[0, -1]]
    return replace(out, rotations=rotations)


def closed(skeleton: Skeleton, cut: WalkClip) -> WalkClip:
    """A straight step closed onto its mirror image, footprints included: as wide, as long and as turned out both ways.

    Args:
        skeleton: whose legs.
        cut: from the right foot's landing to the left one's.
    """
    even = _evened(skeleton, cut)
    return replanted(skeleton, even, close_speeds(close_onto_mirror(even)))


def _evened(skeleton: Skeleton, cut: WalkClip) -> WalkClip:
    """The cut with the left foot's two prints and the right's between them made symmetrical, the hips' way as long."""
    right, left = (_track(skeleton, cut, foot) for foot in range(2))
    before, middle, after = left.places[0], right.places.mean(axis=0), left.places[-1]
    length = 0.5 * (after[0] - before[0])
    across = 0.25 * (before[1] + after[1]) - 0.5 * middle[1]
    line = 0.25 * (before[1] + after[1]) + 0.5 * middle[1]
    out = 0.25 * _wrapped(left.headings[0] + left.headings[-1]) - 0.5 * _mean_angle(right.headings)
    root = cut.root.copy()
    root[:, 1] -= line
    root[:, 0] += np.linspace(0.0, length - (root[-1, 0] - root[0, 0]), len(root))
    contacts = _contacts(cut)
    targets: list[Array] = []
    for foot, track in enumerate((right, left)):
        carries: list[_Carry] = []
        for first, end in runs(contacts[:, foot]):
            ahead, side = (length, -1.0) if foot == 0 else (2.0 * length if first else 0.0, 1.0)
            turn = _wrapped(side * out - _mean_angle(track.headings[first:end]))
            place = np.array([before[0] + ahead, side * across])
            carries.append(_Carry(first, end, turn, track.places[first:end].mean(axis=0), place))
        targets.append(_frames(skeleton, foot, track, *_carried(track, carries)))
    return _solved(skeleton, replace(cut, root=root), targets, contacts, ends=True)


def _contacts(clip: WalkClip) -> NDArray[np.bool_]:
    """Which feet bear (F, 2)."""
    return np.logical_or.reduce(clip.bearing, axis=-1)


def _track(skeleton: Skeleton, clip: WalkClip, foot: int) -> _Feet:
    frames = feet(skeleton, clip.rotations, clip.root)[:, foot]
    ankles, rotations = frames[:, :3], frames[:, 3:]
    soles = _soles(skeleton, foot)
    arms = rotate(rotations[:, None], soles)
    lowest = arms[..., 2].min(axis=-1)
    weight = np.exp(-(arms[..., 2] - lowest[:, None]) / _LOWEST)
    weight /= weight.sum(axis=-1, keepdims=True)
    own = (weight[..., None] * soles).sum(axis=1)
    return _Feet(
        rotations, _headings(rotations), ankles[:, 2] + lowest, ankles + rotate(rotations, own), own, ankles,
    )  # fmt: skip


def _carries(own: _Feet, wanted: _Feet, stances: list[tuple[int, int]]) -> list[_Carry]:
    """How stances are brought to where the corrected poses have the foot: at an end of the clip, else on the whole."""
    out: list[_Carry] = []
    for first, end in stances:
        k = slice(0, 1) if first == 0 else slice(-1, None) if end == len(own.headings) else slice(first, end)
        turn = _mean_angle(wanted.headings[k] - own.headings[k])
        origin = own.pivots[k, :2].mean(axis=0)
        place = (wanted.ankles[k] + rotate(wanted.rotations[k], own.own_pivots[k]))[:, :2].mean(axis=0)
        out.append(_Carry(first, end, turn, origin, place))
    return out


def _carried(own: _Feet, carries: list[_Carry]) -> tuple[Array, Array]:
    """By what angle the foot is turned (F,), and where its pivot goes on the floor (F, 2)."""
    frames = len(own.headings)
    turn, shift = np.zeros(frames), np.zeros((frames, 2))
    for i, carry in enumerate(carries):
        k = slice(carry.first, carry.end)
        turn[k] = carry.turn
        away = own.pivots[k, :2] - carry.origin
        shift[k] = carry.place + _turned(away, np.full(len(away), carry.turn)) - own.pivots[k, :2]
        begin = carries[i - 1].end if i else 0
        if i:
            share = minimum_jerk(np.arange(1, carry.first - begin + 1) / (carry.first - begin + 1))
            turn[begin : carry.first] = turn[begin - 1] + share * (carry.turn - turn[begin - 1])
            shift[begin : carry.first] = shift[begin - 1] + share[:, None] * (shift[carry.first] - shift[begin - 1])
        else:
            turn[: carry.first], shift[: carry.first] = carry.turn, shift[carry.first]
    if carries:
        turn[carries[-1].end :], shift[carries[-1].end :] = turn[carries[-1].end - 1], shift[carries[-1].end - 1]
    return turn, own.pivots[:, :2] + shift


def _frames(skeleton: Skeleton, foot: int, own: _Feet, turn: Array, pivots: Array) -> Array:
    """The frames (F, 7) of a foot turned by angles, its pivots brought to places (F, 2), as high as it was."""
    rotations = multiply(from_axis_angle(_UP, turn), own.rotations)
    return _placed(skeleton, foot, rotations, own.own_pivots, pivots, own.lowest)


def _between_ends(skeleton: Skeleton, foot: int, own: _Feet, wanted: _Feet, carries: list[_Carry]) -> Array:
    """The frames (F, 7) of a foot as it was, carried, but as in the corrected poses at both ends."""
    turn, pivots = _carried(own, carries)
    rotations = multiply(from_axis_angle(_UP, turn), own.rotations)
    lowest = own.lowest.copy()
    frames = len(turn)
    ends = np.array([0, -1])
    tilt = to_rotation_vector(multiply(conjugate(rotations[ends]), wanted.rotations[ends]))
    places = (wanted.ankles[ends] + rotate(wanted.rotations[ends], own.own_pivots[ends]))[:, :2]
    off = np.concatenate([places - pivots[ends], (wanted.lowest - lowest)[ends, None]], axis=1)
    away = np.arange(frames) / (_FADE * RATE)
    fading = 1.0 - minimum_jerk(np.stack([away, away[::-1]], axis=1))
    rotations = multiply(rotations, from_rotation_vector(fading @ tilt))
    off = fading @ off
    return _placed(skeleton, foot, rotations, own.own_pivots, pivots + off[:, :2], lowest + off[:, 2])


def _placed(skeleton: Skeleton, foot: int, rotations: Array, own: Array, pivots: Array, lowest: Array) -> Array:
    arms = rotate(rotations[:, None], _soles(skeleton, foot))
    ankles = -rotate(rotations, own)
    ankles[:, :2] += pivots
    ankles[:, 2] = lowest - arms[..., 2].min(axis=-1)
    return np.concatenate([ankles, rotations], axis=1)


def _solved(
    skeleton: Skeleton, clip: WalkClip, wanted: list[Array], contacts: NDArray[np.bool_], *, ends: bool = False
) -> WalkClip:
    """The clip with its feet in the frames wanted, 2 of (F, 7); hips lower where a leg would be too short.

    ends: whether its first and last pose may change too.
    """
    targets = np.zeros((len(clip.root), 5, 8))
    for row, foot in ((RIGHT_FOOT, 0), (LEFT_FOOT, 1)):
        targets[:, row, :7], targets[:, row, 7] = wanted[foot], 1.0
    root = clip.root - _lower(skeleton, clip, wanted, ends)[:, None] * _UP
    rotations = solve(skeleton, whole(skeleton, clip.rotations), root, targets)[:, :BODY]
    return replace(clip, rotations=rotations, root=root, bearing=touching(skeleton, rotations, root, contacts))


def _lower(skeleton: Skeleton, clip: WalkClip, wanted: list[Array], ends: bool) -> Array:
    """By how much hips must be lower (F,) for legs to reach; in the first and last pose only if they may change."""
    lower = np.zeros(len(clip.root))
    own = feet(skeleton, clip.rotations, clip.root)[..., :3]
    for foot, (upper, shin, ankle) in enumerate(_LEGS):
        length = float(np.linalg.norm(skeleton.offsets[shin]) + np.linalg.norm(skeleton.offsets[ankle]))
        joints = clip.root + rotate(clip.rotations[:, 0], skeleton.offsets[upper])
        stretched = np.linalg.norm(own[:, foot] - joints, axis=-1)
        most = np.maximum(_STRETCH * length, np.minimum(stretched, _STRAIGHT * length))
        away = joints - wanted[foot][:, :3]
        aside = np.minimum(np.linalg.norm(away[:, :2], axis=1), most)
        lower = np.maximum(lower, away[:, 2] - np.sqrt(most**2 - aside**2))
    wide = round(_EASE * RATE)
    over = gaussian_filter1d(maximum_filter1d(lower, 2 * wide + 1, mode="nearest"), 0.5 * wide, mode="nearest")
    at = np.arange(len(lower))
    return over if ends else over * minimum_jerk(np.minimum(at, at[::-1]) / wide)


def _soles(skeleton: Skeleton, foot: int) -> Array:
    return skeleton.soles * (_MIRROR if foot else 1.0)


def _headings(rotations: Array) -> Array:
    ahead = rotate(rotations, _FORWARD)
    return np.arctan2(ahead[..., 1], ahead[..., 0])


def _mean_angle(angles: Array) -> float:
    return float(np.angle(np.exp(1j * angles).sum()))


def _wrapped(angle: float) -> float:
    return float(np.angle(np.exp(1j * angle)))


def _turned(v: Array, angle: Array) -> Array:
    """Vectors (F, 2) turned by angles (F,)."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.stack([cos * v[:, 0] - sin * v[:, 1], sin * v[:, 0] + cos * v[:, 1]], axis=1)
