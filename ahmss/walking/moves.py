"""Footsteps from one stance to another near by: as few as turn and reach allow without a foot treading on the other.

A person who turns by much on little room takes more and smaller steps: no foot lands turned by more than 75 degrees
against the other, and none where the other stands.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.walking.footsteps import LEFT, RIGHT, Frame

__all__ = ["Feet", "Placed", "footsteps"]

_OPEN = np.radians(75.0)  # how far a foot may land turned from the other
_CLEAR = 0.09  # metres from the middle of one sole to that of the other: two feet's half widths
_PASSED = 0.065  # the same in passing, when one of them is in the air
_ACROSS = 0.05  # metres that a foot lands on its own side of the other: walks are turned off their clips' ways
_FOLLOWS = 0.6  # of a foot's turn that the body has made when it lands; the rest with the other foot
_WIDER = (1.0, 1.35, 1.7)  # how far apart feet stand in between, of as they stand at last
_WIDEST = (*_WIDER, 2.1, 2.5)  # so that legs need not cross, unless one turns by more than
_ROUND = np.radians(135.0)  # what is better done in a footstep more
_BACK = (0.0, 0.05, -0.05)  # metres by which they stand behind or ahead of it
_MOST = 6
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
                found.append((min(clear, 0.0) - 0.02 * _leading(body, goal, first, count), placed))
        best = max([*found, *([best] if best is not None else [])], key=lambda one: one[0])
        if _clearance(feet, standing, body.heading, best[1]) >= 0.0:
            return best[1]
    assert best is not None
    return best[1]


def _sequences(
    feet: Feet, standing: tuple[Frame, Frame], body: Frame, goal: Frame, count: int, first: int
) -> Iterator[list[Placed]]:
    """Ways to do it in so many footsteps: those between stand wider, or further back."""
    widths = _WIDEST if abs(goal.heading - body.heading) < _ROUND else _WIDER
    for wider in widths if count > 2 else (1.0,):
        for back in _BACK if count > 2 else (0.0,):
            headings = [standing[0].heading - feet.own[0].heading, standing[1].heading - feet.own[1].heading]
            placed: list[Placed] = []
            for i in range(count):
                foot = first if i % 2 == 0 else 1 - first
                share = min((i + 1) / (count - 1), 1.0)
                frame = Frame(
                    body.x + share * (goal.x - body.x), body.y + share * (goal.y - body.y),
                    body.heading + share * (goal.heading - body.heading),
                )  # fmt: skip
                landing = feet.beside(frame, foot) if share == 1.0 else feet.beside(frame, foot, wider, back)
                headings[foot] = frame.heading
                other = headings[1 - foot]
                last = i == count - 1
                placed.append(
                    Placed(foot, landing, goal.heading if last else other + _FOLLOWS * (frame.heading - other))
                )
            yield placed


def _clearance(feet: Feet, standing: tuple[Frame, Frame], heading: float, placed: Sequence[Placed]) -> float:
    """By how much the worst of the footsteps is clear of the other foot, metres; below 0 it is not."""
    now, worst, body = list(standing), np.inf, heading
    for one in placed:
        own, other = now[one.foot], now[1 - one.foot]
        relative = one.landing.heading - feet.own[one.foot].heading - (other.heading - feet.own[1 - one.foot].heading)
        worst = min(worst, feet.apart(one.landing, other) - _CLEAR, 0.2 * (_OPEN - abs(relative)))
        worst = min(worst, _uncrossed(one, other) - _ACROSS)
        for between in _swing(own, one.landing, other, body, one.body):
            worst = min(worst, feet.apart(between, other) - _PASSED)
        now[one.foot], body = one.landing, one.body
    return float(worst)


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
