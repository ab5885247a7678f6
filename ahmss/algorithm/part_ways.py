"""The ways in which thumb and fingers come to a part and leave it, each with the room that its neighbours leave it.

A grip is tilted and rolled about the part, and set before it at several places; of all these one sees how clear they
are of what is beside the part, and whether an arm comes there.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ahmss.algorithm.box import Box
from ahmss.algorithm.clearing import KEEPS, offs
from ahmss.algorithm.controls import beside, front_of
from ahmss.algorithm.place import Transform
from ahmss.algorithm.reaching import Looking
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.grasping.hand import Hand
from ahmss.grasping.holding import Holding, opener
from ahmss.grasping.key_grip import curled
from ahmss.grasping.precision import precision
from ahmss.reaching.comfort import discomfort
from ahmss.reaching.handpoints import hand_points
from ahmss.reaching.plan import Reaching
from ahmss.reaching.pointing import palms_pointing
from ahmss.reaching.reacher import Reacher, seat

__all__ = [
    "Approach", "Grip", "Part", "approaches", "clearer", "grip_of", "kept_from", "lasting", "on_part", "open_hand",
]  # fmt: skip

_NEARLY = 0.002  # metres: as good as the clearest
_AWAY = (0.5, 1.0)  # shares of a part's `off` at which it is looked whether they are clear
_REACHES = 0.3  # metres from the part to what a hand may touch that holds it
_PLATE = 0.1  # metres of it about a control
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
    holding = precision(Hand.of(task.human, side), thing.shape.field(site.place), present.row(), site.row())
    if holding is None or not holding.holds:
        return None
    palm = task.site.inverse().then(thing.frame.then(Transform.of(holding.palm)))
    return Grip(side, part.site.then(palm), holding)


def _gaps(task: HumanTask, part: Part, grip: Grip, palms: Array, boxes: Sequence[Box]) -> Array:
    """Metres (n) that hands of palms (n, 7) on the part keep from boxes."""
    if not boxes:
        return np.full(len(palms), np.inf)
    points = _points(task, part, grip, palms)
    return np.min([box.gap(points).min(axis=-1) for box in boxes], axis=0)


def _turned(part: Part, grip: Grip, tilts: Array = _TILTS, rolls: Array = _ROLLS) -> Array:
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
    return [*boxes, Box(thing.frame, low - _PLATE, behind)]


def _points(task: HumanTask, part: Part, grip: Grip, palms: Array) -> Array:
    """Points (n, m, 3) of the hand of palms on the part: open and closed, at both ends of its way and between; and open
    on the way to it and from it.
    """
    wide, share = open_hand(task, grip.side, grip.holding), np.array([0.0, 0.5, 1.0])
    on = np.stack([on_part(part, Transform.of(palm), share) for palm in palms], axis=1)
    points = [hand_points(task.human, grip.side, some, shape) for some in on for shape in (grip.holding.shape, wide)]
    for away in _AWAY if part.off.any() else ():
        off = np.concatenate([rotate(part.way(share)[1], away * part.off), np.zeros((3, 4))], axis=-1)
        points += [hand_points(task.human, grip.side, some + by, wide) for some, by in zip(on, off, strict=True)]
    return np.concatenate(points, axis=1)


def clearer(task: HumanTask, part: Part, grip: Grip, boxes: Sequence[Box]) -> Grip:
    """The grip, or the same with the fingers in the palm that do nothing where that keeps clearer of boxes."""
    if _clear(task, part, grip, boxes) > KEEPS:
        return grip
    alone = replace(grip, holding=curled(Hand.of(task.human, grip.side), grip.holding))
    return max((grip, alone), key=lambda one: _clear(task, part, one, boxes))


def _clear(task: HumanTask, part: Part, grip: Grip, boxes: Sequence[Box]) -> float:
    """Metres between a hand on the part and boxes, tilted as keeps it farthest from them."""
    return float(_gaps(task, part, grip, _turned(part, grip), boxes).max())


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


def approaches(
    task: HumanTask, part: Part, taken: dict[str, list[Grip]], boxes: Sequence[Box], gaze: Looking
) -> Generator[Array, None, list[Approach]]:
    """The ways in which hands may come, the clearest first; only the plainest where nothing is beside."""
    ways = [_approach(task, replace(part, off=offs(part.site)[0]), taken, boxes, _TILTS, _ROLLS)]
    yield gaze.alone()
    for off in offs(part.site) if boxes else ():
        ways.append(_approach(task, replace(part, off=off), taken, boxes, _ALL_TILTS, _ALL_ROLLS))
        yield gaze.alone()
    return sorted(ways, key=lambda way: -min(way.gap, KEEPS))


def _approach(
    task: HumanTask, part: Part, taken: dict[str, list[Grip]], boxes: Sequence[Box], tilts: Array, rolls: Array
) -> Approach:
    """Of palms that hold the part, turned about it so, how clear each is."""
    palms = {side: [_turned(part, grip, tilts, rolls) for grip in found] for side, found in taken.items()}
    gaps = {
        side: np.concatenate(
            [_gaps(task, part, grip, own, boxes) for grip, own in zip(taken[side], found, strict=True)]
        )
        for side, found in palms.items()
    }
    return Approach(part, {side: np.concatenate(found) for side, found in palms.items()}, gaps)


def lasting(reaching: Reaching, way: Approach) -> Approach | None:
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
    on = on_part(part, Transform.of(palm), ends)
    off = on.copy()
    off[:, :3] += rotate(part.way(ends)[1], part.off)
    return np.concatenate([on, off])


def on_part(part: Part, palm: Transform, share: Array) -> Array:
    """Palms (n, 7) on the part when it has gone such shares (n) of its way."""
    held, along = part.way(share)
    places = held + rotate(along, palm.place - part.site.place)
    return np.concatenate([places, multiply(along, palm.rotation)], axis=-1)
