"""What a walker may do about others in its way, from the present step on, and what each would cost.

It may go on, go slower, pass on the right or the left, both at once, or stop. Others are taken to go where they tell
that they will be; who tells nothing, to go on as they do, or to stop. The figures are judged, not measured: people pass
each other's middles at 0.6 m or more, would rather turn a little than stop, and pass oncoming ones on the right.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.walking.course import Course, NoWay
from ahmss.walking.turning_in import SHORTEST, cut, turned_into
from ahmss.walking.walkers import LOOKED, MOVING, Walker

__all__ = ["MET", "SAFE", "Option", "held_up", "least", "meets", "met", "options", "yields"]

MET = 0.72  # metres apart at which one makes way
SAFE = 0.68  # metres apart at least from where others tell that they will be, if it can be had
_APART = 0.78  # metres that two walkers' middles shall keep apart where one goes round the other
_LATER = 0.4  # seconds: the other may be met so much sooner or later
_ASIDE = 0.1  # metres by which the other is taken to be more to the side on which it is not passed
_PASSING = 1.5  # metres: who gets no nearer is not gone round
_SLOWER = (0.85, 0.7)  # shares of the speed
_TURNED, _LEFT, _SLOWED, _STOPPED, _LONGER = 0.3, 0.15, 1.6, 1.6, 0.6  # costs; the last one a metre
_SERVES = 2.0  # what costs less serves: no more ways are looked for on that side
_SHARP = 0.3  # what it costs to turn as sharply as one can
_DODGED = 0.55  # metres to a side, out of the way of who is too near to be gone round
_CHANGES = 1.2  # what it costs to pass on another side than one has begun to
_HARD, _SOFT = 1.0, 0.6  # what a stop in less than so many metres costs more, a metre
_RISK, _LASTING = 0.1, 0.5  # metres nearer than MET that cost 1, twice as many 4; and a second of it
_LIKELY = 0.8  # how much it counts that who walks may stop
_SURE, _UNSURE = (0.8, 2.4), (1.0, 0.5)  # how much it counts (the latter) after so many seconds that who walks goes on
_SWAY = 0.09  # metres that hips go to a side before a step: one comes no nearer by it
_HARDLY = 0.03  # metres that one who tells where they go is to come nearer to count
_HEELS, _LEAST = 0.3, 1e-3  # metres that who is followed needs more; less than that in 0.1 s is no direction
_CLOSE, _TURNS, _TOUCHING = 0.78, 0.2, 0.42  # metres: who is so near may come so much nearer in turning, to leave
_COMMITTED, _SET_OUT = 0.5, 0.8  # m/s: slower ones may still call off a start; slower ones may go any way
_LAG = 0.06  # seconds by which others are seen late: of two of whom either may be ahead then, both yield
_OTHERWISE = 0.08  # metres by which a way that has been changed differs
_BETTER = 0.03  # metres more room that one is to have by taking a way back
_SLACK = 0.85  # seconds sooner or later, at which who stands lets who walks pass
_REACHED = 1.7  # metres from one's way within which who sets out may come into it


@dataclass(frozen=True)
class Option:
    """What a walker may do: a course from where it is, the share of its speed, whether it stops there; its cost.

    side: on which it passes others, 1 the right, -1 the left; 0: on neither.
    """

    course: Course
    slow: float
    stops: bool
    cost: float
    side: float = 0.0


def least(own: Array, others: Sequence[Walker]) -> float:
    """How near somebody comes (metres) to a walker who is at `own` (n, 2) at the times LOOKED, or longer.

    Who comes no nearer than they are now does not count.
    """
    return min((float(away.min()) for away in _approaching(own, others)), default=np.inf)


def meets(own: Array, others: Sequence[Walker]) -> bool:
    """Whether somebody comes too near if they go on, or may come so if they stop."""
    return least(own, [way for other in others for way in (other, *other.may_walk(), *other.may_stop())]) < MET


def held_up(own: Array, others: Sequence[Walker], nearer: float = 0.0, *, begun: bool, tired: bool = False) -> bool:
    """Whether one should not set out along `own` (n, 2), as others come into the way, or may, who tell no way.

    Who sets out and tells none may go anywhere: one waits for them.

    Args:
        own: where one would be at the times LOOKED and, as finely, after. others: who is about.
        nearer: metres less than MET that serve.
        begun: whether one has begun and could call it off.
        tired: whether one has waited long, and takes who is slow for one who stands.
    """
    ways: list[Walker] = []
    for other in others:
        if other.way is not None:
            ways.append(other)
            continue
        if not begun and _crosses(other, own) < MET - nearer:
            return True
        speed, way = float(np.linalg.norm(other.velocity)), other.place - own[0]
        if speed < _COMMITTED and tired:
            ways.append(Walker(other.place, np.zeros(2)))
            continue
        walks = not other.stops and speed >= _SET_OUT and way @ (own[-1] - own[0]) > 0.0
        if walks and np.linalg.norm(own - other.place, axis=-1).min() < _REACHED:
            return True
        ways.extend(other.may_go())
    return least(own, ways) < MET - nearer


def yields(own: Array, instead: Array, others: Sequence[Walker], before: Sequence[Walker]) -> list[Walker]:
    """For whom one who has just told a new way takes it back, as they go first and did so at the same time.

    Also for who has taken theirs back in that time, and stays.

    Args:
        own: where one would be (n, 2) at the times LOOKED. instead: where one would be else.
        others: who is about now. before: the same as they would be now by what they told when one decided.
    """
    speed = float(np.linalg.norm(own[1] - own[0])) / LOOKED[1]
    near: list[tuple[float, Walker]] = []
    for i, other in enumerate(others):
        same = len(before) == len(others) and before[i].way is not None and not _differ(other, before[i])
        if other.way is None or same:
            continue
        tie = _LAG * (speed + float(np.linalg.norm(other.velocity))) if speed > MOVING else 0.0
        if other.stays or other.precedes(own[0], tie):  # who has taken theirs back, and stays, can't once more
            near.append((least(own, [other]), other))
    limit = min(SAFE, least(instead, others) - _BETTER)
    return [other for away, other in near if away < limit]


def _differ(one: Walker, other: Walker) -> bool:
    """Whether two are not one who still goes the same way."""
    return float(np.linalg.norm(one.after(LOOKED) - other.after(LOOKED), axis=-1).max()) > _OTHERWISE


def _crosses(other: Walker, own: Array) -> float:
    """How near somebody who walks comes (metres) to where one would be along `own` (n, 2), a little sooner or later.

    Infinite where they come no nearer than they are now.
    """
    if float(np.linalg.norm(other.velocity)) < MOVING:
        return np.inf
    times = _times(own)
    away = np.linalg.norm(own[:, None] - other.after(LOOKED), axis=-1)
    near = float(away[np.abs(times[:, None] - LOOKED) < _SLACK].min())
    return near if near < away[0, 0] - _SWAY else np.inf


def _approaching(own: Array, others: Sequence[Walker]) -> Iterator[Array]:
    """How far those are (n,) who come nearer: who is followed seems nearer, for their feet are behind them."""
    for other in others:
        there = other.after(_times(own))
        away = np.linalg.norm(own - there, axis=-1)
        if other.stays and away[0] < _CLOSE and away.min() > _TOUCHING:
            nearer = _TURNS
        else:
            nearer = _SWAY if other.way is None or other.stays else _HARDLY
        if not other.stays:
            away = away - _HEELS * _follows(own, there)
        if away.min() < away[0] - nearer:
            yield away


def _follows(own: Array, there: Array) -> Array:
    """How much (n,) one who is at `own` (n, 2) is behind another at `there` who goes the same way, from 0 to 1."""
    steps, theirs, towards = np.gradient(own, axis=0), np.gradient(there, axis=0), there - own
    lengths = [np.linalg.norm(way, axis=-1) + _LEAST for way in (steps, theirs, towards)]
    same = np.einsum("ni,ni->n", steps, theirs) / (lengths[0] * lengths[1])
    ahead = np.einsum("ni,ni->n", steps, towards) / (lengths[0] * lengths[2])
    return np.clip(2.0 * same - 1.0, 0.0, 1.0) * np.clip(3.0 * ahead - 2.0, 0.0, 1.0)


def _times(own: Array) -> Array:
    """The seconds of the places (n, 2) where one will be."""
    return LOOKED if len(own) == len(LOOKED) else LOOKED[1] * np.arange(len(own))


def met(own: Array, others: Sequence[Walker], side: float) -> list[tuple[float, float]]:
    """Where those are (x, y) who come too near, each moved aside: to the left where `side` is 1."""
    found: list[tuple[float, float]] = []
    for other in others:
        if least(own, [other]) < MET:
            there = other.after(_times(own))
            k = int(np.linalg.norm(own - there, axis=-1).argmin())
            way = own[min(k + 3, len(own) - 1)] - own[max(k - 3, 0)]
            way = way / max(float(np.linalg.norm(way)), 1e-9)
            found.append(tuple((there[k] + side * _ASIDE * np.array([-way[1], way[0]])).tolist()))
    return found


def options(
    own: Array, rest: Course, stops: Sequence[float], speed: float, others: Sequence[Walker],
    around: Callable[[Array, float, Sequence[tuple[float, float, float]]], Course], side: float = 0.0,
) -> list[Option]:  # fmt: skip
    """What may be done, the cheapest first.

    Args:
        own: where it will be (n, 2) at the times LOOKED if it goes on as it does.
        rest: the rest of the present course; the option of this very course at full speed is to go on as it does.
        stops: in how many metres the walker can stop.
        speed: its own, m/s.
        others: who is about.
        around: plans a way from a place and heading round circles.
        side: on which it has begun to pass them; 0: on neither. The other one is dear: they have made way for this.
    """
    found = [Option(rest, 1.0, False, _risk(own, others))]
    for slow in _SLOWER:
        found.append(Option(rest, slow, False, _SLOWED * (1.0 - slow) + _risk(_ahead(rest, slow * speed), others)))
    for length in stops:
        course = cut(rest, 0.0, length)
        hard = _HARD * max(_SOFT - length, 0.0)
        found.append(Option(course, 1.0, True, _STOPPED + hard + _risk(_ahead(course, speed, stops=True), others)))
    ways = {1.0: _TURNED, -1.0: _TURNED + _LEFT}
    if side:
        ways[-side] += _CHANGES
    for way, dear in sorted(ways.items(), key=lambda item: item[1]):
        if min(option.cost for option in found) < dear:
            break  # planning takes long, and would be of no use
        for course, sharp, speeds in _passing(rest, speed, others, around, way):
            more = dear + sharp + _LONGER * max(course.length - rest.length, 0.0)
            for slow in speeds:
                cost = more + _SLOWED * (1.0 - slow) + _risk(_ahead(course, slow * speed), others)
                found.append(Option(course, slow, False, cost, way))
            if min(option.cost for option in found) < _SERVES:
                break
    return sorted(found, key=lambda option: option.cost)


def _ahead(course: Course, speed: float, *, stops: bool = False) -> Array:
    """Where a walker will be (n, 2) on a course at the times LOOKED: at its end it stays."""
    if stops:
        slowing = np.minimum(LOOKED * speed / (2.0 * course.length), 1.0)
        return course.at(course.length * slowing * (2.0 - slowing))[0]
    return course.at(np.minimum(speed * LOOKED, course.length))[0]


def _risk(own: Array, others: Sequence[Walker]) -> float:
    """What it costs to be at `own` (n, 2) at the times LOOKED.

    Who tells no way goes on or stops, whichever costs more, and makes no way oneself: that they go on counts less
    later.
    """
    trust = np.interp(_times(own), _SURE, _UNSURE)
    risk = 0.0
    for other in others:
        if other.way is not None:
            risk += _nearness(own, other, 1.0)
            continue
        moving = float(np.linalg.norm(other.velocity)) > MOVING
        ways = [(other, trust if moving else 1.0), *((way, _LIKELY) for way in other.may_stop())]
        ways += [(way, _LIKELY * trust) for way in other.may_walk() if not other.stops]
        risk += max(_nearness(own, way, counts) for way, counts in ways)
    return risk


def _nearness(own: Array, other: Walker, counts: Array | float) -> float:
    """What it costs to come near to one who goes one way, of which each moment counts so much."""
    for away in _approaching(own, [other]):
        near = counts * (np.maximum(MET - away, 0.0) / _RISK) ** 2
        return float(near.max() + _LASTING * LOOKED[1] * near.sum())
    return 0.0


def _passing(
    rest: Course, speed: float, others: Sequence[Walker],
    around: Callable[[Array, float, Sequence[tuple[float, float, float]]], Course], side: float,
) -> Iterator[tuple[Course, float, tuple[float, ...]]]:  # fmt: skip
    """Ways round those who are met, on the right where `side` is 1, else on the left; what each costs for its bends,
    and the shares of the speed at which it is walked.

    After these some that only dodge to that side, for who is too near to be gone round.
    """
    place, heading = rest.points[0], float(rest.heading[0])
    if rest.length < SHORTEST:
        return
    ahead, aside = np.array([np.cos(heading), np.sin(heading)]), side * np.array([np.sin(heading), -np.cos(heading)])
    circles = list(_circles(rest, speed, others, side))
    for dodged, round_ in ((0.0, circles), (_DODGED, [])):
        try:
            planned = around(place + 0.3 * ahead + dodged * aside, heading, round_)
        except NoWay:
            continue
        gentle, sharp = (turned_into(place, heading, planned, soon=soon) for soon in (False, True))
        if gentle is not None:
            yield gentle, 0.0, (1.0,) if dodged else (1.0, *_SLOWER)
        if sharp is not None and (gentle is None or sharp.length != gentle.length):
            yield sharp, _SHARP, (1.0,)


def _circles(rest: Course, speed: float, others: Sequence[Walker], side: float) -> Iterator[tuple[float, float, float]]:
    """Others where they are met, each moved aside: to the left where `side` is 1."""
    own, heading = rest.at(speed * LOOKED)
    for other in others:
        away = np.linalg.norm(own - other.after(LOOKED), axis=-1)
        met = int(away.argmin())
        if away[met] > _PASSING:
            continue
        aside = side * _ASIDE * np.array([-np.sin(heading[met]), np.cos(heading[met])])
        moving = float(np.linalg.norm(other.velocity)) > MOVING
        for later in (-_LATER, 0.0, _LATER) if moving else (0.0,):
            x, y = other.after(np.array(max(LOOKED[met] + later, 0.0))) + aside
            yield float(x), float(y), _APART
