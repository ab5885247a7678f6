"""Feet that stand: contact by height and speed together, legs solved so that feet neither slide nor sink.

While a foot bears, it is carried by as much as its lowest part would move, part passing weight to part from heel to toe
tip. Between two stances the carrying goes over smoothly from the one to the next while the foot is in the air; it is
caught just before it lands and let go just after it leaves with the speed it has, so nothing pops. The foot keeps its
rotation, held steady only where it lies flat; hip and knee bend. Where a straight leg stands to a tenth of a millimetre
as it is, it is left alone: that much, taken up by the leg, would bend its knee by 2 degrees.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from ahmss.body.array import Array
from ahmss.body.inverse import LEFT_FOOT, RIGHT_FOOT, solve
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import align, normalize, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.contact import bearing, runs
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.hips import from_standing_parts
from ahmss.motion.planting import feet
from ahmss.motion.resample import continuous

__all__ = ["Grounded", "ground"]

_GAP = 0.15  # seconds; a foot that bears again so soon never left
_FLAT = 0.012  # metres between the heights of a foot's parts at which it hardly lies flat
_STEADY = 0.3  # seconds over which a foot that lies flat is held steady
_NEVER = 1e-9
_LEGS = [[INDEX[f"{side}_{link}"] for link in ("upper_leg", "lower_leg", "foot")] for side in ("right", "left")]
_MIRROR = np.array([1.0, -1.0, 1.0])
_OFF = 0.01  # metres over the height at which it stands where a foot has left the ground
_EASE = 0.06  # seconds before a foot lands and after it leaves over which it is caught and let go
_LOWEST = 0.008  # metres over its lowest part at which another part of a foot counts little
_REACH = 0.995  # share of a leg's length that a foot which stands may ask for
_STRAIGHT = 0.9995  # the same for a leg that was straighter: the knee of a straight one jumps at a millimetre
_SMOOTH = 0.05  # seconds over which hips go lower for a leg that is too short
_WELL = 0.0001  # metres by which the foot of a straight leg may be off; from twice as much on the leg is solved
_BENT = 0.0004  # share of its length by which a leg is shorter that is no more straight: its knee is bent by 3 degrees


class Grounded(NamedTuple):
    """A motion whose feet stand: rotations (F, 43, 4), root (F, 3) metres, contacts (F, 2), 0 or 1."""

    rotations: Array
    root: Array
    contacts: Array


def ground(skeleton: Skeleton, rotations: Array, root: Array | None, rate: float) -> Grounded:
    """The motion with feet that neither slide nor sink, the floor at z = 0.

    Args:
        skeleton: the human's measures.
        rotations: (F, 43, 4) unit quaternions, parent <- child; the hips' against the world.
        root: (F, 3) metres, the hips' way where it is known, or None: it is found from the feet alone.
        rate: frames a second.
    """
    if root is None:
        root = from_standing_parts(skeleton, rotations, rate)
    wanted = feet(skeleton, rotations, root)
    soles = np.stack([skeleton.soles, skeleton.soles * _MIRROR])
    points = _points(wanted, soles)
    given = points.copy()
    bears: Any = bearing(points.reshape(len(points), 6, 3), rate).reshape(-1, 2, 3).any(axis=-1)
    carried = np.zeros((len(root), 2, 3))
    stands = np.zeros((len(root), 2))
    for foot in range(2):
        stances = _joined(_settled(points[:, foot, :, 2].min(axis=1), runs(bears[:, foot])), _GAP * rate)
        for first, end in stances:
            stands[first:end, foot] = 1.0
        wanted[:, foot, 3:] = _steadied(wanted[:, foot, 3:], points[:, foot, :, 2], stands[:, foot], rate)
        points[:, foot] = _points(wanted, soles)[:, foot]
        carried[:, foot] = _carried(points[:, foot], stances, rate)
    wanted[..., :3] += carried
    off = np.linalg.norm(_points(wanted, soles) - given, axis=-1).max(axis=-1)
    hips, own, length = _legs(skeleton, rotations, root)
    bent = _rising((1.0 - own / length) / _BENT, rate)
    share = np.maximum(bent, _rising(off / _WELL, rate))
    lower = _too_high(hips, wanted, (own, length), stands * share, rate)
    share = np.maximum(bent, _rising((off + lower[:, None]) / _WELL, rate))
    root = root - lower[:, None] * np.array([0.0, 0.0, 1.0])
    return Grounded(_mixed(rotations, _solved(skeleton, rotations, root, wanted), share), root, stands)


def _points(frames: Array, soles: Array) -> Array:
    """Heel, ball and toe tip (F, 2, 3, 3) of feet whose links have the frames (F, 2, 7)."""
    return frames[..., None, :3] + rotate(frames[..., None, 3:], soles)


def _steadied(rotations: Array, heights: Array, stands: Array, rate: float) -> Array:
    """A foot's rotations (F, 4), held steady where its three parts, at heights (F, 3), lie flat on the ground."""
    flat = stands * np.exp(-((np.ptp(heights, axis=1) / _FLAT) ** 2))
    share = gaussian_filter1d(flat, _SMOOTH * rate, mode="nearest")[:, None]
    rotations = continuous(rotations)
    summed = gaussian_filter1d(flat[:, None] * rotations, _STEADY * rate, axis=0, mode="nearest")
    steady = normalize(summed + _NEVER * rotations)
    return normalize((1.0 - share) * rotations + share * steady)


def _settled(lowest: Array, stretches: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Stretches (first, end) without what a foot, its lowest part at heights (frames,), still comes down or goes up."""
    out: list[tuple[int, int]] = []
    for first, end in stretches:
        down = np.flatnonzero(lowest[first:end] < np.median(lowest[first:end]) + _OFF)
        out.append((first + int(down[0]), first + int(down[-1]) + 1))
    return out


def _joined(stretches: list[tuple[int, int]], gap: float) -> list[tuple[int, int]]:
    """Stretches (first, end) with those made one that are less than `gap` frames apart."""
    out: list[tuple[int, int]] = []
    for first, end in stretches:
        if out and first - out[-1][1] < gap:
            out[-1] = (out[-1][0], end)
        else:
            out.append((first, end))
    return out


def _carried(points: Array, stances: list[tuple[int, int]], rate: float) -> Array:
    """By how much a foot of points (frames, 3, 3) must be carried to stand still on the floor: (frames, 3) metres."""
    lowest = points[..., 2].min(axis=1)
    carried = np.zeros((len(points), 3))
    if stances:
        moved = _moved(points)
        pieces = [-moved[first:end] for first, end in stances]
        for piece, (first, end) in zip(pieces, stances, strict=True):
            piece -= piece.mean(axis=0)  # over the ground as much before the middle of the stance as after it
            piece[:, 2] = -lowest[first:end]
        carried = _joined_smoothly(len(points), pieces, stances, _EASE * rate)
    sunk = np.maximum(-(lowest + carried[:, 2]), 0.0)
    held = _held(len(points), stances, _EASE * rate)
    carried[:, 2] += held * sunk + (1.0 - held) * _over(sunk, rate)
    return carried


def _moved(points: Array) -> Array:
    """How far the lowest part of a foot (frames, 3, 3) has moved since frame 0, parts taking over gradually."""
    height = points[..., 2] - points[..., 2].min(axis=1, keepdims=True)
    weight = np.exp(-height / _LOWEST)
    weight = 0.5 * (weight[1:] + weight[:-1])
    step = (weight[..., None] * np.diff(points, axis=0)).sum(axis=1) / weight.sum(axis=1, keepdims=True)
    return np.concatenate([np.zeros((1, 3)), np.cumsum(step, axis=0)])


def _joined_smoothly(frames: int, pieces: list[Array], stances: list[tuple[int, int]], ease: float) -> Array:
    """What pieces (n, 3) say in their stances, and between them ways from the one to the next without a jerk."""
    out = np.empty((frames, 3))
    for piece, (first, end) in zip(pieces, stances, strict=True):
        out[first:end] = piece
    out[: stances[0][0]], out[stances[-1][1] :] = pieces[0][0], pieces[-1][-1]
    for (_, left), (landed, _), before, after in zip(stances, stances[1:], pieces, pieces[1:], strict=False):
        k = np.arange(left, landed)
        share = minimum_jerk((k - (left - 1)) / (landed - (left - 1)))
        out[left:landed] = before[-1] + share[:, None] * (after[0] - before[-1])
    for piece, (first, end), gone, to_come in zip(
        pieces, stances, [0, *(end for _, end in stances[:-1])], [*(first for first, _ in stances[1:]), frames],
        strict=True,
    ):  # fmt: skip
        speed = _end_speeds(piece)
        if first > gone:
            out[gone:first] += _tail(first - np.arange(gone, first), min(ease, (first - gone) / 2))[:, None] * -speed[0]
        if to_come > end:
            away = np.arange(end, to_come) - (end - 1)
            out[end:to_come] += _tail(away, min(ease, (to_come - end) / 2))[:, None] * speed[1]
    return out


def _held(frames: int, stances: list[tuple[int, int]], ease: float) -> Array:
    """How firmly the ground holds a foot (frames,): 1 in its stances, growing before them and fading after."""
    held = np.zeros(frames)
    for first, end in stances:
        away = np.maximum(np.maximum(first - np.arange(frames), np.arange(frames) - (end - 1)), 0)
        held = np.maximum(held, minimum_jerk(1.0 - away / (ease + 1.0)))
    return held


def _over(values: Array, rate: float) -> Array:
    """A smooth curve (frames,) that lies over values (frames,) and near them."""
    wide = max(round(2 * _SMOOTH * rate), 1)
    return gaussian_filter1d(
        maximum_filter1d(values, 2 * wide + 1, mode="nearest"), _SMOOTH * rate, mode="nearest", truncate=2.0
    )


def _end_speeds(piece: Array) -> tuple[Array, Array]:
    """How fast a piece (n, 3) changes at its beginning and its end, a frame."""
    few = min(2, len(piece) - 1)
    if few < 1:
        return np.zeros(3), np.zeros(3)
    return (piece[few] - piece[0]) / few, (piece[-1] - piece[-1 - few]) / few


def _tail(away: NDArray[np.intp], ease: float) -> Array:
    """The way (n,) at frames `away` that goes on at one a frame and is back at 0 after `ease` frames."""
    s: Array = np.clip(1.0 - away / (ease + 1.0), 0.0, 1.0)
    return (ease + 1.0) * s**3 * (1.0 - s)


def _legs(skeleton: Skeleton, rotations: Array, root: Array) -> tuple[Array, Array, Array]:
    """Of the right and the left leg: hip joints (F, 2, 3), from there to the ankles (F, 2), whole lengths (2,), m."""
    places, _ = forward(rotations, root, skeleton.offsets)
    thigh, shin, ankle = (list(links) for links in zip(*_LEGS, strict=True))
    length = np.linalg.norm(skeleton.offsets[shin], axis=-1) + np.linalg.norm(skeleton.offsets[ankle], axis=-1)
    return places[:, thigh], np.linalg.norm(places[:, ankle] - places[:, thigh], axis=-1), length


def _rising(values: Array, rate: float) -> Array:
    """0 where values (F, 2) are below 1 all around, 1 where one is above 2, smoothly."""
    around = np.stack([_over(values[:, foot], rate) for foot in range(2)], axis=-1)
    return minimum_jerk(around - 1.0)


def _mixed(given: Array, solved: Array, share: Array) -> Array:
    """Rotations (F, 43, 4) whose legs go over from the given ones to the solved ones by the share (F, 2) of each.

    The joints go over, not the feet: a knee that is straight is bent by degrees as soon as its foot is a hair off.
    """
    out = solved.copy()
    for foot, links in enumerate(_LEGS):
        part = share[:, foot, None, None]
        between = normalize(given[:, links] + part * (align(solved[:, links], given[:, links]) - given[:, links]))
        out[:, links] = np.where(part < 1.0, between, solved[:, links])
    return out


def _too_high(hips: Array, wanted: Array, legs: tuple[Array, Array], stands: Array, rate: float) -> Array:
    """How far (F,) metres the hips must come down where a leg is too short for its foot.

    Args:
        hips: (F, 2, 3) the hip joints.
        wanted: (F, 2, 7) the feet's frames.
        legs: from hip to ankle (F, 2), and the whole lengths (2,).
        stands: (F, 2) by how much each foot is held, 0 to 1.
        rate: frames a second.
    """
    own, whole = legs
    length = np.maximum(_REACH * whole, np.minimum(own, _STRAIGHT * whole))
    away = hips - wanted[..., :3]
    aside = np.minimum(np.linalg.norm(away[..., :2], axis=-1), length)
    most = np.sqrt(length**2 - aside**2)
    return _over((stands * np.maximum(away[..., 2] - most, 0.0)).max(axis=1), rate)


def _solved(skeleton: Skeleton, rotations: Array, root: Array, wanted: Array) -> Array:
    """Rotations (F, 43, 4) whose feet have the frames wanted (F, 2, 7)."""
    targets = np.zeros((len(root), 5, 8))
    for row, foot in ((RIGHT_FOOT, 0), (LEFT_FOOT, 1)):
        targets[:, row, :7], targets[:, row, 7] = wanted[:, foot], 1.0
    return solve(skeleton, rotations, root, targets)
