"""Rolling on what one sits on: the feet push and step, the seat on castors comes along under the hips.

The hips go level, over a seat that stays under them as its object's algorithm `rolled` follows them, and turn with it.
The feet go in turn to where they were before the hips. What stands about is kept clear of by castors, seat, trunk,
thighs and shins, as discs level at their heights; knees go under a table's top.
"""

from __future__ import annotations

import itertools
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import LEFT_FOOT, RIGHT_FOOT, solve
from ahmss.body.links import INDEX
from ahmss.body.quaternion import align, from_axis_angle, multiply, rotate
from ahmss.errors import AlgorithmError
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.planting import feet
from ahmss.reaching.prism import Prism
from ahmss.skills.box import filled
from ahmss.skills.sitting import Seated, heading_of
from ahmss.walking.library import BODY

__all__ = ["drawn_up", "rolled_to"]

_UP = np.array([0.0, 0.0, 1.0])
_STRIDE, _TURN = 0.13, np.radians(24.0)  # metres, radians of a push of both feet at the most
_SECONDS, _A_METRE, _A_RADIAN = 0.6, 2.6, 0.9  # of a way: by itself, for each metre, for each radian
_PUSHED = 0.06, 0.94  # shares of a way's time between which the hips go
_LANDS = 1.0, 2.0  # half pushes after a foot has set out: it lands where it is before the hips then; ahead, else
_LIFT = 0.02  # metres of a foot as it steps
_BACK = 0.45  # metres straight back to where there is room to turn
_APART = 0.03  # metres between two poses of a way that are looked at
_AWAY = (0.42, 0.45, 0.48, 0.52, 0.56, 0.6, 0.65, 0.7)  # metres from what one works at to the hips
_FLAT = 0.03  # metres: what is no higher is rolled over
_STAYS = 0.005, np.radians(1.0)  # metres, radians: no way
# What rolls, before the hips and to their left, how high, how wide: metres; the sitter's own is so high over the hips.
_OF_SEAT = ((0.0, 0.0, 0.05, 0.27), (0.0, 0.0, 0.4, 0.22), (-0.2, 0.0, 0.8, 0.1))
_OF_SITTER = (
    *((0.02, 0.0, z, 0.15) for z in (0.12, 0.25, 0.4, 0.55)),
    *((x, y, -0.01, 0.085) for x in (0.15, 0.3, 0.42) for y in (-0.1, 0.1)),
    *((0.42, y, z, 0.06) for z in (-0.2, -0.4) for y in (-0.1, 0.1)),
)


def drawn_up(thing: WorldObject) -> list[tuple[Array, float]]:
    """Where the hips (2,) of who sits before a thing may be, and which way they look, radians: the best first."""
    x = rotate(thing.rotation, np.array([1.0, 0.0, 0.0]))[:2]
    front = x / max(float(np.linalg.norm(x)), 1e-9)
    heading = float(np.arctan2(-front[1], -front[0]))
    return [(thing.place[:2] + away * front, heading) for away in _AWAY]


@dataclass(frozen=True, eq=False)
class Place:
    """Where the hips are on a way: (2,) level, and which way they look, radians."""

    at: Array
    heading: float

    def ahead(self, metres: float) -> Place:
        """So far ahead, looking the same way."""
        return Place(self.at + metres * np.array([np.cos(self.heading), np.sin(self.heading)]), self.heading)

    def to(self, other: Place) -> tuple[float, float]:
        """How far another is, metres, and the turn to it, radians to the left."""
        turn = (other.heading - self.heading + np.pi) % (2.0 * np.pi) - np.pi
        return float(np.linalg.norm(other.at - self.at)), turn


def rolled_to(task: HumanTask, seat: Seated, goals: Sequence[tuple[Array, float]]) -> Generator[Array, None, None]:
    """Frames (n, 260) of rolling to the first of some places that is free, and that a free way leads to.

    Args:
        task: whose human sits. seat: on what. goals: where the hips are to be (2,), and which way they look, radians.

    Raises:
        AlgorithmError: none is; names what is in the way.
    """
    now, around = Place(task.start.root[:2].copy(), heading_of(task.start.rotations)), _around(task, seat)
    in_the_way = ""
    for at, heading in goals:
        goal = Place(np.asarray(at, float), heading)
        for way in ((goal,), (goal.ahead(-_BACK), goal), (now.ahead(-_BACK), goal.ahead(-_BACK), goal)):
            name = _hindered(task, (now, *way), around)
            if not name:
                yield from _along(task, (now, *way))
                return
            in_the_way = in_the_way or name
    raise AlgorithmError(
        f"{seat.thing.name} can't be rolled there, {in_the_way} is in the way; "
        f"move that, or `do {seat.thing.name} stand_up`"
    )


def _around(task: HumanTask, seat: Seated) -> list[tuple[str, Prism]]:
    """What may be in the way, by name: all but the seat, and what lies no higher than castors roll over."""
    found: list[tuple[str, Prism]] = []
    for thing in (*task.world.values(), task.object):
        if thing is None or thing.id == seat.thing.id or thing.kind == "human":
            continue
        prisms = filled(thing)
        if not prisms:
            size = thing.properties.get("size")
            height = float(size[2]) if isinstance(size, (list, tuple)) and len(size) == 3 else np.inf
            low = float(thing.place[2])
            prisms = [Prism(ring, low, low + height) for ring in thing.occupied if len(ring) >= 3]
        found += [(thing.name, prism) for prism in prisms if prism.high > _FLAT]
    return found


def _hindered(task: HumanTask, way: Sequence[Place], around: Sequence[tuple[str, Prism]]) -> str:
    """What is in the way; "" where nothing is. What one is in already hinders only who goes deeper into it."""
    height = float(task.start.root[2])
    discs = np.array([*_OF_SEAT, *((x, y, height + z, wide) for x, y, z, wide in _OF_SITTER)])
    poses = [(way[0].at, way[0].heading)]
    for begin, end in itertools.pairwise(way):
        far, turn = begin.to(end)
        count = 1 + int(max(far, abs(turn) * 0.4) / _APART)
        share = np.arange(1, count + 1) / count
        poses += [(begin.at + s * (end.at - begin.at), begin.heading + s * turn) for s in share]
    at, heading = np.array([pose[0] for pose in poses]), np.array([pose[1] for pose in poses])
    cos, sin = np.cos(heading)[:, None], np.sin(heading)[:, None]
    level = [at[:, :1] + cos * discs[:, 0] - sin * discs[:, 1], at[:, 1:] + sin * discs[:, 0] + cos * discs[:, 1]]
    points = np.stack([*level, np.broadcast_to(discs[:, 2], level[0].shape)], axis=-1)
    for name, prism in around:
        gap = prism.signed(points) - discs[:, 3]
        if (gap.min(axis=0) < np.minimum(gap[0], 0.0) - 1e-6).any():
            return name
    return ""


def _along(task: HumanTask, way: Sequence[Place]) -> Iterator[Array]:
    """POSE rows (n, 260) of each part of a way."""
    rotations, root = task.start.rotations.copy(), task.start.root.copy()
    planted = feet(task.human, rotations, root)
    for begin, end in itertools.pairwise(way):
        far, turn = begin.to(end)
        if far < _STAYS[0] and abs(turn) < _STAYS[1]:
            continue
        seconds = _SECONDS + _A_METRE * far + _A_RADIAN * abs(turn)
        pushes = max(1, int(np.ceil(far / _STRIDE + abs(turn) / _TURN)))
        frames = round(seconds * task.rate)
        time = np.arange(1, frames + 1) / frames
        gone = _gone(time)
        soles = [_steps(planted[i], begin, end, pushes, i == (turn > 0.0), time) for i in range(2)]
        made = np.repeat(rotations[None], frames, axis=0)
        turned = multiply(from_axis_angle(np.broadcast_to(_UP, (frames, 3)), turn * gone), rotations[0])
        made[:, 0] = align(turned, np.broadcast_to(rotations[0], turned.shape))
        roots = np.repeat(root[None], frames, axis=0)
        roots[:, :2] += gone[:, None] * (end.at - begin.at)
        targets = np.zeros((frames, 5, 8))
        targets[:, RIGHT_FOOT, :7], targets[:, LEFT_FOOT, :7] = soles
        targets[:, RIGHT_FOOT : LEFT_FOOT + 1, 7] = 1.0
        made = solve(task.human, made, roots, targets)
        importance = np.zeros(44)
        importance[:BODY], importance[-1] = 1.0, 1.0
        importance[INDEX["head"]] = 0.08
        yield task.block(made, roots, np.repeat(importance[None], frames, axis=0), targets)
        rotations, root, planted = made[-1], roots[-1], np.stack([sole[-1] for sole in soles])


def _carried(foot: Array, begin: Place, end: Place, share: float) -> Array:
    """A foot (7,) as it is before the hips when they have gone a share of the way, as it is now where they begin."""
    turn = begin.to(end)[1] * share
    off, turned = foot[:3] - np.append(begin.at, 0.0), from_axis_angle(_UP, turn)
    there = np.append(begin.at + share * (end.at - begin.at), 0.0) + rotate(turned, off)
    return np.concatenate([there, align(multiply(turned, foot[3:]), foot[3:])])


def _steps(foot: Array, begin: Place, end: Place, pushes: int, leads: bool, time: Array) -> Array:
    """A foot (n, 7) at shares of the time (n): it stands, and steps on once for each push, the leading one first.

    It lands where it is before the hips in the middle of the time for which it then stands, or as it lands if these go
    ahead: with a foot farther ahead of them the thigh would be in the seat.
    """
    ahead = float((end.at - begin.at) @ [np.cos(begin.heading), np.sin(begin.heading)])
    after = _LANDS[0] if ahead > _STAYS[0] else _LANDS[1]
    slots, made = 2 * pushes, np.repeat(foot[None], len(time), axis=0)
    stood = foot
    for push in range(pushes):
        begins = (2 * push + (0 if leads else 1)) / slots
        middle = begins + after / slots if push < pushes - 1 else 1.0
        lands = _carried(foot, begin, end, float(_gone(np.array(middle))))
        lands[3:] = align(lands[3:], stood[3:])
        share = np.clip((time - begins) * slots, 0.0, 1.0)[:, None]
        step = stood + minimum_jerk(share) * (lands - stood)
        step[:, 2] += _LIFT * np.sin(np.pi * share[:, 0]) ** 2
        made = np.where(share > 0.0, step, made)
        stood = lands
    made[:, 3:] /= np.linalg.norm(made[:, 3:], axis=-1, keepdims=True)
    return made


def _gone(time: Array) -> Array:
    """The share of the way that the hips have gone at shares of the time."""
    return minimum_jerk((time - _PUSHED[0]) / (_PUSHED[1] - _PUSHED[0]))
