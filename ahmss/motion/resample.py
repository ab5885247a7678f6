"""A clip in another number of frames: the same motion, faster or slower; importance goes with it (Ichiguchi 2000, 4.2).

Densely sampled frames go by cubic splines, which keep velocity and acceleration smooth between them; frames far apart
(keyframes) by slerp (5.7), which can't overshoot.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import msgspec
import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator

from ahmss.body.array import Array
from ahmss.body.quaternion import norm, normalize, slerp
from ahmss.motion.clip import Clip

__all__ = ["continuous", "interpolate_rotations", "resample"]

_DENSE = np.cos(0.5 * np.radians(20.0))  # steps of less than 20 degrees are samples of one smooth motion
_WEIGHT = 7  # column of targets


def resample(clip: Clip, frames: int) -> Clip:
    """The clip over `frames` frames (>= 1) from its first pose to its last, at the same rate.

    Keyframes are taken at their times; the result has none.

    Raises:
        ValueError: fewer than one frame is asked for.
    """
    if frames < 1:
        raise ValueError(f"a clip can't have {frames} frames; ask for 1 or more")
    if frames == clip.frames and clip.header.times is None:
        return clip
    known = _known_times(clip)
    times = np.linspace(known[0], known[-1], frames) if frames > 1 else known[-1:]
    return replace(
        clip,
        rotations=interpolate_rotations(known, clip.rotations, times),
        root=_smooth(known, clip.root, times),
        importance=np.maximum(_linear(known, clip.importance, times), 0.0),
        contacts=np.clip(_linear(known, clip.contacts, times), 0.0, 1.0),
        targets=None if clip.targets is None else _targets(known, clip.targets, times),
        header=msgspec.structs.replace(clip.header, times=None),
    )


def continuous(rotations: Array) -> Array:
    """The rotations (frames, ..., 4) with signs chosen so that each lies on the hemisphere of the frame before."""
    dots = np.einsum("f...c,f...c->f...", rotations[1:], rotations[:-1])
    signs = np.cumprod(np.where(dots < 0.0, -1.0, 1.0), axis=0)
    return np.concatenate([rotations[:1], signs[..., None] * rotations[1:]])


def interpolate_rotations(known: Array, rotations: Array, times: Array) -> Array:
    """Unit quaternions (n, ..., 4) at times (n,) from those (frames, ..., 4) at rising known times (frames,)."""
    rotations = continuous(rotations)
    if len(known) == 1:
        return np.repeat(rotations, len(times), axis=0)
    dots = np.einsum("f...c,f...c->f...", rotations[1:], rotations[:-1])
    if dots.min() > _DENSE:
        return normalize(CubicSpline(known, rotations)(times))
    before, share = _bracket(known, times)
    share = share.reshape(-1, *[1] * (rotations.ndim - 2))
    return slerp(rotations[before], rotations[before + 1], share)


def _known_times(clip: Clip) -> Array:
    if clip.header.times is not None:
        return np.array(clip.header.times)
    return np.arange(clip.frames, dtype=float)


def _bracket(known: Array, times: Array) -> tuple[Any, Array]:
    """For each time the known frame before it, and the share of the way to the next."""
    before = np.clip(np.searchsorted(known, times, side="right") - 1, 0, len(known) - 2)
    return before, (times - known[before]) / (known[before + 1] - known[before])


def _linear(known: Array, values: Array, times: Array) -> Array:
    if len(known) == 1:
        return np.repeat(values, len(times), axis=0)
    before, share = _bracket(known, times)
    return values[before] + share[:, None] * (values[before + 1] - values[before])


def _smooth(known: Array, values: Array, times: Array) -> Array:
    if len(known) == 1:
        return np.repeat(values, len(times), axis=0)
    return CubicSpline(known, values)(times)


def _targets(known: Array, targets: Array, times: Array) -> Array:
    """Targets (n, 5, 8): the weight linear; place and rotation smooth, from the frames alone that have them.

    A frame without weight has no place, so nothing is interpolated towards it.
    """
    out = np.zeros((len(times), *targets.shape[1:]))
    nearest = np.argmin(np.abs(known[:, None] - times), axis=0)
    for row in range(targets.shape[1]):
        weights = targets[:, row, _WEIGHT]
        out[:, row, _WEIGHT] = np.clip(_linear(known, weights[:, None], times)[:, 0], 0.0, 1.0)
        held = np.flatnonzero(weights > 0.0)
        if len(held):
            out[:, row, :3] = _places(known[held], targets[held, row, :3], times)
        turned = np.flatnonzero(norm(targets[:, row, 3:7]) > 0.5)
        if len(turned):
            inside = np.clip(times, known[turned[0]], known[turned[-1]])
            rotations = interpolate_rotations(known[turned], targets[turned, row, 3:7], inside)
            out[:, row, 3:7] = np.where((norm(targets[nearest, row, 3:7]) > 0.5)[:, None], rotations, 0.0)
    return out


def _places(known: Array, places: Array, times: Array) -> Array:
    if len(known) == 1:
        return np.repeat(places, len(times), axis=0)
    return PchipInterpolator(known, places)(np.clip(times, known[0], known[-1]))
