"""What a walker may do about others in its way, from the present step on, and what each would cost.

It may go on, go slower, pass on the right or the left, both at once, or stop. Others are taken to go on as they do. The
figures are judged, not measured: people pass each other's middles at 0.6 m or more, would rather turn a little than
stop, and pass oncoming ones on the right.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.walking.course import Course, NoWay
from ahmss.walking.walkers import LOOKED, MOVING, Walker

__all__ = ["MET", "Option", "cut", "goes_first", "held_up", "least", "meets", "options", "turned_into"]

MET = 0.64  # metres apart at which one makes way
_APART = 0.7  # metres that two walkers' middles shall keep apart where one goes round the other
_LATER = 0.4  # seconds: the other may be met so much sooner or later
_ASIDE = 0.1  # metres by which the other is taken to be more to the side on which it is not passed
_PASSING = 1.5  # metres: who gets no nearer is not gone round
_SLOWER = (0.85, 0.7)  # shares of the speed
_TURNED, _LEFT, _SLOWED, _STOPPED, _LONGER = 0.3, 0.15, 1.6, 1.6, 0.6  # costs; the last one a metre
_CHANGES = 1.2  # what it costs to pass on another side than one has begun to
_HARD, _SOFT = 1.0, 0.6  # what a stop in less than so many metres costs more, a metre
_RISK, _LASTING = 0.1, 0.5  # metres nearer than MET that cost 1, twice as many 4; and a second of it
_LIKELY = 0.8  # how much it counts that who walks may stop
_SURE, _UNSURE = (0.8, 2.4), (1.0, 0.4)  # how much it counts (the latter) after so many seconds that who walks goes on
_STOOD = 0.4  # how much it counts that who goes on comes near when one stands oneself: they can go round
_SWAY = 0.09  # metres that hips go to a side before a step: one comes no nearer by it
_CLOSE, _TURNS, _TOUCHING = 0.78, 0.2, 0.42  # metres: who is so near may come so much nearer in turning, to leave
_COMMITTED, _SET_OUT = 0.5, 0.8  # m/s: slower ones may still call off a start; slower ones may go any way
_TOO_NEAR, _STIRS, _RECEDES = 1.5, 0.05, 0.3  # metres; m/s: of two so near one sets out, the other when that has left
_SLACK = 0.85  # seconds sooner or later, at which who stands lets who walks pass
_REACHED = 1.7  # metres from one's way within which who sets out may come into it
_SHARPEST = 1.6  # 1/m, of a bend in which a walker turns in
_GENTLE = 0.9  # 1/m: a bend as gentle as that is not made gentler
_JOINS = (0.6, 0.9, 1.2, 1.6, 2.0, 2.6, 3.2)  # metres further on at which it may be on the other course
_SAMPLE = 0.02


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
    """How near somebody comes (metres) to a walker who is at `own` (n, 2) at the times LOOKED.

    Who comes no nearer than they are now does not count.
    """
    return min((float(away.min()) for away in _approaching(own, others)), default=np.inf)


def meets(own: Array, others: Sequence[Walker]) -> bool:
    """Whether somebody comes too near if they go on, or may come so if they stop."""
    return least(own, [way for other in others for way in (other, *other.may_walk(), *other.may_stop())]) < MET


def goes_first(own: Array, others: Sequence[Walker], beside: float) -> bool:
    """Whether somebody who stands ahead, so near (metres), is to go before one who would go along `own` (n, 2)."""
    for other in others:
        way = other.place - own[0]
        stands = np.linalg.norm(other.velocity) < MOVING and np.linalg.norm(way) < beside
        if stands and other.precedes(own[0]) and way @ (own[-1] - own[0]) > 0.0:
            return True
    return False


def held_up(own: Array, others: Sequence[Walker], nearer: float = 0.0, *, begun: bool, tired: bool = False) -> bool:
    """Whether one should not set out along `own` (n, 2, at the times LOOKED), as others may come into the way.

    Who sets out as well may go anywhere. One waits for them; but of two who begin at once one goes on.

    Args:
        own: where one would be. others: who is about.
        nearer: metres less than MET that serve.
        begun: whether one has begun and could call it off.
        tired: whether one has waited long, and takes who is slow for one who stands.
    """
    ways: list[Walker] = []
    for other in others:
        if _sets_out(other, own) and other.precedes(own[0]):
            return True
        if not begun and _crosses(other, own) < MET - nearer:
            return True
        speed, way = float(np.linalg.norm(other.velocity)), other.place - own[0]
        if speed < _COMMITTED and (tired or (begun and not other.precedes(own[0]))):
            ways.append(Walker(other.place, np.zeros(2)))
        elif other.stops or not MOVING < speed < _SET_OUT:
            ways.extend(other.may_go())
        elif way @ (own[-1] - own[0]) > 0.0 and np.linalg.norm(own - other.place, axis=-1).min() < _REACHED:
            return True
        else:
            ways.extend(other.may_go())
    return least(own, ways) < MET - nearer


def _sets_out(other: Walker, own: Array) -> bool:
    """Whether somebody near has just set out, as one would along `own` (n, 2), and has not left yet."""
    off = other.place - own[0]
    away, speed = float(np.linalg.norm(off)), float(np.linalg.norm(other.velocity))
    return away < _TOO_NEAR and _STIRS < speed < _SET_OUT and float(other.velocity @ off) < _RECEDES * away


def _crosses(other: Walker, own: Array) -> float:
    """How near somebody who walks comes (metres) to where one would be along `own` (n, 2), a little sooner or later.

    Infinite where they come no nearer than they are now.
    """
    if float(np.linalg.norm(other.velocity)) < MOVING:
        return np.inf
    times = LOOKED[: len(own)]
    away = np.linalg.norm(own[:, None] - other.after(LOOKED), axis=-1)
    near = float(away[np.abs(times[:, None] - LOOKED) < _SLACK].min())
    return near if near < away[0, 0] - _SWAY else np.inf


def _approaching(own: Array, others: Sequence[Walker]) -> Iterator[Array]:
    """How far those are (n,) who come nearer."""
    for other in others:
        away = np.linalg.norm(own - other.after(LOOKED[: len(own)]), axis=-1)
        turns = away[0] < _CLOSE and away.min() > _TOUCHING
        if away.min() < away[0] - (_TURNS if turns else _SWAY):
            yield away


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
        course = _passing(rest, speed, others, around, way)
        if course is None:
            continue
        dear += _LONGER * max(course.length - rest.length, 0.0)
        for slow in (1.0, *_SLOWER):
            cost = dear + _SLOWED * (1.0 - slow) + _risk(_ahead(course, slow * speed), others)
            found.append(Option(course, slow, False, cost, way))
    return sorted(found, key=lambda option: option.cost)


def _ahead(course: Course, speed: float, *, stops: bool = False) -> Array:
    """Where a walker will be (n, 2) on a course at the times LOOKED: at its end it stays."""
    if stops:
        slowing = np.minimum(LOOKED * speed / (2.0 * course.length), 1.0)
        return course.at(course.length * slowing * (2.0 - slowing))[0]
    return course.at(np.minimum(speed * LOOKED, course.length))[0]


def _risk(own: Array, others: Sequence[Walker]) -> float:
    """What it costs to be at `own` (n, 2) at the times LOOKED: others go on or stop, whichever costs more.

    Of those who go on it counts less later, when both can still do something, and when one stands oneself.
    """
    speed = np.linalg.norm(np.gradient(own, LOOKED[1], axis=0), axis=-1)
    trust = np.interp(LOOKED[: len(own)], _SURE, _UNSURE) * np.clip(speed, _STOOD, 1.0)
    risk = 0.0
    for other in others:
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
) -> Course | None:  # fmt: skip
    """A way round those who are met, on the right where `side` is 1, else on the left; None: there is none."""
    place, heading = rest.points[0], float(rest.heading[0])
    if rest.length < _JOINS[0]:
        return None
    since = place + 0.3 * np.array([np.cos(heading), np.sin(heading)])
    try:
        planned = around(since, heading, list(_circles(rest, speed, others, side)))
    except NoWay:
        return None
    return turned_into(place, heading, planned)


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


def cut(course: Course, since: float, length: float) -> Course:
    """So much of a course from a length on; beyond its end it goes on straight."""
    points, heading = course.at(since + np.linspace(0.0, length, max(int(np.ceil(length / _SAMPLE)), 4) + 1))
    return Course(points, heading, length)


def turned_into(place: Array, heading: float, course: Course) -> Course | None:
    """A course that leaves a place in a heading and passes over into another one; None: it would bend too sharply.

    The curve between is a quintic whose bend begins and ends at 0; it is as short as is gentle enough.
    """
    best: tuple[float, Course] | None = None
    for join in _JOINS:
        if join > course.length - 0.3:
            break
        made = _joined(place, heading, course, join)
        step = made.length / (len(made.points) - 1)
        bend = float(np.abs(np.gradient(made.heading, step)).max())
        if best is None or bend < 0.9 * best[0]:
            best = bend, made
        if bend < _GENTLE:
            break
    return best[1] if best is not None and best[0] < _SHARPEST else None


def _joined(place: Array, heading: float, course: Course, join: float) -> Course:
    end, towards = course.at(np.array(join))
    reach = float(np.linalg.norm(end - place))
    u = np.linspace(0.0, 1.0, max(int(np.ceil(reach / _SAMPLE)), 8) + 1)[:, None]
    h = u**3 * (10.0 - 15.0 * u + 6.0 * u * u)
    begin = reach * np.array([np.cos(heading), np.sin(heading)])
    over = reach * np.array([np.cos(towards), np.sin(towards)])
    curve = place + h * (end - place) + begin * (u - u**3 * (6.0 - 8.0 * u + 3.0 * u * u))
    curve = curve + over * (u**3 * (-4.0 + 7.0 * u - 3.0 * u * u))
    left = course.length - join
    rest, _ = course.at(join + np.linspace(0.0, left, max(int(np.ceil(left / _SAMPLE)), 2) + 1)[1:])
    points = np.concatenate([curve, rest])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=-1))])
    even = np.linspace(0.0, along[-1], int(np.ceil(along[-1] / _SAMPLE)) + 1)
    points = np.stack([np.interp(even, along, points[:, i]) for i in range(2)], axis=-1)
    step = np.gradient(points, axis=0)
    headings = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    headings += 2.0 * np.pi * np.round((heading - headings[0]) / (2.0 * np.pi))
    return Course(points, headings, float(even[-1]))
