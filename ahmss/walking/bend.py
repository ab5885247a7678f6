"""A way with corners made into one that a person walks: an elastic band that keeps clear of things.

The band wants to be short, to bend little and to change its bend slowly:

    E = integral of |P'|^2 + 2 l^2 |P''|^2 + l^4 |P'''|^2 ds

so that round a single contact a turn by theta has the curvature theta (1 + |s|/l) exp(-|s|/l) / (4 l), which rises
and falls without a step; l is chosen for the radius that is wanted. Footprints push the band off (elastic bands:
Quinlan and Khatib 1993; here a penalty, by Gauss-Newton), so that where there is less room the bend is tighter.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.linalg import solveh_banded
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from ahmss.body.array import Array
from ahmss.walking.obstacles import NEAREST, Ends, Obstacles

__all__ = ["SAMPLE", "SLACK", "blurred", "evenly", "rounded"]

SAMPLE = 0.02  # metres between the points of a course
SLACK = 0.08  # metres by which a bend may cut into the radius
_STEP = 0.08  # metres between the points of the band
_REACH = 0.4  # metres beyond the radius within which edges are kept an eye on
_SOFT = 0.01  # metres over which a contact takes hold
_PUSH = 300.0  # stiffness of a contact; the band's own tension is 1
_LEAST, _MOST = 0.2, 0.8  # l, metres: even a small turn spreads over a step or two
_WINDOW = 0.5  # metres to both sides of a place that what is found there changes
_ROUNDS, _ITERATIONS = 5, 12
_FARTHEST = 0.15  # metres that a point moves at once: less than the radius, so that it jumps over nothing
_EASE = 0.03  # metres more near the ends, where the radius is not kept anyway
_BLUR = 0.04  # metres: so little that a blurred way still keeps within SLACK

Contacts = tuple[NDArray[np.intp], Array, Array]


class Neighbours(NamedTuple):
    """Pairs of a point of the band, `at`, and an edge of the obstacle `which`, from `begin` on along `way` (p, 2)."""

    at: NDArray[np.intp]
    which: NDArray[np.intp]
    begin: Array
    way: Array


_STENCILS = (np.array([-1.0, 1.0]), np.array([1.0, -2.0, 1.0]), np.array([-1.0, 3.0, -3.0, 1.0]))


def rounded(way: Array, around: Obstacles, ends: Ends, turn_radius: float) -> tuple[Array, Array]:
    """Points (n, 2) every 2 cm of a smooth way with the ends of one of straight legs (k, 2), and its heading (n,)."""
    band, _ = evenly(way, _STEP, smooth=False)
    length = _spread(band, turn_radius)
    tree = shapely.STRtree(around.edges[0])
    best: tuple[Array, Array] | None = None
    sharpest = np.inf
    for _ in range(_ROUNDS):
        course = evenly(_settled(band, length, around, ends, tree), SAMPLE)
        near = _too_near(course[0], around, ends)
        sharp = np.abs(np.gradient(course[1])) / np.linalg.norm(course[0][1] - course[0][0]) * turn_radius
        if best is not None and (near.any() or sharp.max() > 0.93 * sharpest):
            break  # a stiffer band is of no use: there is no room
        band, _ = evenly(course[0], _STEP, smooth=False)  # as where it bends its points have come apart
        length = _stretched(length, len(band))
        if near.any():
            length *= 1.0 - 0.6 * _along(near.astype(np.float64), len(band))
            continue
        best, sharpest = course, sharp.max()
        if sharpest < 1.15:
            break
        length = np.minimum(length * (1.0 + _along(np.maximum(sharp - 1.0, 0.0), len(band))), _MOST)
    return best or blurred(way)


def evenly(points: Array, step: float, *, smooth: bool = True) -> tuple[Array, Array]:
    """Points (n, 2) evenly along the curve through points, at most a step apart, and its heading (n,)."""
    chord = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=-1))])
    count = max(int(np.ceil(chord[-1] / step)), 8) + 1
    if not smooth:
        at = np.linspace(0.0, chord[-1], count)
        return np.stack([np.interp(at, chord, points[:, k]) for k in range(2)], axis=-1), np.zeros(count)
    curve = CubicSpline(chord, points)
    fine = np.linspace(0.0, chord[-1], 4 * count)
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(curve(fine), axis=0), axis=-1))])
    count = max(int(np.ceil(length[-1] / step)), 8) + 1
    at = np.interp(np.linspace(0.0, length[-1], count), length, fine)
    even, tangent = curve(at), curve(at, 1)
    even[0], even[-1] = points[0], points[-1]
    return even, np.unwrap(np.arctan2(tangent[:, 1], tangent[:, 0]))


def _spread(band: Array, turn_radius: float) -> Array:
    """l (n,) along a band: what gives the turn within a window the radius that is wanted."""
    leg = np.diff(band, axis=0)
    heading = np.unwrap(np.arctan2(leg[:, 1], leg[:, 0]))
    turned = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(heading))), [0.0]])
    turned[-1] = turned[-2]
    s = np.linspace(0.0, np.linalg.norm(leg, axis=-1).sum(), len(band))
    theta = np.interp(s + _WINDOW, s, turned) - np.interp(s - _WINDOW, s, turned)
    length = np.clip(1.05 * turn_radius * theta / 4.0, _LEAST, _MOST)
    return gaussian_filter1d(length, _WINDOW / 3.0 / max(s[1], 1e-3), mode="nearest")


def _settled(band: Array, length: Array, around: Obstacles, ends: Ends, tree: Any) -> Array:
    """The band (n, 2) of least energy near one, for l (n,); its ends stay."""
    stiffness = _stiffness(length, np.linalg.norm(np.diff(band, axis=0), axis=-1).mean())
    near = _neighbours(band, around, tree)
    contacts = _contacts(band, around, ends, near)
    energy = _energy(stiffness, band, contacts)
    for _ in range(_ITERATIONS):
        move = _newton(stiffness, band, contacts)
        most = np.linalg.norm(move, axis=-1).max()
        move *= min(1.0, _FARTHEST / max(most, 1e-9))
        for share in (1.0, 1 / 3, 1 / 9, 1 / 27):  # contacts come and go: a whole step may overshoot
            contacts = _contacts(band + share * move, around, ends, near)
            reached = _energy(stiffness, band + share * move, contacts)
            if reached < energy or share == 1 / 27:
                band, energy = band + share * move, reached
                break
        if most < 4e-3:
            break
    return band


def _newton(stiffness: Array, band: Array, contacts: Contacts) -> Array:
    """The move (n, 2) to the least energy if the contacts stay as they are; the ends don't move.

    Points move across the band only: along it they would crowd where it bends, which costs less than a wider bend.
    """
    at, normal, lack = contacts
    along = np.zeros_like(band)
    along[1:-1] = band[2:] - band[:-2]
    across = np.stack([-along[:, 1], along[:, 0]], axis=-1) / np.maximum(np.hypot(*along.T), 1e-9)[:, None]
    taken = np.minimum(lack + _SOFT, 2.0 * _SOFT)  # of a contact's hold, that grows over twice _SOFT
    pressed = np.where(lack < _SOFT, _PUSH / (4.0 * _SOFT) * taken**2, _PUSH * lack)
    share = (normal * across[at]).sum(axis=-1)
    matrix = stiffness.copy()
    matrix[0] += np.bincount(at, _PUSH / (2.0 * _SOFT) * taken * share**2, len(band))
    for offset in range(1, 4):
        matrix[offset, :-offset] *= (across[offset:] * across[:-offset]).sum(axis=-1)
    force = np.bincount(at, pressed * share, len(band)) - (_times(stiffness, band) * across).sum(axis=-1)
    move = np.zeros(len(band))
    move[1:-1] = solveh_banded(matrix[:, 1:-1], force[1:-1], lower=True, check_finite=False)
    return move[:, None] * across


def _energy(stiffness: Array, band: Array, contacts: Contacts) -> float:
    """E of a band, and what its contacts store."""
    lack = contacts[2]
    pressed = np.where(lack < _SOFT, (lack + _SOFT) ** 3 / (6.0 * _SOFT), lack**2 + _SOFT**2 / 3.0)
    return float((band * _times(stiffness, band)).sum() + _PUSH * pressed.sum())


def _neighbours(band: Array, around: Obstacles, tree: Any) -> Neighbours:
    """The points of a band and the edges that may come to touch each other."""
    at, edge = tree.query(shapely.points(band), predicate="dwithin", distance=around.radius + _REACH)
    lines, whose = around.edges
    corners = shapely.get_coordinates(lines[edge]).reshape(-1, 2, 2)
    return Neighbours(at, whose[edge], corners[:, 0], corners[:, 1] - corners[:, 0])


def _contacts(band: Array, around: Obstacles, ends: Ends, near: Neighbours) -> Contacts:
    """Which points (c,) of a band are too near to an edge, how moving mends it (c, 2), and by how much (c,) metres."""
    off = band[near.at] - near.begin
    share = (off * near.way).sum(axis=-1) / np.maximum((near.way**2).sum(axis=-1), 1e-12)
    off -= np.clip(share, 0.0, 1.0)[:, None] * near.way
    away = np.sqrt((off**2).sum(axis=-1))
    close = np.flatnonzero((away < around.radius + _SOFT) | around.left(ends)[near.which])
    at, which, off, away = near.at[close], near.which[close], off[close], away[close]
    inside = shapely.contains_xy(around.shapes[which], band[at])
    nearest = np.full(len(band), np.inf)
    np.minimum.at(nearest, at[inside], away[inside])
    signed = np.where(inside, -away, away)
    needed, gradient = around.needed(band[at], which, ends, around.radius)
    lack = needed - signed
    real = (lack > -_SOFT) & (~inside | (away <= nearest[at]))  # the way out is the nearest one
    normal = off / np.where(np.abs(signed) > 1e-9, signed, 1e-9)[:, None]
    return at[real], (normal - gradient)[real], lack[real]


def _too_near(points: Array, around: Obstacles, ends: Ends) -> NDArray[np.bool_]:
    """(n,) whether a point of a course is nearer to a thing than even a bend may be."""
    least = around.radius - SLACK
    at, which = shapely.STRtree(around.shapes).query(shapely.points(points), predicate="dwithin", distance=least)
    away = around.signed(which, points[at])
    needed, _ = around.needed(points[at], which, ends, least + _EASE)
    kept = np.maximum(needed - _EASE, np.minimum(needed, NEAREST))
    near = np.zeros(len(points), dtype=bool)
    near[at[(away < kept) & ~around.leaving(points[at], which, ends)]] = True
    return near


def _along(values: Array, count: int) -> Array:
    """Values (n,) every 2 cm, each spread over its window, as (count,) for the points of a band."""
    width = 2 * int(_WINDOW / SAMPLE) + 1
    wide = gaussian_filter1d(maximum_filter1d(values, width, mode="nearest"), width / 8, mode="nearest")
    return _stretched(wide, count)


def _stretched(values: Array, count: int) -> Array:
    """Values (n,) evenly along a way, as (count,)."""
    return np.interp(np.linspace(0.0, 1.0, count), np.linspace(0.0, 1.0, len(values)), values)


def _stiffness(length: Array, step: float) -> Array:
    """(4, n) the lower bands of the matrix of E for l (n,)."""
    bands = np.zeros((4, len(length)))
    weights = (np.ones_like(length), 2.0 * length**2, length**4)
    for order, (stencil, weight) in enumerate(zip(_STENCILS, weights, strict=True), start=1):
        count = len(length) - order
        mean = np.mean([weight[k : k + count] for k in range(order + 1)], axis=0) / step ** (2 * order - 1)
        for row in range(order + 1):
            for column in range(row + 1):
                bands[row - column, column : column + count] += mean * stencil[row] * stencil[column]
    return bands


def _times(bands: Array, band: Array) -> Array:
    """A symmetric matrix, given by its lower bands (4, n), times points (n, 2)."""
    out = bands[0][:, None] * band
    for offset in range(1, 4):
        part = bands[offset, :-offset, None]
        out[offset:] += part * band[:-offset]
        out[:-offset] += part * band[offset:]
    return out


def blurred(way: Array) -> tuple[Array, Array]:
    """The straight legs with corners so little rounded that nothing is too near; where nothing else fits."""
    dense, _ = evenly(way, _BLUR / 4.0, smooth=False)
    about = 2.0 * dense[0] - dense[::-1][:-1], 2.0 * dense[-1] - dense[::-1][1:]  # point mirrored: the ends stay
    soft = gaussian_filter1d(np.concatenate([about[0], dense, about[1]]), 4.0, axis=0, mode="nearest")
    soft = soft[len(about[0]) : len(about[0]) + len(dense)]
    soft[0], soft[-1] = way[0], way[-1]
    return evenly(soft, SAMPLE)
