"""A way with corners made into one that a person walks: an elastic band that keeps clear of things.

The band wants to be short, to bend little and to change its bend slowly:

    E = integral of |P'|^2 + 2 l^2 |P''|^2 + l^4 |P'''|^2 ds

so that round a single contact a turn by theta has the curvature theta (1 + |s|/l) exp(-|s|/l) / (4 l), which rises
and falls without a step; l is chosen for the radius that is wanted. Footprints push the band off (elastic bands:
Quinlan and Khatib 1993; here a penalty, by Gauss-Newton), so that where there is less room the bend is tighter.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.linalg import solveh_banded
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from ahmss.body.array import Array
from ahmss.walking.obstacles import Ends, Obstacles

__all__ = ["SAMPLE", "SLACK", "evenly", "rounded"]

SAMPLE = 0.02  # metres between the points of a course
SLACK = 0.08  # metres by which a bend may cut into the radius
_STEP = 0.08  # metres between the points of the band
_WISH = 0.01  # metres that the band keeps more than the radius, as a penalty gives a little
_PUSH = 300.0  # stiffness of a contact; the band's own tension is 1
_LEAST, _MOST = 0.2, 0.6  # l, metres: even a small turn spreads over a step or two
_WINDOW = 0.5  # metres to both sides of a place that what is found there changes
_ROUNDS, _ITERATIONS = 5, 12
_BLUR = 0.04  # metres: so little that a blurred way still keeps within SLACK

_STENCILS = (np.array([-1.0, 1.0]), np.array([1.0, -2.0, 1.0]), np.array([-1.0, 3.0, -3.0, 1.0]))


def rounded(way: Array, around: Obstacles, ends: Ends, turn_radius: float) -> tuple[Array, Array]:
    """Points (n, 2) every 2 cm of a smooth way with the ends of one of straight legs (k, 2), and its heading (n,)."""
    band, _ = evenly(way, _STEP, smooth=False)
    length = _spread(band, turn_radius)
    tree = shapely.STRtree(around.edges[0])
    best: tuple[Array, Array] | None = None
    for _ in range(_ROUNDS):
        band = _settled(band, length, around, ends, tree)
        course = evenly(band, SAMPLE)
        near = _too_near(course[0], around, ends, tree)
        if near.any():
            if best is not None:
                return best
            length = length * (1.0 - 0.6 * _along(near.astype(np.float64), len(band)))
            continue
        best = course
        sharp = np.abs(np.gradient(course[1])) / SAMPLE * turn_radius
        if sharp.max() < 1.1:
            break
        length = np.minimum(length * np.sqrt(1.0 + _along(np.maximum(sharp - 1.0, 0.0), len(band))), _MOST)
    return best or _blurred(way)


def evenly(points: Array, step: float, *, smooth: bool = True) -> tuple[Array, Array]:
    """Points (n, 2) evenly along the curve through points, at most a step apart, and its heading (n,)."""
    chord = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=-1))])
    count = max(int(np.ceil(chord[-1] / step)), 8) + 1
    if not smooth:
        at = np.linspace(0.0, chord[-1], count)
        return np.stack([np.interp(at, chord, points[:, k]) for k in range(2)], axis=-1), np.zeros(count)
    curve = CubicSpline(chord, points, bc_type="natural")
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
    """The band (n, 2) of least energy near one, its ends kept."""
    band = band.copy()
    step = np.linalg.norm(np.diff(band, axis=0), axis=-1).mean()
    stiffness = _stiffness(length, step)
    for _ in range(_ITERATIONS):
        at, normal, lack = _contacts(band, around, ends, tree)
        push = np.zeros_like(band)
        np.add.at(push, at, _PUSH * lack[:, None] * normal)
        block = np.zeros((len(band), 3))  # xx, yy, xy of each point's contacts
        np.add.at(block, at, _PUSH * np.stack([normal[:, 0] ** 2, normal[:, 1] ** 2, normal[:, 0] * normal[:, 1]], -1))
        matrix = np.zeros((7, 2 * len(band)))  # x and y of a point lie together
        for offset in range(4):
            matrix[2 * offset] = np.repeat(stiffness[offset], 2)
        matrix[0] += block[:, :2].ravel()
        matrix[1, ::2] = block[:, 2]
        force = push - _times(stiffness, band)
        move = solveh_banded(matrix[:, 2:-2], force[1:-1].ravel(), lower=True, check_finite=False).reshape(-1, 2)
        most = np.linalg.norm(move, axis=-1).max()
        band[1:-1] += move * min(1.0, 0.1 / max(most, 1e-9))
        if most < 1e-3:
            break
    return band


def _contacts(band: Array, around: Obstacles, ends: Ends, tree: Any) -> tuple[NDArray[np.intp], Array, Array]:
    """Which points (c,) of a band are too near to an edge, the way off it (c, 2), and by how much (c,) metres."""
    at, edge = tree.query(shapely.points(band), predicate="dwithin", distance=around.radius + _WISH)
    lines, whose = around.edges
    which = whose[edge]
    foot = shapely.get_coordinates(shapely.shortest_line(lines[edge], shapely.points(band[at])))[::2]
    off = band[at] - foot
    away = np.linalg.norm(off, axis=-1)
    normal = off / np.maximum(away, 1e-9)[:, None]
    inside = shapely.contains_xy(around.shapes[which], band[at])
    normal[inside] *= -1.0
    lack = around.needed(band[at], which, ends) + _WISH - np.where(inside, -away, away)
    real = lack > 0.0
    return at[real], normal[real], lack[real]


def _too_near(points: Array, around: Obstacles, ends: Ends, tree: Any) -> NDArray[np.bool_]:
    """(n,) whether a point of a course is nearer to a thing than even a bend may be."""
    least = around.radius - SLACK
    at, edge = tree.query(shapely.points(points), predicate="dwithin", distance=least)
    lines, whose = around.edges
    which = whose[edge]
    away = shapely.distance(lines[edge], shapely.points(points[at]))
    away = np.where(shapely.contains_xy(around.shapes[which], points[at]), -away, away)
    near = np.zeros(len(points), dtype=bool)
    near[at[away < np.minimum(least, around.needed(points[at], which, ends) - 0.02)]] = True
    return near


def _along(values: Array, count: int) -> Array:
    """Values (n,) every 2 cm, each spread over its window, as (count,) for the points of a band."""
    width = 2 * int(_WINDOW / SAMPLE) + 1
    wide = gaussian_filter1d(maximum_filter1d(values, width, mode="nearest"), width / 8, mode="nearest")
    return np.interp(np.linspace(0.0, 1.0, count), np.linspace(0.0, 1.0, len(values)), wide)


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


def _blurred(way: Array) -> tuple[Array, Array]:
    """The straight legs with corners so little rounded that nothing is too near; where nothing else fits."""
    dense, _ = evenly(way, _BLUR / 4.0, smooth=False)
    about = 2.0 * dense[0] - dense[::-1][:-1], 2.0 * dense[-1] - dense[::-1][1:]  # point mirrored: the ends stay
    blurred = gaussian_filter1d(np.concatenate([about[0], dense, about[1]]), 4.0, axis=0, mode="nearest")
    return evenly(blurred[len(about[0]) : len(about[0]) + len(dense)], SAMPLE)
