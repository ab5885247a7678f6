"""Others on the floor, as a walker sees them: where they are, how they go, and where they will soon be.

Hips go faster and slower, and from side to side, at each step: how fast somebody goes is told by the last step, which
way by where they have faced over the last stride.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from ahmss.body.array import Array
from ahmss.motion.way import AHEAD

__all__ = ["LOOKED", "MOVING", "Walker"]

LOOKED = np.arange(0.0, 2.41, 0.1)
"""Seconds: how far ahead a walker looks for others, and how finely."""

MOVING = 0.1
"""Metres a second: who is slower stands."""

_STRIDE = 1.1  # m/s, of who walks
_STOPPING = np.array([0.3, 0.8, 1.3])  # seconds in which who goes on may have stopped
_STEP, _MOMENT = 0.55, 0.15  # seconds over which a velocity is known, and in which it may have changed
_CHANGED, _SLOWING = 0.65, 0.3  # share of the speed that is a change of it; seconds in which one stops
_STRIDE_S = 1.1  # seconds of a stride
_AHEAD = np.radians(40.0)  # that one may face aside of where one goes: else one goes sideways
_TURNED = np.radians(25.0)  # that who faces so differently within a stride has turned; hips do by some 10
_FIRST = np.array([np.cos(0.6), np.sin(0.6)])  # who stands further that way goes first: any serves that no grid has
_FASTER = 0.15  # m/s in 0.4 s: who gets so much faster or slower at the end of its way goes on to
_STAYS = 0.1  # metres: who tells a way within that of where they are stands
_WEIGHTS = CubicSpline(np.append(0.0, AHEAD), np.eye(len(AHEAD) + 1), bc_type="natural")  # of its places, between them
_LOOKED_WEIGHTS = _WEIGHTS(LOOKED)


@dataclass(frozen=True)
class Walker:
    """Somebody else on the floor: place (2,) metres, velocity (2,) metres a second; whether they are about to stop.

    name: what a person is told of them by; "" where it is not known. way: (6, 2) where they tell that they will be, as
    `ahmss.motion.way` has it; None: they tell none, and it is guessed.
    """

    place: Array
    velocity: Array
    stops: bool = False
    name: str = ""
    way: Array | None = None

    @classmethod
    def of(
        cls, seconds: Array, places: Array, name: str = "", faced: Array | None = None, way: Array | None = None
    ) -> Walker:
        """From where they were (n, 2) at times (n,), rising, the last one now.

        Who has just become much faster or slower is taken at the last moments' velocity.

        Args:
            seconds, places: when they were where. name: as of the walker.
            faced: (n,) which way they faced, radians; None: it is not known.
            way: (6, 2) what they told with the last place; None: nothing.
        """
        if way is not None:
            return cls(places[-1], (way[0] - places[-1]) / AHEAD[0], name=name, way=way)
        still = np.zeros(2)
        if len(places) < 2:
            return cls(places[-1], still, name=name)
        last, since = seconds[-1], np.searchsorted(seconds, seconds[-1] - np.array([_STEP, _MOMENT]) - 1e-9)
        step, moment = ((places[-1] - places[i]) / (last - seconds[i]) if i < len(places) - 1 else still for i in since)
        usual, now = np.linalg.norm(step), np.linalg.norm(moment)
        stops = bool(now < _CHANGED * usual)
        velocity = moment if stops or usual < _CHANGED * now else step
        course = None if faced is None else _course(seconds, faced, velocity)
        if course is not None:
            ahead = np.array([np.cos(course), np.sin(course)])
            velocity = float(velocity @ ahead) * ahead
        return cls(places[-1], velocity, stops, name)

    def after(self, seconds: Array) -> Array:
        """Where they will be (..., 2): by what they tell, beyond which they go on as at its end; else as they go.

        Who gets faster at the end of what they tell will be at full stride, who gets slower stops.
        """
        if self.way is not None:
            places = np.vstack([self.place, self.way])
            if seconds is LOOKED:
                return _LOOKED_WEIGHTS @ places
            last, before = (np.diff(self.way[-3:], axis=0) / (AHEAD[-1] - AHEAD[-2]))[::-1]
            speed, was = float(np.linalg.norm(last)), float(np.linalg.norm(before))
            more = np.maximum(seconds - AHEAD[-1], 0.0)
            if speed > was + _FASTER and speed < _STRIDE:
                last = last * (_STRIDE / speed)
            elif speed < was - _FASTER:
                more = _SLOWING * (1.0 - np.exp(-more / _SLOWING))
            return _WEIGHTS(np.minimum(seconds, AHEAD[-1])) @ places + more[..., None] * last
        going = _SLOWING * (1.0 - np.exp(-seconds / _SLOWING)) if self.stops else seconds
        return self.place + going[..., None] * self.velocity

    def later(self, seconds: float) -> Walker:
        """As they will be after so many seconds."""
        if self.way is None:
            return replace(self, place=self.after(np.array(seconds)))
        way = self.after(seconds + np.append(0.0, AHEAD))
        return replace(self, place=way[0], velocity=(way[1] - way[0]) / AHEAD[0], way=way[1:])

    @property
    def stays(self) -> bool:
        """Whether they stand where they are, and go nowhere as far as is known."""
        if self.way is not None:
            return float(np.linalg.norm(self.way - self.place, axis=-1).max()) < _STAYS
        return float(np.linalg.norm(self.velocity)) < MOVING

    def may_go(self) -> Iterator[Walker]:
        """In which ways they may go on, who have perhaps just set out: soon at full stride, or to somewhere ahead."""
        yield self
        yield from self.may_walk()
        yield from self.may_stop(_STOPPING)

    def may_walk(self) -> Iterator[Walker]:
        """At full stride, if they go more slowly."""
        speed = float(np.linalg.norm(self.velocity))
        if self.way is None and MOVING < speed < _STRIDE:
            yield Walker(self.place, _STRIDE / speed * self.velocity)

    def may_stop(self, seconds: Array = _STOPPING[:1]) -> Iterator[Walker]:
        """Standing where they are after some of so many seconds, if they walk."""
        if self.way is None and float(np.linalg.norm(self.velocity)) > MOVING:
            for place in self.after(seconds):
                yield Walker(place, np.zeros(2))

    def precedes(self, place: Array, tie: float = 0.0) -> bool:
        """Whether they go first, of two who could, or are behind that by no more than a tie, metres."""
        return float((self.place - place) @ _FIRST) > -tie


def _course(seconds: Array, faced: Array, velocity: Array) -> float | None:
    """Which way somebody goes who goes straight, radians; None: they turn, or go sideways.

    Hips turn to and fro with each step, so it is looked at a whole stride; of who has just turned, at a step.
    """
    angle = np.unwrap(faced)
    for since in np.searchsorted(seconds, seconds[-1] - np.array([_STRIDE_S, _STEP]) - 1e-9):
        if np.ptp(angle[since:]) < _TURNED:
            course = float(angle[since:].mean())
            aside = float(np.arctan2(velocity[1], velocity[0])) - course
            return course if abs(np.arctan2(np.sin(aside), np.cos(aside))) < _AHEAD else None
    return None
