"""The ways in which thumb and fingers come to a part and leave it, each with the room that its neighbours leave it.

A grip is tilted and rolled about the part, and set before it at several places; of all these one sees how clear they
are of what is beside the part, and whether an arm comes there.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.quaternion import between, from_axis_angle, multiply, rotate
from ahmss.grasping.hand import Hand
from ahmss.grasping.holding import Holding, opener
from ahmss.grasping.key_grip import curled
from ahmss.grasping.precision import precision
from ahmss.motion.steps import finished
from ahmss.reaching.comfort import discomfort
from ahmss.reaching.handpoints import own_points, placed_points
from ahmss.reaching.plan import Reaching
from ahmss.reaching.pointing import palms_pointing
from ahmss.reaching.reacher import Reacher, seat
from ahmss.skills.box import Box, filled, nearest
from ahmss.skills.clearing import KEEPS, offs
from ahmss.skills.controls import beside, front_of
from ahmss.skills.reaching import Looking

__all__ = [
    "Approach", "Grip", "Part", "approaches", "clearer", "grip_of", "kept_from", "lasting", "on_part", "open_hand",
]  # fmt: skip

_NEARLY = 0.0004  # metres: as good as the clearest
_AWAY = (0.5, 1.0)  # shares of a part's `off` at which it is looked whether they are clear
_SHARES = np.array([0.0, 0.5, 1.0])  # of its way at which it is
_MOST = 0.03  # metres: what keeps more is as clear as can be
_REACHES = 0.3  # metres from the part to what a hand may touch that holds it
_PLATE = 0.1  # metres of it about a control
_ON_PLATE, _AROUND = 0.08, 0.13  # metres from it up to which a part is on a plate; of that about the part
_TILTS, _ROLLS = np.radians([0.0, -20.0, 20.0, -40.0, 40.0]), np.radians([0.0, -20.0, 20.0])
_ALL_TILTS, _ALL_ROLLS = np.radians(np.arange(-90.0, 91.0, 15.0)), np.radians([0.0, -20.0, 20.0, -40.0, 40.0])

Way = Callable[[Array], tuple[Array, Array]]


@dataclass(frozen=True)
class Part:
    """What is taken and moved.

    site: where it is taken, as it is now, in the world. way: for shares (n) of its way, from 0 to 1, the site's places
    (n, 3), and the turns (n, 4) in the world that the hand makes with it. seconds: that the way takes. off: (3,) metres
    from where a hand is on it to where the open hand is set, and to which it goes back. short: of the palms (7,) that
    hold it when it sets out and when it is there, why that is not where it was to go; "" where it is. came: of the same
    palms the share of its way that it comes; None: nobody can tell. own: for shares (n) of its way the turns (n, 4) in
    the world that it makes itself, where the hand turns less; None: as the hand.
    """

    site: Transform
    way: Way
    seconds: float
    off: Array = field(default_factory=lambda: np.zeros(3))
    short: Callable[[Array, Array], str] | None = None
    came: Callable[[Array, Array], float] | None = None
    own: Callable[[Array], Array] | None = None

    def at(self, share: Array) -> Transform:
        """Its site (n) when it has gone such shares (n) of its way."""
        places, turns = self.way(share)
        return Transform(places, multiply(turns if self.own is None else self.own(share), self.site.rotation))

    def palm(self, set_at: Array) -> Transform:
        """The palm on it, of a hand that is set before it (7,)."""
        return Transform(set_at[:3] - self.off, set_at[3:])


@dataclass(frozen=True, eq=False)
class Grip:
    """How a hand holds the part where it is now: the palm in the world, and the fingers."""

    side: str
    palm: Transform
    holding: Holding

    def turned_from(self, palm: Array) -> float:
        """Radians between its palm and one (7,)."""
        return float(2.0 * np.arccos(min(1.0, abs(float(self.palm.rotation @ palm[3:])))))


def grip_of(task: HumanTask, side: str, part: Part, over: float) -> Grip | None:
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
    field = thing.shape.field(site.place)
    holding = finished(precision(Hand.of(task.human, side), field, present.row(), site.row()))
    if holding is None or not holding.holds:
        return None
    palm = task.site.inverse().then(thing.frame.then(Transform.of(holding.palm)))
    return Grip(side, part.site.then(palm), holding)


def _turned(part: Part, grip: Grip, tilts: Array, rolls: Array) -> Array:
    """Palms (n, 7) that hold the part between the same pads, the hand turned about it: which is easiest is chosen."""
    across = rotate(part.site.rotation, np.array([0.0, 0.0, 1.0]))
    into = rotate(part.site.rotation, np.array([1.0, 0.0, 0.0]))
    tilt, roll = (a.ravel() for a in np.meshgrid(tilts, rolls, indexing="ij"))
    turned = multiply(from_axis_angle(across, tilt), from_axis_angle(into, roll))
    places = part.site.place + rotate(turned, grip.palm.place - part.site.place)
    return np.concatenate([places, multiply(turned, grip.palm.rotation)], axis=-1)


def kept_from(task: HumanTask, part: Part) -> list[Box]:
    """What else a hand keeps from: the controls beside it, if there are any, and the plate that they all are on."""
    thing = task.object
    boxes = [box for box in beside(task) if float(box.gap(part.site.place)) < _REACHES]
    if not boxes or thing is None or "box" not in thing.properties:
        return boxes
    low, high = np.array(thing.properties["box"], float)
    behind = np.array([low[0], *(high[1:] + _PLATE)])
    return [*boxes, Box(thing.frame, low - _PLATE, behind), *_plates(task, part)]


def _plates(task: HumanTask, part: Part) -> list[Box]:
    """The plate on which the controls are, as it slopes: it may be turned otherwise than the part."""
    found: list[Box] = []
    at = part.site.place
    for prism in (prism for thing in task.world.values() if "blocks" in thing.properties for prism in filled(thing)):
        off = float(prism.signed(at))
        if prism.cuts is not None and off < _ON_PLATE:
            out = prism.way_out(at)
            frame = Transform(at - off * out, between(np.array([1.0, 0.0, 0.0]), out))
            found.append(Box(frame, np.full(3, -_AROUND), np.array([0.0, _AROUND, _AROUND])))
    return found


def _gaps_on(task: HumanTask, part: Part, grip: Grip, palms: Array, boxes: Sequence[Box]) -> Array:
    """Metres (n) that hands of palms (n, 7) on the part keep from boxes, open and closed, at both ends of its way and
    between; at most `_MOST`.
    """
    on = on_part(part, palms, _SHARES)
    closed = own_points(task.human, grip.side, grip.holding.shape)
    return np.minimum(*(_gaps(task, grip, on, own, boxes) for own in (closed, _opened(task, grip))))


def _gaps_off(task: HumanTask, part: Part, turned: _Turned, boxes: Sequence[Box]) -> Array:
    """Metres (n) that open hands keep from boxes which go from the part to where they are set."""
    off = rotate(part.way(_SHARES)[1], np.array(_AWAY)[:, None, None] * part.off)
    going = np.tile(on_part(part, turned.palms, _SHARES), (len(_AWAY), 1, 1, 1))
    going[..., :3] += off[:, :, None]
    return _gaps(task, turned.grip, going.reshape(-1, *turned.palms.shape), turned.opened, boxes)


def _opened(task: HumanTask, grip: Grip) -> Array:
    """The points (m, 3) of the open hand, in its frame."""
    return own_points(task.human, grip.side, open_hand(task, grip.side, grip.holding))


def _gaps(task: HumanTask, grip: Grip, palms: Array, own: Array, boxes: Sequence[Box]) -> Array:
    """Metres (n) that hands of points `own` (m, 3) in their frame keep from boxes, of palms (s, n, 7) the nearest."""
    points = placed_points(task.human, grip.side, palms.reshape(-1, 7), own)
    return nearest(boxes, points, _MOST).reshape(palms.shape[:2]).min(axis=0)


def clearer(task: HumanTask, part: Part, grip: Grip, boxes: Sequence[Box]) -> Grip:
    """The grip, or the same with the fingers in the palm that do nothing where that keeps clearer of boxes."""
    gap = _clear(task, part, grip, boxes)
    if gap > KEEPS:
        return grip
    alone = replace(grip, holding=curled(Hand.of(task.human, grip.side), grip.holding))
    return alone if _clear(task, part, alone, boxes) > gap else grip


def _clear(task: HumanTask, part: Part, grip: Grip, boxes: Sequence[Box]) -> float:
    """Metres between a hand on the part and boxes, tilted as keeps it farthest from them."""
    return float(_gaps_on(task, part, grip, _turned(part, grip, _TILTS, _ROLLS), boxes).max())


def open_hand(task: HumanTask, side: str, holding: Holding) -> Array:
    """The fingers (14, 4) before they close."""
    return opener(Hand.of(task.human, side), holding) if holding.wide is None else holding.wide


@dataclass(frozen=True, eq=False)
class Approach:
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

    def by(self, side: str) -> Approach:
        """The same with that hand alone."""
        return replace(self, palms={side: self.palms[side]}, gaps={side: self.gaps[side]})

    def without(self, side: str) -> Approach:
        """The same without that hand."""
        palms, gaps = ({one: some for one, some in own.items() if one != side} for own in (self.palms, self.gaps))
        return replace(self, palms=palms, gaps=gaps)


def approaches(
    task: HumanTask, part: Part, taken: dict[str, list[Grip]], boxes: Sequence[Box], gaze: Looking
) -> Generator[Array, None, list[Approach]]:
    """The ways in which hands may come, the clearest first; only the plainest where nothing is beside."""
    plain = _on(task, part, taken, boxes, _TILTS, _ROLLS)
    ways = [_approach(task, replace(part, off=offs(part.site)[0]), plain, boxes)]
    yield gaze.alone()
    if boxes:
        turned = _on(task, part, taken, boxes, _ALL_TILTS, _ALL_ROLLS)
        for off in offs(part.site):
            ways.append(_approach(task, replace(part, off=off), turned, boxes))
            yield gaze.alone()
    return sorted(ways, key=lambda way: -min(way.gap, KEEPS))


@dataclass(frozen=True, eq=False)
class _Turned:
    """A grip whose palms (n, 7) are turned about the part, the metres (n) that each keeps on it, and the points (m, 3)
    of the open hand in its frame.
    """

    grip: Grip
    palms: Array
    gaps: Array
    opened: Array


def _on(
    task: HumanTask, part: Part, taken: dict[str, list[Grip]], boxes: Sequence[Box], tilts: Array, rolls: Array
) -> list[_Turned]:
    """The grips turned about the part so, and how clear each is on it, wherever the hand comes from."""
    found: list[_Turned] = []
    for grip in (grip for grips in taken.values() for grip in grips):
        palms = _turned(part, grip, tilts, rolls)
        found.append(_Turned(grip, palms, _gaps_on(task, part, grip, palms, boxes), _opened(task, grip)))
    return found


def _approach(task: HumanTask, part: Part, turned: Sequence[_Turned], boxes: Sequence[Box]) -> Approach:
    """How clear such palms are where the hand comes as the part says."""
    palms, gaps = dict[str, list[Array]](), dict[str, list[Array]]()
    for one in turned:
        palms.setdefault(one.grip.side, []).append(one.palms)
        off = _gaps_off(task, part, one, boxes)
        gaps.setdefault(one.grip.side, []).append(np.minimum(one.gaps, off))
    return Approach(
        part, {side: np.concatenate(some) for side, some in palms.items()},
        {side: np.concatenate(some) for side, some in gaps.items()},
    )  # fmt: skip


def lasting(reaching: Reaching, ways: Sequence[Approach], most: int) -> list[Approach]:
    """Of ways, the clearest first, so many at the most with those palms which an arm can bring along them."""
    brought = {side: _brought(reaching, ways, side) for side in ways[0].palms}
    found: list[Approach] = []
    for number, way in enumerate(ways):
        can = {side: some[number] for side, some in brought.items() if some[number].any()}
        palms, gaps = ({side: own[side][some] for side, some in can.items()} for own in (way.palms, way.gaps))
        if can:
            found.append(replace(way, palms=palms, gaps=gaps))
    return sorted(found, key=lambda way: -min(way.gap, KEEPS))[:most]


def _brought(reaching: Reaching, ways: Sequence[Approach], side: str) -> list[NDArray[np.bool_]]:
    """Which palms of each way an arm can bring to both ends of the part's way, on it and off it.

    The ways have palms in common, which are on the part alike.
    """
    reacher, ends = Reacher.of(reaching.skeleton, side), np.array([0.0, 1.0])
    spine, present = seat(reaching.skeleton, reaching.start.rotations, reaching.start.root), reaching.present(reacher)
    part, counts = ways[0].part, [len(way.palms[side]) for way in ways]
    palms, same = np.unique(np.concatenate([way.palms[side] for way in ways]), axis=0, return_inverse=True)
    on = on_part(part, palms, ends)
    can = discomfort(reacher, on, spine, present)[1].all(axis=0)[same]
    off = on[:, same[can]]
    away = np.repeat([way.part.off for way in ways], counts, axis=0)[can]
    off[..., :3] += rotate(part.way(ends)[1][:, None], away)
    can[can] = discomfort(reacher, off, spine, present)[1].all(axis=0)
    return np.split(can, np.cumsum(counts)[:-1])


def on_part(part: Part, palms: Array, share: Array) -> Array:
    """Palms (s, n, 7) of some (n, 7) on the part when it has gone such shares (s) of its way."""
    held, along = part.way(share)
    places = held[:, None] + rotate(along[:, None], palms[:, :3] - part.site.place)
    return np.concatenate(
        [places, multiply(along[:, None], np.broadcast_to(palms[:, 3:], (*places.shape[:2], 4)))], axis=-1
    )
