"""An arm along a path of wrist poses whose elbow never jumps: where its joints do not allow that, they give way.

`arm_path.follow` keeps all limits and so has to jump where the swings that they allow end, and go on elsewhere. Here
the elbow's swing is chosen for all frames at once too, but among all swings: by dynamic programming on a grid of frames
and swings, of those ways on which no swing is faster than it may be the one whose joints are least beyond their limits,
squared and added up. What is left beyond, the hand does not turn as asked, and the shoulder gives.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.ndimage import gaussian_filter1d

from ahmss.body.arm import Arm, Wrist, excess, hand_angles, with_hand, wrist_of
from ahmss.body.arm_path import Way, begun_at, carried_sides, continuous, ease_hand
from ahmss.body.arm_swing import HAND, SHOULDER, allowed, limits_of, nearest_swing, swing_of
from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, to_rotation_vector

__all__ = ["yielding"]

_CELL = np.radians(3.0)  # of the grid of swings
_SWINGS = np.arange(-80, 81) * _CELL  # as far as the elbow swings from where it is carried
_KNOTS = 40  # of the grid of frames, about
_SWUNG, _SHOULDER, _END = 0.3, 6.0, 40.0  # what swings cost, the shoulder's excess, and any in the last frame
_SOFT = 1.2  # knots, over which the way is smoothed
_ROUNDING = 1e-7  # radians
_KEEPS = np.radians(2.0)  # from a limit, that are kept where that costs nothing


def yielding(arm: Arm, wrist: Wrist, present: Array, step: float, softly: int = 0) -> Way:
    """One arm along a path of wrist poses (F, 3), (F, 4) that begins at the present links (3, 4).

    Args:
        arm: its measures.
        wrist: in the shoulder frame.
        present: the links of the frame before the path's first.
        step: the most that the elbow swings from frame to frame, radians.
        softly: how many frames it takes until the elbow may swing so fast.
    """
    swing = swing_of(arm, wrist, carried_sides(arm, wrist.place, present))
    measures, limits = swing.measures(), begun_at(limits_of(arm), present, np.arange(float(len(wrist.place))))
    phi = _ended(_smooth(_chosen(measures, limits, step), len(swing.bend)), measures, limits)
    phi = _begun(phi, softly)
    links = swing.links(phi)
    angles, hand = hand_angles(links), limits[:, HAND]
    within: Any = ((angles >= hand[..., 0] - _ROUNDING) & (angles <= hand[..., 1] + _ROUNDING)).all(axis=-1)
    eased, leaps = ease_hand(angles, within, hand_angles(present), hand, step)
    links = np.where(within[:, None, None], links, with_hand(links, eased))
    off = to_rotation_vector(multiply(conjugate(wrist_of(arm, links).rotation), wrist.rotation))
    turned = np.where(within, 0.0, np.linalg.norm(off, axis=-1))
    return Way(continuous(links, present), swing.missing, turned, excess(arm, links), leaps)


def _chosen(measures: Array, limits: Array, step: float) -> tuple[Any, Array]:
    """Frames (K,) and swings (K,) there, of a way through measures (F, 6, 2, 3) that begins at 0 before the first."""
    frames = len(measures)
    every = -(-frames // _KNOTS)
    knots = np.arange(frames - 1, -1, -every)[::-1]
    cost = every * _strain(measures[knots], limits[knots])
    cost[-1] *= _END
    most = max(int(step * every / _CELL), 1)
    moves = _SWUNG / every * (np.arange(-most, most + 1) * _CELL) ** 2
    before = _SWUNG / (knots[0] + 1) * _SWINGS**2
    least = np.where(np.abs(_SWINGS) <= step * (knots[0] + 1) + 0.5 * _CELL, before, np.inf) + cost[0]
    came = np.zeros((len(knots), len(_SWINGS)), int)
    for k in range(1, len(knots)):
        padded = np.pad(least, most, constant_values=np.inf)
        ways = sliding_window_view(padded, 2 * most + 1) + moves
        came[k] = ways.argmin(axis=-1)
        least = np.take_along_axis(ways, came[k][:, None], axis=-1)[:, 0] + cost[k]
    at = [int(least.argmin())]
    for k in range(len(knots) - 1, 0, -1):
        at.append(at[-1] + int(came[k, at[-1]]) - most)
    return knots, _SWINGS[at[::-1]]


def _strain(measures: Array, limits: Array) -> Array:
    """What measures (K, 6, 2, 3) cost at all swings of the grid (K, m): radians beyond limits (K, 6, 2), squared."""
    basis = np.stack([np.cos(_SWINGS), np.sin(_SWINGS), np.ones_like(_SWINGS)])
    square, product = np.moveaxis(measures @ basis, -2, 0)  # (K, 6, m)
    angles = 2.0 * np.arctan2(product, np.maximum(square, 1e-12))
    low, high = limits[..., :1] + _KEEPS, limits[..., 1:] - _KEEPS
    over = np.maximum(np.maximum(low - angles, angles - high), 0.0)
    over[:, SHOULDER] *= _SHOULDER
    return (over**2).sum(axis=1)


def _smooth(chosen: tuple[Any, Array], frames: int) -> Array:
    """Swings (F,) through those of a grid, which begin softly at 0."""
    knots, swings = chosen
    every = (frames - 1 - knots[0]) / max(len(knots) - 1, 1)
    rough = np.interp(np.arange(-1, frames), np.concatenate([[-1], knots]), np.concatenate([[0.0], swings]))
    soft = gaussian_filter1d(rough, max(_SOFT * every, 1.0), mode="nearest")
    pinned = np.linspace(1.0, 0.0, frames + 1) * soft[0]  # at 0 before the first
    return (soft - pinned)[1:]


def _begun(phi: Array, softly: int) -> Array:
    """Swings (F,) that begin softly and are late at first, by half of so many frames; in time with the last frame."""
    frames = np.arange(1.0, len(phi) + 1.0)
    late = np.cumsum(np.minimum(frames / (softly + 1.0), 1.0))
    return np.interp(late * len(phi) / late[-1], np.arange(len(phi) + 1.0), np.concatenate([[0.0], phi]))


def _ended(phi: Array, measures: Array, limits: Array) -> Array:
    """Swings (F,) that come to what the limits allow in the last frame, if anything is."""
    nearest, _ = nearest_swing(allowed(measures[-1], limits[-1]), phi[-1])
    return phi + np.linspace(0.0, 1.0, len(phi) + 1)[1:] * (nearest - phi[-1])
