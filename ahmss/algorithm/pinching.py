"""A part of a thing between thumb and fingers: it is taken, goes its way with the hand, and is let go.

A tap's lever, a slide, a knob. The reach is that of `reach`, the grip that of `grasp` at a site with a precision grip:
the hand comes along its x, thumb and fingers close along its z. What the shipped algorithms that move a part share.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ahmss.algorithm.box import Box
from ahmss.algorithm.clearing import KEEPS, gap_of, offs, refuse_touching
from ahmss.algorithm.controls import beside, front_of, in_the_way, smoothest, stood_before
from ahmss.algorithm.place import Transform
from ahmss.algorithm.reaching import Looking, performed, sides_of
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.links import fingers
from ahmss.body.quaternion import from_axis_angle, multiply, rotate, slerp
from ahmss.errors import AlgorithmError
from ahmss.grasping.hand import Hand
from ahmss.grasping.holding import Holding, opener
from ahmss.grasping.key_grip import curled
from ahmss.grasping.precision import precision
from ahmss.grasping.rolling import rolled
from ahmss.motion.easing import minimum_jerk
from ahmss.reaching.comfort import discomfort
from ahmss.reaching.goal import Goal
from ahmss.reaching.handpoints import hand_points
from ahmss.reaching.performing import Performed
from ahmss.reaching.plan import Plan, Reaching
from ahmss.reaching.pointing import palms_pointing
from ahmss.reaching.prism import Prism
from ahmss.reaching.reacher import Reacher, seat

__all__ = ["Part", "gone_back", "pinched", "rows_made"]

_COMES, _CLOSES, _OPENS, _LEAVES, _RETURNS = 0.3, 0.25, 0.2, 0.35, 0.4  # seconds
_MISSED, _ARM = 0.006, 0.09  # metres that thumb and fingers may be off, and how far they are from the palm
_NEARLY, _SEEN_CLEAR = 0.002, 0.008  # metres: as good as the clearest; that do where it is performed
_MOST_WAYS, _AWAY = 3, (0.5, 1.0)  # ways that are tried; shares of `off` at which it is looked whether they are clear
_REACHES = 0.3  # metres from the part to what a hand may touch that holds it
_PLATE = 0.1  # metres of it about a control
_GOES_OVER = 30  # frames in which the elbow comes back to where it was at the part
_OVER = (0.0, np.pi)  # the thumb on the one side of the part, and on the other: whichever is easier
_TILTS, _ROLLS = np.radians([0.0, -20.0, 20.0, -40.0, 40.0]), np.radians([0.0, -20.0, 20.0])
_ALL_TILTS, _ALL_ROLLS = np.radians(np.arange(-60.0, 61.0, 15.0)), np.radians([0.0, -20.0, 20.0, -40.0, 40.0])

Way = Callable[[Array], tuple[Array, Array]]


@dataclass(frozen=True)
class Part:
    """What is taken and moved.

    site: where it is taken, as it is now, in the world. way: for shares (n) of its way, from 0 to 1, the site's places
    (n, 3), and the turns (n, 4) in the world that the hand makes with it. seconds: that the way takes. off: (3,) metres
    from where a hand is on it to where the open hand is set, and to which it goes back.
    """

    site: Transform
    way: Way
    seconds: float
    off: Array = field(default_factory=lambda: np.zeros(3))

    def palm(self, set_at: Array) -> Transform:
        """The palm on it, of a hand that is set before it (7,)."""
        return Transform(set_at[:3] - self.off, set_at[3:])


def pinched(task: HumanTask, part: Part, other: Part | None = None) -> Iterator[Array]:
    """Frames (n, 260): the hand comes, closes, moves the part, opens, and goes back the way that it came.

    Where the arm can't go all the way so it goes the other way, if there is one, with the same site. Where neighbours
    would be touched it comes and goes otherwise: from farther before the part, aslant, with other palms, or the other
    hand.

    Raises:
        AlgorithmError: thumb and fingers can't close there, it is out of reach, or something is in the way; says so.
    """
    gaze, taken, boxes = Looking(task, part.site.place), dict[str, list[_Grip]](), _kept_from(task, part)
    yield gaze.alone()
    for side in sides_of(task):
        for over in _OVER:
            if grip := _grip(task, side, part, over):
                taken.setdefault(side, []).append(grip)
            yield gaze.alone()
    if boxes:  # where fingers that do nothing would be in what is beside it, thumb and index finger take it alone
        for side, found in taken.items():
            taken[side] = [_clearer(task, part, grip, boxes) for grip in found]
            yield gaze.alone()
    if not taken:
        name = "it" if task.object is None else task.object.name
        raise AlgorithmError(f"thumb and fingers can't close on {name} there; give the site another rotation")
    ways = yield from _ways(task, part, taken, boxes, gaze)
    prisms = in_the_way(task)
    goal = Goal(part.site.place, palms=ways[0].clear)
    task, gaze = yield from stood_before(task, goal, prisms, gaze)
    reaching = Reaching(task.human, task.start.rotations, task.start.root)
    lasting = [one for way in ways if (one := _lasting(reaching, way)) is not None]
    ways = sorted(lasting, key=lambda way: -min(way.gap, KEEPS))[:_MOST_WAYS] or ways[:1]
    best: _Tried | None = None
    refused: AlgorithmError | None = None
    one = None
    while ways:
        way = ways.pop(0)
        try:
            one = yield from _tried(task, way, other, taken, reaching, prisms, boxes, gaze)
        except AlgorithmError as error:  # another way may be within reach
            refused = refused or error
            continue
        best = one if best is None or one.flaw < best.flaw else best
        if best.flaw <= 0.0:
            break
    if best is None:
        assert refused is not None
        raise refused
    if best is not one and best.made.looked < 1.0:  # the eyes have gone on since it was made
        best = replace(best, made=(yield from best.perform(best.plan)))
    side = best.plan.reacher.side
    refuse_touching(task, side, *_shown(best.made, best.back(task)), beside(task))
    yield rows_made(task, best.made)
    yield best.back(task)


@dataclass(frozen=True, eq=False)
class _Way:
    """How hands come to a part and go: its part, `off` and all; by side palms (n, 7) on it, and the metres (n) that
    each then keeps from what is beside.
    """

    part: Part
    palms: dict[str, Array]
    gaps: dict[str, Array]

    @property
    def gap(self) -> float:
        """Metres that the clearest palm keeps."""
        return max(float(gaps.max()) for gaps in self.gaps.values())

    @property
    def clear(self) -> dict[str, Array]:
        """The palms that are clear; where none is, the clearest."""
        least = min(KEEPS, self.gap - _NEARLY)
        kept = {side: palms[self.gaps[side] > least] for side, palms in self.palms.items()}
        return {side: palms for side, palms in kept.items() if len(palms)}


def _ways(
    task: HumanTask, part: Part, taken: dict[str, list[_Grip]], boxes: Sequence[Box], gaze: Looking
) -> Generator[Array, None, list[_Way]]:
    """The ways in which hands may come, the clearest first; only the plainest where nothing is beside."""
    ways = [_way(task, replace(part, off=offs(part.site)[0]), taken, boxes, _TILTS, _ROLLS)]
    yield gaze.alone()
    for off in offs(part.site) if boxes else ():
        ways.append(_way(task, replace(part, off=off), taken, boxes, _ALL_TILTS, _ALL_ROLLS))
        yield gaze.alone()
    return sorted(ways, key=lambda way: -min(way.gap, KEEPS))


def _way(
    task: HumanTask, part: Part, taken: dict[str, list[_Grip]], boxes: Sequence[Box], tilts: Array, rolls: Array
) -> _Way:
    """Of palms that hold the part, turned about it so, how clear each is."""
    palms = {side: [_turned(part, grip, tilts, rolls) for grip in found] for side, found in taken.items()}
    gaps = {
        side: np.concatenate(
            [_gaps(task, part, grip, own, boxes) for grip, own in zip(taken[side], found, strict=True)]
        )
        for side, found in palms.items()
    }
    return _Way(part, {side: np.concatenate(found) for side, found in palms.items()}, gaps)


@dataclass(frozen=True, eq=False)
class _Tried:
    """What comes of a way: metres by which the hand misses or touches something, and what else it comes to.

    perform: makes a plan's frames anew.
    """

    flaw: float
    part: Part
    plan: Plan
    made: Performed
    perform: Callable[[Plan], Generator[Array, None, Performed]]

    def back(self, task: HumanTask) -> Array:
        """Frames (n, 260) in which it goes back."""
        return _back(task, self.part, self.plan, self.made)


def _tried(
    task: HumanTask, way: _Way, other: Part | None, taken: dict[str, list[_Grip]], reaching: Reaching,
    prisms: Sequence[Prism], boxes: Sequence[Box], gaze: Looking,
) -> Generator[Array, None, _Tried]:  # fmt: skip
    """What comes of a way.

    Raises:
        AlgorithmError: it is out of reach so.
    """
    part = way.part
    goal = Goal(part.site.place, palms=way.clear)

    def perform(plan: Plan) -> Generator[Array, None, Performed]:
        grip = min(taken[plan.reacher.side], key=lambda grip: grip.turned_from(plan.palm))
        made = yield from _made(task, part, plan, gaze, reaching, grip.holding)
        if other is not None and _missed(task, part, plan, made) > _MISSED:
            made = yield from _made(task, replace(other, off=part.off), plan, gaze, reaching, grip.holding)
        return made

    def flaw(plan: Plan, made: Performed) -> float:
        missed = max(_missed(task, part, plan, made) - _MISSED, 0.0)
        if not boxes:
            return missed
        gap = gap_of(task, plan.reacher.side, *_shown(made, _back(task, part, plan, made)), beside(task))
        return missed + max(_SEEN_CLEAR - gap, 0.0)

    plan, made = yield from smoothest(task, reaching, goal, gaze, prisms, part.off, perform, flaw)
    return _Tried(flaw(plan, made), part, plan, made, perform)


def _back(task: HumanTask, part: Part, plan: Plan, made: Performed) -> Array:
    """Frames (n, 260) in which the hand goes back the way that it came to the part."""
    return gone_back(task, made, len(made.root) - len(_moved(task, part, plan.palm)[0]), plan.reacher.links)


def _shown(made: Performed, back: Array) -> tuple[Array, Array]:
    """Rotations (n, 43, 4) and root (n, 3) of what is made and of the rows (m, 260) in which it goes back."""
    rotations = np.concatenate([made.rotations, back[:, 4:176].reshape(-1, 43, 4)])
    return rotations, np.concatenate([made.root, back[:, 1:4]])


def _made(
    task: HumanTask, part: Part, plan: Plan, gaze: Looking, reaching: Reaching, holding: Holding
) -> Generator[Array, None, Performed]:
    """The frames of a plan, the fingers closing and opening."""
    side = plan.reacher.side
    then, closed = _moved(task, part, plan.palm)
    holding = _held(task, part, plan, holding)
    wide, links = _wide(task, side, holding), list(fingers(side))
    made = yield from performed(task, reaching, plan, gaze, (links, wide), then)
    made.rotations[len(made.root) - len(then) :, links] = slerp(wide, holding.shape, closed[:, None])
    return made


def _held(task: HumanTask, part: Part, plan: Plan, holding: Holding) -> Holding:
    """The grip closed on the part by the hand as it was set there, turned about it."""
    thing = task.object
    assert thing is not None
    assert thing.shape is not None
    assert task.site is not None
    at_rest = thing.frame.inverse().then(task.site)  # the shape has the part so
    palm = at_rest.then(part.site.inverse().then(part.palm(plan.palm)))
    hand = Hand.of(task.human, plan.reacher.side)
    again = rolled(hand, thing.shape.field(at_rest.place), palm.row(), holding)
    return again if holding.wide is None else curled(hand, again)


def _wide(task: HumanTask, side: str, holding: Holding) -> Array:
    """The fingers (14, 4) before they close."""
    return opener(Hand.of(task.human, side), holding) if holding.wide is None else holding.wide


def _lasting(reaching: Reaching, way: _Way) -> _Way | None:
    """The way with those palms which the arm can bring to both ends of the part's way and off it; None: it can none."""
    skeleton, start, part = reaching.skeleton, reaching.start, way.part
    spine = seat(skeleton, start.rotations, start.root)
    palms, gaps = dict[str, Array](), dict[str, Array]()
    for side, own in way.palms.items():
        reacher = Reacher.of(skeleton, side)
        path = np.stack([_along(part, palm) for palm in own])
        _, found, _ = discomfort(reacher, path, spine, reaching.present(reacher))
        both = found.all(axis=1)
        if both.any():
            palms[side], gaps[side] = own[both], way.gaps[side][both]
    return replace(way, palms=palms, gaps=gaps) if palms else None


def _along(part: Part, palm: Array) -> Array:
    """Palms (4, 7) of one (7,) on the part: at both ends of its way, on the part and off it."""
    ends = np.array([0.0, 1.0])
    on = _on(part, Transform.of(palm), ends)
    off = on.copy()
    off[:, :3] += rotate(part.way(ends)[1], part.off)
    return np.concatenate([on, off])


def _on(part: Part, palm: Transform, share: Array) -> Array:
    """Palms (n, 7) on the part when it has gone such shares (n) of its way."""
    held, along = part.way(share)
    places = held + rotate(along, palm.place - part.site.place)
    return np.concatenate([places, multiply(along, palm.rotation)], axis=-1)


def _missed(task: HumanTask, part: Part, plan: Plan, made: Performed) -> float:
    """Metres by which a point of the hand at the part's distance from the palm is off at the most: the arm's joints."""
    then, closed = _moved(task, part, plan.palm)
    n, holds = len(then), closed > 0.0
    got = grips(task.human, made.rotations[-n:], made.root[-n:])[:, plan.reacher.row]
    turned = 2.0 * np.arccos(np.clip(np.abs((got[:, 3:] * then[:, 3:]).sum(axis=-1)), 0.0, 1.0))
    return float((np.linalg.norm(got[:, :3] - then[:, :3], axis=-1) + _ARM * turned)[holds].max())


def rows_made(task: HumanTask, made: Performed) -> Array:
    """The frames (n, 260) of what was performed."""
    return task.block(made.rotations, made.root, made.importance, made.targets)


def gone_back(task: HumanTask, made: Performed, length: int, arm: slice) -> Array:
    """Frames (n, 260) in which all goes back the way that it came in the first so many, which is clear of things.

    The elbow may have come to another place meanwhile: the arm goes over from there.
    """
    rows = rows_made(task, made)[:length][::-1]
    rotations = made.rotations[:length][::-1].copy()
    share = minimum_jerk(np.arange(1, length + 1) / _GOES_OVER)[:, None]
    rotations[:, arm] = slerp(
        np.broadcast_to(made.rotations[-1, arm], rotations[:, arm].shape), rotations[:, arm], share
    )
    rows[:, 4:176] = rotations.reshape(length, 172)
    return rows


@dataclass(frozen=True, eq=False)
class _Grip:
    """How a hand holds the part where it is now: the palm in the world, and the fingers."""

    side: str
    palm: Transform
    holding: Holding

    def turned_from(self, palm: Array) -> float:
        """Radians between its palm and one (7,)."""
        return float(2.0 * np.arccos(min(1.0, abs(float(self.palm.rotation @ palm[3:])))))


def _grip(task: HumanTask, side: str, part: Part, over: float) -> _Grip | None:
    """How a hand takes the part, rolled over by so many radians from thumb up; None where it can't."""
    thing = task.object
    assert thing is not None
    assert thing.shape is not None
    assert task.site is not None
    site = thing.frame.inverse().then(task.site)  # the shape has the part where it is at rest
    into = rotate(task.site.rotation, np.array([1.0, 0.0, 0.0]))
    ahead = -np.append(front_of(thing.frame), 0.0)
    level = palms_pointing(task.human, side, task.site.place, into, None if abs(into[2]) < 0.9 else ahead, exactly=True)
    present = thing.frame.inverse().then(
        Transform(level[0, :3], multiply(from_axis_angle(into, np.array(over)), level[0, 3:]))
    )
    holding = precision(Hand.of(task.human, side), thing.shape.field(site.place), present.row(), site.row())
    if holding is None or not holding.holds:
        return None
    palm = task.site.inverse().then(thing.frame.then(Transform.of(holding.palm)))
    return _Grip(side, part.site.then(palm), holding)


def _gaps(task: HumanTask, part: Part, grip: _Grip, palms: Array, boxes: Sequence[Box]) -> Array:
    """Metres (n) that hands of palms (n, 7) on the part keep from boxes."""
    if not boxes:
        return np.full(len(palms), np.inf)
    points = _points(task, part, grip, palms)
    return np.min([box.gap(points).min(axis=-1) for box in boxes], axis=0)


def _turned(part: Part, grip: _Grip, tilts: Array = _TILTS, rolls: Array = _ROLLS) -> Array:
    """Palms (n, 7) that hold the part between the same pads, the hand turned about it: which is easiest is chosen."""
    across = rotate(part.site.rotation, np.array([0.0, 0.0, 1.0]))
    into = rotate(part.site.rotation, np.array([1.0, 0.0, 0.0]))
    tilt, roll = (a.ravel() for a in np.meshgrid(tilts, rolls, indexing="ij"))
    turned = multiply(from_axis_angle(across, tilt), from_axis_angle(into, roll))
    places = part.site.place + rotate(turned, grip.palm.place - part.site.place)
    return np.concatenate([places, multiply(turned, grip.palm.rotation)], axis=-1)


def _kept_from(task: HumanTask, part: Part) -> list[Box]:
    """What else a hand keeps from: the controls beside it, if there are any, and the plate that they all are on."""
    thing = task.object
    boxes = [box for box in beside(task) if float(box.gap(part.site.place)) < _REACHES]
    if not boxes or thing is None or "box" not in thing.properties:
        return boxes
    low, high = np.array(thing.properties["box"], float)
    behind = np.array([low[0], *(high[1:] + _PLATE)])
    return [*boxes, Box(thing.frame, low - _PLATE, behind)]


def _points(task: HumanTask, part: Part, grip: _Grip, palms: Array) -> Array:
    """Points (n, m, 3) of the hand of palms on the part: open and closed, at both ends of its way and between; and open
    on the way to it and from it.
    """
    wide, share = _wide(task, grip.side, grip.holding), np.array([0.0, 0.5, 1.0])
    on = np.stack([_on(part, Transform.of(palm), share) for palm in palms], axis=1)
    points = [hand_points(task.human, grip.side, some, shape) for some in on for shape in (grip.holding.shape, wide)]
    for away in _AWAY if part.off.any() else ():
        off = np.concatenate([rotate(part.way(share)[1], away * part.off), np.zeros((3, 4))], axis=-1)
        points += [hand_points(task.human, grip.side, some + by, wide) for some, by in zip(on, off, strict=True)]
    return np.concatenate(points, axis=1)


def _clearer(task: HumanTask, part: Part, grip: _Grip, boxes: Sequence[Box]) -> _Grip:
    """The grip, or the same with the fingers in the palm that do nothing where that keeps clearer of boxes."""
    if _clear(task, part, grip, boxes) > KEEPS:
        return grip
    alone = replace(grip, holding=curled(Hand.of(task.human, grip.side), grip.holding))
    return max((grip, alone), key=lambda one: _clear(task, part, one, boxes))


def _clear(task: HumanTask, part: Part, grip: _Grip, boxes: Sequence[Box]) -> float:
    """Metres between a hand on the part and boxes, tilted as keeps it farthest from them."""
    return float(_gaps(task, part, grip, _turned(part, grip), boxes).max())


def _moved(task: HumanTask, part: Part, set_at: Array) -> tuple[Array, Array]:
    """Palms (n, 7) from before the part, where the hand is set (7,), to it, with it, off it, and back to where they
    came from; and how far the fingers are closed (n), 0 to 1.
    """
    counts = [round(seconds * task.rate) for seconds in (_COMES, _CLOSES, part.seconds, _OPENS, _LEAVES, _RETURNS)]
    share = [minimum_jerk(np.arange(1, count + 1) / count) for count in counts]
    zero = [np.zeros(count) for count in counts]
    back = np.concatenate([1.0 - share[0], zero[1], zero[2], zero[3], share[4], zero[5] + 1.0])
    way = np.concatenate([zero[0], zero[1], share[2], zero[3] + 1.0, zero[4] + 1.0, 1.0 - share[5]])
    closed = np.concatenate([zero[0], share[1], zero[2] + 1.0, 1.0 - share[3], zero[4], zero[5]])
    palms = _on(part, part.palm(set_at), way)
    palms[:, :3] += back[:, None] * rotate(part.way(way)[1], part.off)
    return palms, closed
