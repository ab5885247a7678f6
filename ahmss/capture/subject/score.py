"""A score: which numbers of a posture move when. What a subject performs is written so.

Each movement goes by minimum jerk from rest to rest (Flash & Hogan 1985); movements of one number that overlap add up,
as those of people do (Flash & Henis 1991), so nothing stops between them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ahmss.motion.easing import minimum_jerk
from ahmss.motion.poser import Posture

__all__ = ["Move", "Score"]

_BOTH = ("right", "left")


@dataclass(frozen=True)
class Move:
    """From one time to another, seconds, numbers of the posture go to new values.

    A number is named as the posture names it: `lean`, `right_arm.elbow`, `arms.elbow` (both arms), `hips.2` (the third
    of the hips' place).
    """

    begin: float
    end: float
    to: Mapping[str, float]


class Score:
    """A posture to begin with, and what moves from there on."""

    def __init__(self, posture: Posture, *moves: Move) -> None:
        self.posture = posture
        self._strokes: list[tuple[str, float, float, float]] = []  # name, begin, end, by how much
        reached: dict[str, float] = {}
        for move in sorted(moves, key=lambda move: move.begin):
            for name, value in _each_side(move.to):
                before = reached.get(name, _get(posture, name))
                self._strokes.append((name, move.begin, move.end, value - before))
                reached[name] = value

    def at(self, time: float) -> Posture:
        """The posture at a time, seconds."""
        values: dict[str, float] = {}
        for name, begin, end, by in self._strokes:
            done = float(minimum_jerk(np.array((time - begin) / (end - begin))))
            values[name] = values.get(name, _get(self.posture, name)) + done * by
        posture = self.posture
        for name, value in values.items():
            posture = _with(posture, name, value)
        return posture


def _each_side(numbers: Mapping[str, float]) -> list[tuple[str, float]]:
    """`arms.` as `right_arm.` and `left_arm.`; `fingers.` likewise."""
    out: list[tuple[str, float]] = []
    for name, value in numbers.items():
        part, _, rest = name.partition(".")
        names = [f"{side}_{part.removesuffix('s')}.{rest}" for side in _BOTH] if part == "arms" else [name]
        out += [(each, value) for each in names]
    return out


def _get(posture: Any, name: str) -> float:
    value = posture
    for part in name.split("."):
        value = value[int(part)] if isinstance(value, tuple) else getattr(value, part)
    return float(value)


def _with(whole: Any, name: str, value: float) -> Any:
    """A posture, or a part of one, with one number replaced."""
    part, _, rest = name.partition(".")
    if isinstance(whole, tuple):
        return tuple(value if i == int(part) else item for i, item in enumerate(whole))
    return replace(whole, **{part: _with(getattr(whole, part), rest, value) if rest else value})
