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
from ahmss.walking.performer import Stand

__all__ = ["Planner", "Take"]

_FIRST_LIFT = 0.62  # seconds from the beginning until the first foot leaves the ground
_AFTER = 0.85  # seconds after the last has landed
_OPEN = np.radians(85.0)  # how far a foot may land turned from the one that bears; more is a pivot on its toe
_FOLLOWS = 0.6  # of a turn that the body has made when the foot that leads it lands; the rest with the other foot
_ASIDE, _BACK = 0.62, 0.60  # a step aside and back, of one ahead
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


@dataclass(frozen=True)
class _Placed:
    """A footstep without its times: a foot, where it lands, the body's heading then, the other foot's pivot."""

    foot: int
    landing: Frame
    body: float
    pivot: float = 0.0


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
        self._toe = float(skeleton.soles[2, 0])
        ankles, q = foot_frames(skeleton, stand.rotations[None, :BODY], stand.root[None])
        ahead = rotate(q[0], np.array([1.0, 0.0, 0.0]))
        self._feet = tuple(
            Frame(float(ankles[0, i, 0]), float(ankles[0, i, 1]), float(np.arctan2(ahead[i, 1], ahead[i, 0])))
            for i in (RIGHT, LEFT)
        )

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
        return Take(plan, 0.0, plan.steps[1].land, direction)

    def _end(self, facing: float, small: bool, last: int) -> Take:
        placed = self._begun(0.0)
        placed += self._run(placed, 2 * _RUN if last == RIGHT else 2 * _RUN + 1)
        landed = placed[-1]
        short = (0.52 if small else 0.95) * (1.0 - 0.4 * abs(facing) / np.pi)
        goal = Frame(landed.landing.x + short * self.step - self._feet[0].x, 0.0, facing)
        placed += self._closed(goal, 1 - last, landed.landing.heading, 0.0)
        plan = self._timed(placed)
        return Take(plan, plan.steps[-3].land, plan.seconds)

    def _short(self, direction: float, facing: float, small: bool, steps: int) -> Take:
        turn = float((direction + facing + np.pi - 1e-9) % (2.0 * np.pi) - np.pi + 1e-9)
        if abs(abs(turn) - np.pi) < 1e-6:
            turn = np.pi if facing >= 0.0 else -np.pi
        length = {1: (0.80, 0.42), 2: (1.70, 0.90)}[steps][small] * self.step
        length *= _ellipse(direction - 0.5 * turn) * (1.0 - 0.35 * abs(turn) / np.pi)
        goal = Frame(float(length * np.cos(direction)), float(length * np.sin(direction)), turn)
        lead = self._leader(goal, steps)
        if steps == 1:
            return self._whole(self._closed(goal, lead, self._feet[1 - lead].heading, 0.5), direction)
        middle = Frame(0.5 * goal.x, 0.5 * goal.y, 0.5 * turn)
        first = _Placed(lead, self._beside(middle, lead), _FOLLOWS * middle.heading)
        rest = self._closed(goal, 1 - lead, first.landing.heading, 0.0)
        return self._whole([first, *rest], direction)

    def _whole(self, placed: list[_Placed], direction: float) -> Take:
        plan = self._timed(placed)
        return Take(plan, 0.0, plan.seconds, direction)

    # Footsteps

    def _begun(self, direction: float) -> list[_Placed]:
        """The first two steps, left and right, turning into the way."""
        share = abs(direction) / np.pi
        middle = 0.5 * direction
        s1 = 0.88 * (1.0 - 0.6 * share) * self.step
        s2 = s1 + (1.0 - 0.3 * share) * self.step
        cos, sin = np.cos(direction), np.sin(direction)
        first = Frame(s1 * cos, s1 * sin, middle).then(self._feet[0].x * np.cos(middle - direction), self._half)
        second = Frame(s2 * cos, s2 * sin, direction).then(self._feet[0].x, -self._half)
        return [
            _Placed(LEFT, replace(first, heading=middle + self._out), middle),
            _Placed(RIGHT, replace(second, heading=direction - self._out), direction),
        ]

    def _run(self, placed: Sequence[_Placed], count: int, direction: float = 0.0) -> list[_Placed]:
        """So many straight steps more."""
        cos, sin = np.cos(direction), np.sin(direction)
        along = placed[-1].landing.x * cos + placed[-1].landing.y * sin
        out: list[_Placed] = []
        foot = placed[-1].foot
        for _ in range(count):
            foot, along = 1 - foot, along + self.step
            sign = 1.0 if foot == LEFT else -1.0
            place = Frame(along * cos, along * sin, direction).then(0.0, sign * self._half, sign * self._out)
            out.append(_Placed(foot, place, direction))
        return out

    def _closed(self, goal: Frame, lander: int, standing: float, early: float) -> list[_Placed]:
        """One foot lands at the goal, the other beside it; what is too far to turn at once is turned on a toe.

        Args:
            goal: the human's frame at the end.
            lander: the foot that lands first.
            standing: the other's heading meanwhile.
            early: which share of what is too far the other turns on its toe before; the lander does the rest.
        """
        landing = self._beside(goal, lander)
        far = landing.heading - standing
        excess = float(np.sign(far) * max(abs(far) - _OPEN, 0.0))
        between = standing + _FOLLOWS * (goal.heading - standing)
        if not excess:
            return [
                _Placed(lander, landing, between),
                _Placed(1 - lander, self._beside(goal, 1 - lander), goal.heading),
            ]
        late = (1.0 - early) * excess
        return [
            _Placed(lander, landing.pivoted(self._toe, -late), between - 0.5 * late, excess - late),
            _Placed(1 - lander, self._beside(goal, 1 - lander), goal.heading, late),
        ]

    def _beside(self, frame: Frame, foot: int) -> Frame:
        """Where a foot stands in a standing human's frame."""
        own = self._feet[foot]
        return frame.then(own.x, own.y, own.heading)

    def _leader(self, goal: Frame, steps: int) -> int:
        """Which foot goes first: towards the side of the way and of the turn, the left where neither says."""
        cost = {LEFT: 0.0, RIGHT: 1e-3}
        for foot, sign in ((LEFT, 1.0), (RIGHT, -1.0)):
            cost[foot] += max(-sign * goal.y, 0.0) / self.step / steps + 0.6 * max(-sign * goal.heading, 0.0)
        return min(cost, key=lambda foot: cost[foot])

    # Times

    def _timed(self, placed: Sequence[_Placed]) -> Footsteps:
        """The steps with their times, and how much heel rises and strikes there are."""
        standing, body, at = list(self._feet), 0.0, _FIRST_LIFT
        out: list[Step] = []
        for one, following in zip(placed, [*placed[1:], None], strict=True):
            own, other = standing[one.foot], standing[1 - one.foot]
            mean = 0.5 * (body + one.body)
            behind = _along(other, own, mean) / self.step
            way = _along(one.landing, own, mean) / self.step
            strike = float(np.clip(_along(one.landing, other, one.body) / self.step, 0.0, 1.0))
            if following is not None and following.pivot:
                strike = 0.0  # what turns on its toe lands flat
            push = float(np.clip(0.65 * behind + 0.35 * way, 0.0, 1.0)) if way > 0.0 else 0.0
            moved = float(np.hypot(one.landing.x - own.x, one.landing.y - own.y))
            full = min(max(moved / (1.9 * self.step), abs(one.body - body) / 1.6), 1.0)
            swing = (self._gait.frames - self._gait.both) / RATE * (0.82 + 0.18 * full)
            both = self._gait.both / RATE + 0.10 * (1.0 - min(1.0, moved / (1.6 * self.step)))
            lift = at if not out else out[-1].land + both
            lift, land = round(lift * RATE) / RATE, round((lift + swing) * RATE) / RATE
            out.append(Step(one.foot, one.landing, lift, land, one.body, push, strike, one.pivot))
            standing[one.foot] = one.landing
            if one.pivot:
                standing[1 - one.foot] = other.pivoted(self._toe, one.pivot)
            body = one.body
        return Footsteps((self._feet[0], self._feet[1]), 0.0, out, out[-1].land + _AFTER)


def _along(a: Frame, b: Frame, heading: float) -> float:
    """How far a is ahead of b in a heading."""
    return float((a.x - b.x) * np.cos(heading) + (a.y - b.y) * np.sin(heading))


def _ellipse(angle: float) -> float:
    """How far people step in a direction from where they face, of a step ahead."""
    ahead = 1.0 if np.cos(angle) >= 0.0 else _BACK
    return float(1.0 / np.hypot(np.cos(angle) / ahead, np.sin(angle) / _ASIDE))
