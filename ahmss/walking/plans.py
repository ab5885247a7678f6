"""The footsteps that the subject takes for each clip of the table, and which part of them is the clip."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ahmss.body.quaternion import rotate
from ahmss.body.skeleton import Skeleton
from ahmss.walking.catalogue import Key
from ahmss.walking.footsteps import LEFT, RIGHT, Footsteps, Frame, Step
from ahmss.walking.gait import Gait
from ahmss.walking.legs import foot_frames
from ahmss.walking.library import BODY, RATE
from ahmss.walking.moves import Feet, Placed, footsteps
from ahmss.walking.performer import Stand

__all__ = ["Planner", "Take"]

_FIRST_LIFT = 0.56  # seconds from the beginning until the first foot leaves the ground
_AFTER = 0.52  # seconds after the last has landed
_ASIDE, _BACK = 0.62, 0.60  # a step aside and back, of one ahead
_FAR = np.radians(105.0)  # of a turn into a way: from there on some of it is made on the spot
_BEFORE, _ROOM = 0.4, 0.115  # what of it that is, and the share of a step that feet need to pass each other
_AT_ONCE = np.radians(45.0)  # how far one turns with one foot and puts the other beside it
_RUN = 5  # straight steps before what is cut out, and after it


@dataclass(frozen=True)
class Take:
    """What is performed for a clip, and the seconds of it from `begin` to `end` that are kept.

    way: the direction, radians, in which the clip's way leads.
    """

    plan: Footsteps
    begin: float
    end: float
    way: float = 0.0


class Planner:
    """Plans for one human and one style of walking.

    Args:
        skeleton: whose lengths.
        stand: the pose that walks begin and end in.
        gait: the style.
    """

    def __init__(self, skeleton: Skeleton, stand: Stand, gait: Gait) -> None:
        self._gait = gait
        scale = float(stand.root[2])
        self.step = gait.step * scale
        self._half = 0.5 * gait.width * scale
        self._out = np.radians(gait.toe_out)
        ankles, q = foot_frames(skeleton, stand.rotations[None, :BODY], stand.root[None])
        ahead = rotate(q[0], np.array([1.0, 0.0, 0.0]))
        right, left = (
            Frame(float(ankles[0, i, 0]), float(ankles[0, i, 1]), float(np.arctan2(ahead[i, 1], ahead[i, 0])))
            for i in (RIGHT, LEFT)
        )
        self._feet = Feet((right, left), float(skeleton.soles[0, 0]), float(skeleton.soles[2, 0]))

    def take(self, key: Key) -> Take:
        """What to perform for a clip."""
        direction, facing = np.radians(key.direction), np.radians(key.facing)
        match key.kind:
            case "straight":
                return self._straight()
            case "start":
                return self._start(float(direction))
            case "end":
                return self._end(float(facing), key.stride == "small", RIGHT if key.last == "right" else LEFT)
            case "one_step":
                return self._short(float(direction), float(facing), key.stride == "small", 1)
            case "two_step":
                return self._short(float(direction), float(facing), key.stride == "small", 2)

    # The kinds

    def _straight(self) -> Take:
        placed = self._begun(0.0)
        placed += self._run(placed, 2 * _RUN)
        plan = self._timed(placed)
        landed = [step.land for step in plan.steps if step.foot == RIGHT]
        begin = landed[len(landed) // 2]
        return Take(plan, begin, begin + self._gait.frames / RATE)

    def _start(self, direction: float) -> Take:
        placed = self._begun(direction)
        plan = self._timed([*placed, *self._run(placed, _RUN, direction)])
        return Take(plan, 0.0, plan.steps[len(placed) - 1].land, direction)

    def _end(self, facing: float, small: bool, last: int) -> Take:
        placed = self._begun(0.0)
        placed += self._run(placed, 2 * _RUN if last == RIGHT else 2 * _RUN + 1)
        landed = placed[-1]
        short = (0.52 if small else 0.95) * (1.0 - 0.4 * abs(facing) / np.pi)
        body = Frame(landed.landing.x - self._feet.own[0].x, 0.0, 0.0)
        goal = Frame(body.x + short * self.step, 0.0, facing)
        own, other = placed[-1].landing, placed[-2].landing
        standing = (own, other) if last == RIGHT else (other, own)
        closing = footsteps(self._feet, standing, body, goal, 2, 1 - last)
        plan = self._timed([*placed, *closing])
        return Take(plan, plan.steps[len(placed) - 1].land, plan.seconds)

    def _short(self, direction: float, facing: float, small: bool, steps: int) -> Take:
        turn = float((direction + facing + np.pi - 1e-9) % (2.0 * np.pi) - np.pi + 1e-9)
        if abs(abs(turn) - np.pi) < 1e-6:
            turn = np.pi if facing >= 0.0 else -np.pi
        length = {1: (0.80, 0.42), 2: (1.70, 0.90)}[steps][small] * self.step
        length *= _ellipse(direction - 0.5 * turn) * (1.0 - (0.6 if small else 0.35) * abs(turn) / np.pi)
        goal = Frame(float(length * np.cos(direction)), float(length * np.sin(direction)), turn)
        least = 3 if abs(turn) > _AT_ONCE else steps + 1
        plan = self._timed(footsteps(self._feet, self._feet.own, Frame(0.0, 0.0, 0.0), goal, least))
        return Take(plan, 0.0, plan.seconds, direction)

    # Footsteps

    def _begun(self, direction: float) -> list[Placed]:
        """The first two steps, left and right, turning into the way; some of a far turn is made on the spot before."""
        turning: list[Placed] = []
        since = 0.0
        if abs(direction) > _FAR:
            since = _BEFORE * direction
            room, way = _ROOM * self.step, 0.5 * direction
            turned = Frame(float(room * np.cos(way)), float(room * np.sin(way)), since)
            turning = footsteps(self._feet, self._feet.own, Frame(0.0, 0.0, 0.0), turned, 2, LEFT, even=True)
        share = abs(direction - since) / np.pi
        middle = 0.5 * (since + direction)
        s1 = 0.88 * (1.0 - 0.6 * share) * self.step
        s2 = s1 + (1.0 - 0.3 * share) * self.step
        cos, sin = np.cos(direction), np.sin(direction)
        first = Frame(s1 * cos, s1 * sin, middle).then(self._feet.own[0].x * np.cos(middle - direction), self._half)
        second = Frame(s2 * cos, s2 * sin, direction).then(self._feet.own[0].x, -self._half)
        return [
            *turning,
            Placed(LEFT, replace(first, heading=middle + self._out), middle),
            Placed(RIGHT, replace(second, heading=direction - self._out), direction),
        ]

    def _run(self, placed: Sequence[Placed], count: int, direction: float = 0.0) -> list[Placed]:
        """So many straight steps more."""
        cos, sin = np.cos(direction), np.sin(direction)
        along = placed[-1].landing.x * cos + placed[-1].landing.y * sin
        out: list[Placed] = []
        foot = placed[-1].foot
        for _ in range(count):
            foot, along = 1 - foot, along + self.step
            sign = 1.0 if foot == LEFT else -1.0
            place = Frame(along * cos, along * sin, direction).then(0.0, sign * self._half, sign * self._out)
            out.append(Placed(foot, place, direction))
        return out

    # Times

    def _timed(self, placed: Sequence[Placed]) -> Footsteps:
        """The steps with their times, and how much heel rises and strikes there are."""
        standing, body, at = list(self._feet.own), 0.0, _FIRST_LIFT
        out: list[Step] = []
        for one in placed:
            own, other = standing[one.foot], standing[1 - one.foot]
            mean = 0.5 * (body + one.body)
            behind = _along(other, own, mean) / self.step
            way = _along(one.landing, own, mean) / self.step
            strike = float(np.clip(_along(one.landing, other, one.body) / self.step, 0.0, 1.0))
            push = float(np.clip(0.65 * behind + 0.35 * way, 0.0, 1.0)) if way > 0.0 else 0.0
            moved = float(np.hypot(one.landing.x - own.x, one.landing.y - own.y))
            full = min(max(moved / (1.9 * self.step), abs(one.body - body) / 1.6), 1.0)
            swing = (self._gait.frames - self._gait.both) / RATE * (0.77 + 0.23 * full)
            both = self._gait.both / RATE + 0.04 * (1.0 - min(1.0, moved / (1.6 * self.step)))
            lift = at if not out else out[-1].land + both
            lift, land = round(lift * RATE) / RATE, round((lift + swing) * RATE) / RATE
            out.append(Step(one.foot, one.landing, lift, land, one.body, push, strike))
            standing[one.foot] = one.landing
            body = one.body
        return Footsteps(self._feet.own, 0.0, out, out[-1].land + _AFTER)


def _along(a: Frame, b: Frame, heading: float) -> float:
    """How far a is ahead of b in a heading."""
    return float((a.x - b.x) * np.cos(heading) + (a.y - b.y) * np.sin(heading))


def _ellipse(angle: float) -> float:
    """How far people step in a direction from where they face, of a step ahead."""
    ahead = 1.0 if np.cos(angle) >= 0.0 else _BACK
    return float(1.0 / np.hypot(np.cos(angle) / ahead, np.sin(angle) / _ASIDE))
