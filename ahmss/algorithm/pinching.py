"""A part of a thing between thumb and fingers: it is taken, goes its way with the hand, and is let go.

A tap's lever, a slide, a knob. The reach is that of `reach`, the grip that of `grasp` at a site with a precision grip:
the hand comes along its x, thumb and fingers close along its z. What the shipped algorithms that move a part share.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from ahmss.algorithm.box import Box
from ahmss.algorithm.controls import beside, clear_of, front_of, in_the_way, smoothest, stood_before
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
from ahmss.reaching.reacher import Reacher, seat

__all__ = ["Part", "gone_back", "pinched", "rows_made"]

_BEFORE = 0.07  # metres before the part at which the open hand is set, and to which it goes back
_COMES, _CLOSES, _OPENS, _LEAVES, _RETURNS = 0.3, 0.25, 0.2, 0.35, 0.4  # seconds
_MISSED, _ARM = 0.006, 0.09  # metres that thumb and fingers may be off, and how far they are from the palm
_KEEPS = 0.012  # metres that the bones of a hand keep from what is beside, as `clear_of` has it
_PLATE = 0.1  # metres of it about a control
_GOES_OVER = 30  # frames in which the elbow comes back to where it was at the part
_OVER = (0.0, np.pi)  # the thumb on the one side of the part, and on the other: whichever is easier
_TILTS, _ROLLS = np.radians([0.0, -20.0, 20.0, -40.0, 40.0]), np.radians([0.0, -20.0, 20.0])

Way = Callable[[Array], tuple[Array, Array]]


@dataclass(frozen=True)
class Part:
    """What is taken and moved.

    site: where it is taken, as it is now, in the world. way: for shares (n) of its way, from 0 to 1, the site's places
    (n, 3), and the turns (n, 4) in the world that the hand makes with it. seconds: that the way takes.
    """

    site: Transform
    way: Way
    seconds: float


def pinched(task: HumanTask, part: Part, other: Part | None = None) -> Iterator[Array]:
    """Frames (n, 260): the hand comes, closes, moves the part, opens, and goes back the way that it came.

    Where the arm can't go all the way so it goes the other way, if there is one, with the same site.

    Raises:
        AlgorithmError: thumb and fingers can't close there, or it is out of reach; says so.
    """
    gaze, taken, boxes = Looking(task, part.site.place), dict[str, list[_Grip]](), _kept_from(task)
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
    palms = {side: np.concatenate([_tilted(task, part, grip) for grip in found]) for side, found in taken.items()}
    goal, prisms = Goal(part.site.place, palms=palms), in_the_way(task)
    task, gaze = yield from stood_before(task, goal, prisms, gaze)
    lasting = _lasting(task, part, palms)
    goal = Goal(part.site.place, palms=lasting or palms)
    reaching = Reaching(task.human, task.start.rotations, task.start.root)
    into = rotate(part.site.rotation, np.array([1.0, 0.0, 0.0]))

    def perform(plan: Plan) -> Generator[Array, None, Performed]:
        grip = min(taken[plan.reacher.side], key=lambda grip: grip.turned_from(plan.palm))
        made = yield from _made(task, part, plan, gaze, reaching, grip.holding)
        if other is not None and _missed(task, part, plan, made) > _MISSED:
            made = yield from _made(task, other, plan, gaze, reaching, grip.holding)
        return made

    plan, made = yield from smoothest(task, reaching, goal, gaze, prisms, -_BEFORE * into, perform)
    rest = {side: own for side, own in goal.palms.items() if side != plan.reacher.side}
    missed = _missed(task, part, plan, made)
    if rest and missed > _MISSED:
        goal = Goal(part.site.place, palms=rest)
        with suppress(AlgorithmError):  # the other hand may not reach it: then this one does what it can
            second = yield from smoothest(task, reaching, goal, gaze, prisms, -_BEFORE * into, perform)
            if _missed(task, part, *second) < missed:
                plan, made = second
    yield rows_made(task, made)
    length = len(made.root) - len(_moved(task, part, plan.palm)[0])
    yield gone_back(task, made, length, plan.reacher.links)


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
    palm = at_rest.then(part.site.inverse().then(_palm_on(part, plan.palm)))
    hand = Hand.of(task.human, plan.reacher.side)
    again = rolled(hand, thing.shape.field(at_rest.place), palm.row(), holding)
    return again if holding.wide is None else curled(hand, again)


def _wide(task: HumanTask, side: str, holding: Holding) -> Array:
    """The fingers (14, 4) before they close."""
    return opener(Hand.of(task.human, side), holding) if holding.wide is None else holding.wide


def _lasting(task: HumanTask, part: Part, palms: dict[str, Array]) -> dict[str, Array]:
    """By side, of palms (n, 7) on the part those which the arm can bring to both ends of its way; sides with some."""
    start, lasting = task.start, dict[str, Array]()
    spine = seat(task.human, start.rotations, start.root)
    for side, own in palms.items():
        reacher = Reacher.of(task.human, side)
        on_part = [_on(part, Transform.of(palm), np.array([0.0, 1.0])) for palm in own]
        _, found, _ = discomfort(
            reacher, np.stack(on_part), spine, reacher.arm.from_pose(start.rotations[reacher.links])
        )
        both = found.all(axis=1)
        if both.any():
            lasting[side] = own[both]
    return lasting


def _palm_on(part: Part, set_at: Array) -> Transform:
    """The palm on the part, of a hand that is set before it (7,)."""
    return Transform(set_at[:3] + _BEFORE * rotate(part.site.rotation, np.array([1.0, 0.0, 0.0])), set_at[3:])


def _on(part: Part, palm: Transform, share: Array) -> Array:
    """Palms (n, 7) on the part when it has gone such shares (n) of its way."""
    held, along = part.way(share)
    places = held + rotate(along, palm.place - part.site.place)
    return np.concatenate([places, multiply(along, palm.rotation)], axis=-1)


def _missed(task: HumanTask, part: Part, plan: Plan, made: Performed) -> float:
    """Metres by which a point of the hand at the part's distance from the palm is off at the most: the arm's joints."""
    then, _ = _moved(task, part, plan.palm)
    n = len(then)
    got = grips(task.human, made.rotations[-n:], made.root[-n:])[:, plan.reacher.row]
    turned = 2.0 * np.arccos(np.clip(np.abs((got[:, 3:] * then[:, 3:]).sum(axis=-1)), 0.0, 1.0))
    return float((np.linalg.norm(got[:, :3] - then[:, :3], axis=-1) + _ARM * turned).max())


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


def _tilted(task: HumanTask, part: Part, grip: _Grip) -> Array:
    """Palms (n, 7) that hold the part as `_turned` has them; where things are beside it, those clear of them."""
    palms, boxes = _turned(part, grip), _kept_from(task)
    return clear_of(boxes, palms, _points(task, part, grip, palms)) if boxes else palms


def _turned(part: Part, grip: _Grip) -> Array:
    """Palms (n, 7) that hold the part between the same pads, the hand turned about it: which is easiest is chosen."""
    across = rotate(part.site.rotation, np.array([0.0, 0.0, 1.0]))
    into = rotate(part.site.rotation, np.array([1.0, 0.0, 0.0]))
    tilt, roll = (a.ravel() for a in np.meshgrid(_TILTS, _ROLLS, indexing="ij"))
    turned = multiply(from_axis_angle(across, tilt), from_axis_angle(into, roll))
    places = part.site.place + rotate(turned, grip.palm.place - part.site.place)
    return np.concatenate([places, multiply(turned, grip.palm.rotation)], axis=-1)


def _kept_from(task: HumanTask) -> list[Box]:
    """What else a hand keeps from: the controls beside it, if there are any, and the plate that they all are on."""
    boxes, thing = beside(task), task.object
    if not boxes or thing is None or "box" not in thing.properties:
        return boxes
    low, high = np.array(thing.properties["box"], float)
    behind = np.array([low[0], *(high[1:] + _PLATE)])
    return [*boxes, Box(thing.frame, low - _PLATE, behind)]


def _points(task: HumanTask, part: Part, grip: _Grip, palms: Array) -> Array:
    """Points (n, m, 3) of the hand, open and closed, at both ends of the part's way and between, of palms on it."""
    shapes = (grip.holding.shape, _wide(task, grip.side, grip.holding))
    on = np.stack([_on(part, Transform.of(palm), np.array([0.0, 0.5, 1.0])) for palm in palms], axis=1)
    points = [hand_points(task.human, grip.side, some, shape) for some in on for shape in shapes]
    return np.concatenate(points, axis=1)


def _clearer(task: HumanTask, part: Part, grip: _Grip, boxes: Sequence[Box]) -> _Grip:
    """The grip, or the same with the fingers in the palm that do nothing where that keeps clearer of boxes."""
    if _clear(task, part, grip, boxes) > _KEEPS:
        return grip
    alone = replace(grip, holding=curled(Hand.of(task.human, grip.side), grip.holding))
    return max((grip, alone), key=lambda one: _clear(task, part, one, boxes))


def _clear(task: HumanTask, part: Part, grip: _Grip, boxes: Sequence[Box]) -> float:
    """Metres between a hand on the part and boxes, tilted as keeps it farthest from them."""
    points = _points(task, part, grip, _turned(part, grip))
    return float(np.min([box.gap(points).min(axis=-1) for box in boxes], axis=0).max())


def _moved(task: HumanTask, part: Part, set_at: Array) -> tuple[Array, Array]:
    """Palms (n, 7) from before the part, where the hand is set (7,), to it, with it, off it, and back to where they
    came from; and how far the fingers are closed (n), 0 to 1.
    """
    into = rotate(part.site.rotation, np.array([1.0, 0.0, 0.0]))
    counts = [round(seconds * task.rate) for seconds in (_COMES, _CLOSES, part.seconds, _OPENS, _LEAVES, _RETURNS)]
    share = [minimum_jerk(np.arange(1, count + 1) / count) for count in counts]
    zero = [np.zeros(count) for count in counts]
    back = np.concatenate([1.0 - share[0], zero[1], zero[2], zero[3], share[4], zero[5] + 1.0])
    way = np.concatenate([zero[0], zero[1], share[2], zero[3] + 1.0, zero[4] + 1.0, 1.0 - share[5]])
    closed = np.concatenate([zero[0], share[1], zero[2] + 1.0, 1.0 - share[3], zero[4], zero[5]])
    palms = _on(part, _palm_on(part, set_at), way)
    palms[:, :3] -= _BEFORE * back[:, None] * rotate(part.way(way)[1], into)
    return palms, closed
