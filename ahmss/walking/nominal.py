"""Clips joined into one walk along a straight way, as they are: what is shrunk, turned and bent afterwards."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, multiply, normalize, rotate
from ahmss.walking.catalogue import STRAIGHT, Key
from ahmss.walking.library import Library, WalkClip
from ahmss.walking.mirroring import mirrored
from ahmss.walking.selection import Selection, candidates, stored

__all__ = ["Nominal", "clip_of", "join", "length_of", "straights", "stretched", "woven"]

_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Nominal:
    """A walk along +x, from where the hips stand at x = 0.

    rotations (F, 15, 4), root (F, 3) metres, bearing (F, 2, 3); seams: the frames at which clips meet, the first and
    the last frame among them.
    """

    rotations: Array
    root: Array
    bearing: NDArray[np.bool_]
    seams: tuple[int, ...]


def clip_of(library: Library, key: Key, *, mirror: bool = False) -> WalkClip:
    """The clip of any key that the table has, or whose mirror image it has.

    Raises:
        KeyError: the library lacks it.
    """
    own, flipped = stored(key)
    clip = library.clips[own]
    return mirrored(clip) if flipped != mirror else clip


def length_of(clip: WalkClip) -> float:
    """How far the hips get along the clip's way, metres."""
    direction = np.radians(clip.key.direction)
    x, y = (clip.root[-1] - clip.root[0])[:2]
    return float(x * np.cos(direction) + y * np.sin(direction))


def woven(library: Library, direction: int, facing: int, chosen: Selection, *, mirror: bool) -> list[WalkClip]:
    """The clips of a walk in their order, each as it is to be seen.

    Args:
        library: the clips.
        direction, facing: of the bins, degrees.
        chosen: what they make up.
        mirror: whether all is seen in a mirror.
    """
    keys = candidates(direction, facing)
    if chosen.pattern in ("1Step", "2Step"):
        key = keys.one[chosen.stride] if chosen.pattern == "1Step" else keys.two[chosen.stride]
        return [clip_of(library, key, mirror=mirror)]
    steps = straights(library, chosen.steps, mirror=mirror)
    end = clip_of(library, keys.last[chosen.stride, chosen.last], mirror=mirror)
    return [clip_of(library, keys.first, mirror=mirror), *steps, end]


def straights(library: Library, count: int, *, mirror: bool) -> list[WalkClip]:
    """So many straight steps, every other one seen in a mirror: the first where `mirror` says so."""
    both = [clip_of(library, STRAIGHT, mirror=side) for side in (mirror, not mirror)]
    return [both[i % 2] for i in range(count)]


def join(clips: Sequence[WalkClip], scale: float) -> Nominal:
    """Clips one after the other along +x, their lengths multiplied by a scale."""
    rotations, roots, bearing, seams = [], [], [], [0]
    laid: dict[int, tuple[Array, Array]] = {}  # by the clip's identity: a long walk is two clips again and again
    x = 0.0
    for number, clip in enumerate(clips):
        if id(clip) not in laid:
            laid[id(clip)] = _laid(clip, scale)
        own, root = laid[id(clip)]
        first = 0 if number == 0 else 1
        own, root = own[first:], root + np.array([x, 0.0, 0.0])
        x = root[-1, 0]
        if rotations:
            own = own * np.where((own[0] * rotations[-1][-1]).sum(axis=-1) < 0.0, -1.0, 1.0)[:, None]
        rotations.append(own)
        roots.append(root[first:])
        bearing.append(clip.bearing[first:])
        seams.append(seams[-1] + clip.frames)
    return Nominal(np.concatenate(rotations), np.concatenate(roots), np.concatenate(bearing), tuple(seams))


def _laid(clip: WalkClip, scale: float) -> tuple[Array, Array]:
    """A clip's rotations and root, its way along +x from x = 0."""
    turn = from_axis_angle(_UP, -np.radians(clip.key.direction))
    rotations = clip.rotations.copy()
    rotations[:, 0] = multiply(turn, rotations[:, 0])
    root = scale * rotate(turn, clip.root)
    root[:, 0] -= root[0, 0]
    return rotations, root


def stretched(nominal: Nominal, times: Array) -> Nominal:
    """The walk at other times: frame k is what it was at frame times[k] (n,), rising from the first to the last."""
    most = len(nominal.root) - 1
    i = np.clip(times.astype(int), 0, most - 1)
    u = times - i
    near = np.clip(i[:, None] + (-1, 0, 1, 2), 0, most)  # a spline through the four frames around (Catmull and Rom)
    weights = 0.5 * np.stack([
        u * (u * (2.0 - u) - 1.0), 2.0 + u * u * (3.0 * u - 5.0), u * (1.0 + u * (4.0 - 3.0 * u)), u * u * (u - 1.0),
    ], axis=-1)  # fmt: skip
    rows = csr_array((weights.ravel(), near.ravel(), np.arange(len(times) + 1) * 4), shape=(len(times), most + 1))
    out = rows @ np.concatenate([nominal.rotations.reshape(most + 1, -1), nominal.root], axis=1)
    seams = tuple(int(s) for s in np.searchsorted(times, np.array(nominal.seams) - 1e-6))
    nearest = np.clip(np.round(times).astype(int), 0, most)
    rotations = normalize(out[:, :-3].reshape(len(times), -1, 4))
    return Nominal(rotations, out[:, -3:], nominal.bearing[nearest], seams)
