"""Clips changed as wholes: a piece cut out, the other side's motion, another place to begin at."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ahmss.body import skeleton as body
from ahmss.body.array import Array
from ahmss.body.floor_frame import floor_frame
from ahmss.body.links import INDEX, LINKS
from ahmss.body.quaternion import conjugate, multiply, norm, rotate
from ahmss.motion.clip import Clip
from ahmss.motion.resample import resample

__all__ = ["at_rate", "begun_at_origin", "cut", "floor_frame", "mirrored", "part"]

_LEVEL = np.array([1.0, 1.0, 0.0])
_SWAPPED_TARGETS = [1, 0, 3, 2, 4]
_REFLECTION = np.array([1.0, -1.0, 1.0])  # of places at the plane y = 0
_TURN_REFLECTION = np.array([1.0, -1.0, 1.0, -1.0])  # of rotations wxyz at the same plane


def part(clip: Clip, first: int, end: int) -> Clip:
    """The clip's frames from `first` to before `end`, what they are relative to left as it is."""
    return replace(
        clip, rotations=clip.rotations[first:end], root=clip.root[first:end], importance=clip.importance[first:end],
        contacts=clip.contacts[first:end], targets=None if clip.targets is None else clip.targets[first:end],
    )  # fmt: skip


def cut(clip: Clip, first: int, last: int) -> Clip:
    """The clip's frames `first` to `last`, both with, as a clip of its own: it begins at the human's floor frame.

    Raises:
        ValueError: it is a clip of keyframes, or has no such frames.
    """
    if clip.header.times is not None:
        raise ValueError("a clip of keyframes can't be cut; resample it first")
    if not 0 <= first <= last < clip.frames:
        raise ValueError(f"frames {first} to {last} can't be cut out; the clip's go from 0 to {clip.frames - 1}")
    return begun_at_origin(part(clip, first, last + 1))


def at_rate(clip: Clip, rate: float) -> Clip:
    """The clip at another rate, as long as before to within half a frame.

    Raises:
        ValueError: it is a clip of keyframes, which take as long as they are asked to.
    """
    if clip.header.times is not None:
        raise ValueError("a clip of keyframes has no duration; say how many frames it shall have")
    frames = max(round(clip.duration * rate) + 1, 1)
    return replace(resample(clip, frames), rate=rate)


def mirrored(clip: Clip) -> Clip:
    """The clip seen in a mirror at the plane y = 0: what the right hand did, the left does."""
    rotations, root = body.mirror(clip.rotations, clip.root)
    swap = [INDEX[_other_side(name)] for name in LINKS]
    targets = clip.targets
    if targets is not None:
        reflection = np.concatenate([_REFLECTION, _TURN_REFLECTION, [1.0]])
        targets = targets[:, _SWAPPED_TARGETS] * reflection
    return replace(
        clip, rotations=rotations, root=root, importance=clip.importance[:, [*swap, len(LINKS)]],
        contacts=clip.contacts[:, ::-1], targets=targets,
    )  # fmt: skip


def begun_at_origin(clip: Clip) -> Clip:
    """The clip relative to the human's floor frame at its own frame 0, its targets with it.

    A clip whose poses are relative to an object stays as it is.
    """
    if clip.header.frame != "human":
        return clip
    place, turn = floor_frame(clip.rotations[0], clip.root[0])
    back = conjugate(turn)
    rotations = clip.rotations.copy()
    rotations[:, 0] = multiply(back, rotations[:, 0])
    targets = clip.targets
    if targets is not None and clip.header.targets == "human":
        targets = _moved(targets, place, back)
    return replace(clip, rotations=rotations, root=rotate(back, clip.root - place), targets=targets)


def _moved(targets: Array, place: Array, back: Array) -> Array:
    """Targets (F, 5, 8) in a frame at `place` whose inverse rotation is `back`; what has no place or turn stays so."""
    out = targets.copy()
    held = (targets[..., 7] > 0.0) | targets[..., :3].any(axis=-1)
    out[held, :3] = rotate(back, targets[held, :3] - place)
    turned = norm(targets[..., 3:7]) > 0.0
    out[turned, 3:7] = multiply(back, targets[turned, 3:7])
    return out


def _other_side(name: str) -> str:
    """The same link on the other side."""
    if name.startswith("right_"):
        return "left_" + name.removeprefix("right_")
    return "right_" + name.removeprefix("left_") if name.startswith("left_") else name
