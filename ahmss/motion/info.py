"""What a clip holds, in a few lines: how long it is, where it goes, what moves and what it is for."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np

from ahmss.body.array import Array
from ahmss.body.floor_frame import floor_frame
from ahmss.body.links import LINKS
from ahmss.body.quaternion import conjugate, multiply, to_rotation_vector
from ahmss.motion.clip import Clip
from ahmss.motion.contact import runs

__all__ = ["Info", "describe"]

_ROWS = ("right_hand", "left_hand", "right_foot", "left_foot", "gaze")
_LEVEL = np.array([1.0, 1.0, 0.0])
_MOST = 5  # joints that are named


class Info(msgspec.Struct, frozen=True):
    """A clip in figures.

    way: how far the hips go on the floor, metres; moved: from the first frame to the last, straight. turned_deg: by how
    much they turn to the left. hips: their least and greatest height. standing: the share of frames in which the right
    and the left foot are on the ground; steps: how often. turning_deg: the joints that get farthest from where they
    begin, and how far. importance: each joint's mean, the root's last, where it is not 0. targets: the share of frames
    that have one.
    """

    frames: int
    rate: float
    seconds: float
    origin: str
    human: str
    frame: str
    keyframes: tuple[float, ...]
    way: float
    moved: float
    turned_deg: float
    hips: tuple[float, float]
    standing: tuple[float, float]
    steps: tuple[int, int]
    turning_deg: dict[str, float]
    importance: dict[str, float]
    targets: dict[str, float]
    targets_relative_to: str

    def plain(self) -> dict[str, Any]:
        """As JSON has it, in the order of the fields."""
        return msgspec.to_builtins(self)


def describe(clip: Clip) -> Info:
    """A clip in figures."""
    level = clip.root * _LEVEL
    spread = _spread(clip.rotations)
    most = np.argsort(-spread[1:], kind="stable")[:_MOST] + 1
    weights = np.zeros(len(_ROWS)) if clip.targets is None else (clip.targets[..., 7] > 0.0).mean(axis=0)
    importance = dict(zip((*LINKS, "root"), clip.importance.mean(axis=0), strict=True))
    down = [runs(clip.contacts[:, foot] > 0.5) for foot in range(2)]
    return Info(
        frames=clip.frames,
        rate=clip.rate,
        seconds=round(clip.duration, 6),
        origin=clip.header.origin,
        human=clip.header.human,
        frame=clip.header.frame,
        keyframes=clip.header.times or (),
        way=_rounded(np.linalg.norm(np.diff(level, axis=0), axis=-1).sum()),
        moved=_rounded(np.linalg.norm(level[-1] - level[0])),
        turned_deg=_rounded(_turned(clip.rotations, clip.root)),
        hips=(_rounded(clip.root[:, 2].min()), _rounded(clip.root[:, 2].max())),
        standing=(_rounded((clip.contacts[:, 0] > 0.5).mean()), _rounded((clip.contacts[:, 1] > 0.5).mean())),
        steps=(len(down[0]), len(down[1])),
        turning_deg={LINKS[link]: _rounded(spread[link]) for link in most if spread[link] > 0.5},
        importance={name: _rounded(value) for name, value in importance.items() if value > 0.0},
        targets={name: _rounded(share) for name, share in zip(_ROWS, weights, strict=True) if share > 0.0},
        targets_relative_to=clip.header.targets if weights.any() else "",
    )


def _rounded(value: Any) -> float:
    return round(float(value), 4) + 0.0


def _turned(rotations: Array, root: Array) -> float:
    """By how much the hips' heading turns to the left over all frames, degrees; more than one turn counts on."""
    _, headings = floor_frame(rotations, root)
    turns = to_rotation_vector(multiply(conjugate(headings[:-1]), headings[1:]))
    return float(np.degrees(turns[:, 2].sum()))


def _spread(rotations: Array) -> Array:
    """How far each joint (43,) gets from where it is in the first frame, degrees."""
    away = to_rotation_vector(multiply(conjugate(rotations[:1]), rotations))
    return np.degrees(np.linalg.norm(away, axis=-1).max(axis=0))
