"""Footsteps from one stance to another near by: as few as turn and reach allow without a foot treading on the other.

A person who turns by much on little room takes more and smaller steps: no foot lands turned by more than 75 degrees
against the other, and none where the other stands.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from ahmss.body.array import Array
from ahmss.walking.footsteps import LEFT, RIGHT, Frame

__all__ = ["Feet", "Placed", "footsteps"]

_OPEN, _CLOSED = np.radians(75.0), np.radians(61.0)  # how far a foot may land turned out from the other; and in
# Of its share of a turn: the foot that turns out is ahead, the other behind.
_SOONER, _LATER = (1.0, 1.1, 1.25), (1.0, 0.9, 0.75)
_CLEAR = 0.09  # metres from the middle of one sole to that of the other: two feet's half widths
_PASSED = 0.065  # the same in passing, when one of them is in the air
_ACROSS = 0.05  # metres that a foot lands on its own side of the other: walks are turned off their clips' ways
_FOLLOWS = 0.6  # of a foot's turn that the body has made when it lands; the rest with the other foot
_WIDER = (1.0, 1.35, 1.7)  # how far apart feet stand in between, of as they stand at last
_WIDEST = (*_WIDER, 2.1, 2.5)  # so that legs need not cross, unless one turns by more than
_ROUND = np.radians(135.0)  # what is better done in a footstep more
_BACK = (0.0, 0.05, -0.05)  # metres by which they stand behind or ahead of it
_BENT, _TURNS = 0.25, 0.6  # metres that this knee is ahead of its ankle; of a foot's turn, what its knee makes
_KNEES = 0.12, 0.24  # metres that a knee keeps from the other leg: at least, and if it can
_EASY = np.radians(40.0)  # how far a foot turns in, if it can
_MOST = 6
_SLIGHT = 1e-9
_TURNED = 0.35  # metres that a radian of turn in one step counts, where the foot that leads is chosen
_SWING = np.linspace(0.0, 1.0, 10)[1:-1]


@dataclass(frozen=True)
class Placed:
    """A footstep without its times: a foot, where it lands, the body's heading then."""

    foot: int
    landing: Frame
    body: float


@dataclass(frozen=True)
class Feet:
    """How a human's feet are. own: right and left against the standing human's frame; heel, toe: ahead of the ankle."""

    own: tuple[Frame, Frame]
    heel: float
    toe: float

    def beside(self, frame: Frame, foot: int, wider: float = 1.0, back: float = 0.0) -> Frame:
        """Where a foot stands in a standing human's frame."""
        own = self.own[foot]
        return frame.then(own.x - back, own.y * wider, own.heading)

    def apart(self, one: Frame, other: Frame) -> float:
        """How near the middles of two soles come to each other, metres; 0 where one is across the other."""
        a, b = self._line(one), self._line(other)
        u, v = a[1] - a[0], b[1] - b[0]
        sides = (_cross(u, b[0] - a[0]) * _cross(u, b[1] - a[0]), _cross(v, a[0] - b[0]) * _cross(v, a[1] - b[0]))
        if max(sides) < 0.0:
            return 0.0
        return min(_away(point, line) for line, points in ((a, b), (b, a)) for point in points)

    def _line(self, foot: Frame) -> Array:
        return np.stack([foot.then(self.heel, 0.0).place, foot.then(self.toe, 0.0).place])


def footsteps(
    feet: Feet,
    standing: tuple[Frame, Frame],
    body: Frame,
    goal: Frame,
    least: int,
    lead: int | None = None,
    *,
    even: bool = False,
) -> list[Placed]:
    """The footsteps that bring both feet beside each other at a goal.

    Args:
        feet: of the human.
        standing: right and left, as they stand now.
        body: where the body is now, and its heading.
        goal: the standing human's frame at the end; its heading says which way round one turns.
        least: how many footsteps at least.
        lead: the foot that goes first; None: either.
        even: only an even number of them will do, so that the other foot lands last.
    """
    best: tuple[float, list[Placed]] | None = None
    for count in range(least, _MOST + 1):
        if even and count % 2:
            continue
        found: list[tuple[float, list[Placed]]] = []
        for first in (LEFT, RIGHT) if lead is None else (lead,):
            for placed in _sequences(feet, standing, body, goal, count, first):
                clear = _clearance(feet, standing, body.heading, placed)
                worth = min(clear, 0.0) - 0.02 * _leading(body, goal, first, count)
                ease = _ease(feet, standing, body.heading, placed) if clear >= -_SLIGHT else -np.inf
                found.append((worth + 0.1 * max(ease, -1.0), placed))
                if ease >= 0.0:
                    break
        best = max([*found, *([best] if best is not None else [])], key=lambda one: one[0])
        if _clearance(feet, standing, body.heading, best[1]) >= -_SLIGHT:
            return best[1]
    assert best is not None
    return best[1]


def _sequences(
    feet: Feet, standing: tuple[Frame, Frame], body: Frame, goal: Frame, count: int, first: int
) -> Iterator[list[Placed]]:
    """Ways to do it in so many footsteps: those between stand wider, or further back, or turn sooner."""
    turn = goal.heading - body.heading
    widths = _WIDEST if abs(turn) < _ROUND else _WIDER
    ways = product(_SOONER, _LATER, widths, _BACK) if count > 2 else [(1.0, 1.0, 1.0, 0.0)]
    for sooner, later, wider, back in ways:
        headings = [standing[0].heading - feet.own[0].heading, standing[1].heading - feet.own[1].heading]
        placed: list[Placed] = []
        for i in range(count):
            foot = first if i % 2 == 0 else 1 - first
            share = min((i + 1) / (count - 1), 1.0)
            out = (foot == LEFT) == (turn > 0.0)
            turned = min(share * (sooner if out else later), 1.0) if share < 1.0 else 1.0
            frame = Frame(
                body.x + share * (goal.x - body.x), body.y + share * (goal.y - body.y), body.heading + turned * turn
            )  # fmt: skip
            landing = feet.beside(frame, foot) if share == 1.0 else feet.beside(frame, foot, wider, back)
            headings[foot] = frame.heading
            other = headings[1 - foot]
            last = i == count - 1
            placed.append(Placed(foot, landing, goal.heading if last else other + _FOLLOWS * (frame.heading - other)))
        yield placed


def _clearance(feet: Feet, standing: tuple[Frame, Frame], heading: float, placed: Sequence[Placed]) -> float:
    """By how much the worst of the footsteps is clear of the other foot, metres; below 0 it is not."""
    now, worst = list(standing), np.inf
    for one in placed:
        other = now[1 - one.foot]
        outwards = _outwards(feet, one, other)
        worst = min(worst, 0.2 * (_OPEN - outwards), 0.2 * (_CLOSED + outwards), _uncrossed(one, other) - _ACROSS)
        worst = min(worst, feet.apart(one.landing, other) - _CLEAR)
        now[one.foot] = one.landing
    if worst < -_SLIGHT:
        return float(worst)  # feet that stand badly: it does not matter how they get there
    now, body = list(standing), heading
    for one in placed:
        own, other = now[one.foot], now[1 - one.foot]
        worst = min(worst, _knee_apart(feet, one.foot, own, other, body) - _KNEES[0])
        for between in _swing(own, one.landing, other, body, one.body):
            worst = min(worst, feet.apart(between, other) - _PASSED)
        now[one.foot], body = one.landing, one.body
    return float(worst)


def _ease(feet: Feet, standing: tuple[Frame, Frame], heading: float, placed: Sequence[Placed]) -> float:
    """How easily it is done, metres: below 0 where a foot stands turned in or a knee comes near the other leg."""
    now, body, worst = list(standing), heading, 0.0
    for one in placed:
        own, other = now[one.foot], now[1 - one.foot]
        worst = min(worst, _knee_apart(feet, one.foot, own, other, body) - _KNEES[1])
        worst = min(worst, 0.2 * (_EASY + _outwards(feet, one, other)))
        now[one.foot], body = one.landing, one.body
    return worst


def _knee_apart(feet: Feet, foot: int, own: Frame, other: Frame, body: float) -> float:
    """How near the knee of a foot that leaves the ground is to the other leg, metres.

    It turns partly with the foot, which may still be turned in, and partly with the body.
    """
    heading = body + _TURNS * (own.heading - feet.own[foot].heading - body)
    return float(np.linalg.norm(own.place + _BENT * np.array([np.cos(heading), np.sin(heading)]) - other.place))


def _outwards(feet: Feet, one: Placed, other: Frame) -> float:
    """By how much a foot lands turned out from the other, radians."""
    relative = one.landing.heading - feet.own[one.foot].heading - (other.heading - feet.own[1 - one.foot].heading)
    return relative if one.foot == LEFT else -relative


def _uncrossed(one: Placed, other: Frame) -> float:
    """How far a foot lands to its own side of the other, metres; below 0 the legs are crossed."""
    across = np.cos(one.body) * (one.landing.y - other.y) - np.sin(one.body) * (one.landing.x - other.x)
    return float(across if one.foot == LEFT else -across)


def _swing(own: Frame, landing: Frame, other: Frame, since: float, until: float) -> Iterator[Frame]:
    """Where a foot is on its way, about the foot that bears and turning with the body."""
    turn = until - since
    a = own.place - other.place
    b = _turned(landing.place - other.place, -turn)
    for u in _SWING.tolist():
        share = u * u * u * (10.0 + u * (6.0 * u - 15.0))
        place = other.place + _turned(a + share * (b - a), share * turn)
        yield Frame(float(place[0]), float(place[1]), own.heading + share * (landing.heading - own.heading))


def _leading(body: Frame, goal: Frame, first: int, count: int) -> float:
    """What speaks against a foot's going first: the way and the turn lead to the other's side."""
    sign = 1.0 if first == LEFT else -1.0
    aside = -np.sin(body.heading) * (goal.x - body.x) + np.cos(body.heading) * (goal.y - body.y)
    turn = goal.heading - body.heading
    return float(max(-sign * aside, 0.0) + _TURNED * max(-sign * turn, 0.0)) / (count - 1) + (
        1e-3 if first == RIGHT else 0.0
    )


def _turned(v: Array, angle: float) -> Array:
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([cos * v[0] - sin * v[1], sin * v[0] + cos * v[1]])


def _cross(a: Array, b: Array) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def _away(point: Array, line: Array) -> float:
    """How far a point (2,) is from a stretch (2, 2)."""
    way = line[1] - line[0]
    share = np.clip((point - line[0]) @ way / (way @ way), 0.0, 1.0)
    return float(np.linalg.norm(point - line[0] - share * way))
