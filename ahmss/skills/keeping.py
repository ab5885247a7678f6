"""A hand that holds something while the body goes on: arm and thing are kept out of what stands about.

One walks past a panel, or goes to it and leans over it while the other hand is at work, and what is held goes along;
where it would be in something the hand is moved aside with it, turned as it was, sooner than it would be there
(`ahmss.reaching.aside`). An arm that another motion has is left to it, which may keep what is held upright as well:
main says which are led as one begins, and they are until they are seen to be as they are told.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.arm import wrist_of
from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, rotate, to_rotation_vector
from ahmss.motion.way import AHEAD
from ahmss.reaching.aside import AIR, Aside
from ahmss.reaching.moved_hand import with_hand_moved
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.reacher import Reacher, seat
from ahmss.reaching.skin import skin_of
from ahmss.skills.giving_way import Things, points_of

__all__ = ["kept_clear"]

_AHEAD = (0, 5, 10, 15, 20, 25, 30)  # frames that are looked at: who goes aside by a hand's breadth needs as many
_GOES_ON = 10.0  # frames in which a hand comes to rest, as far as can be known where no more frames are
_ON = _GOES_ON * (1.0 - np.exp(-np.arange(1.0, _AHEAD[-1] + 1.0) / _GOES_ON))
_AT_ONCE = 2  # frames that are worked out before they are shown
_MOVES = 0.15  # metres that a hand may go farther aside: what is farther off is not looked at
_DEEP = 0.06  # metres: what a hand is so deep in (a shelf) is not in its way
_GOES = 0.1  # metres in the frames that are looked ahead: who goes less far stands more or less
# Metres aside at which it counts in full; how much it then does, more than that of who keeps the arm as it is and does
# not know where the body goes.
_ALL, _CARES = 0.04, 400.0
_OTHERS = 0.6  # radians from how it was told: an arm that is so far off is another motion's
# One that is led has parted from it so far off; then so near again, so many times on end, it is led no more.
_PARTED, _AS_TOLD, _TIMES = 0.1, 0.03, 15
_ROOT, _ROTATIONS, _IMPORTANCE, _WAY = slice(1, 4), slice(4, 176), 176, 260  # of a POSE


def kept_clear(task: HumanTask, made: Iterator[Array], *, narrow: bool = False) -> Iterator[Array]:
    """The frames (n, 260) or (n, 272) of a motion, arms whose hands hold something kept out of things with them.

    narrow: it takes the body through what leaves an arm no room, as a doorway: one that is led goes aside as well.
    """
    led = () if narrow else task.led
    arms = [_Held(task, *task.busy)] if task.between else [_Held(task, side, led=side in led) for side in task.busy]
    if not arms:
        yield from made
        return
    rotations, root = task.start.rotations.copy(), task.start.root.copy()
    for rows in made:
        rows = np.atleast_2d(np.array(rows))
        poses, roots = np.empty((len(rows), 43, 4)), np.empty((len(rows), 3))
        for k, row in enumerate(rows):  # what nobody cares for stays as it is
            cares = row[_IMPORTANCE : _IMPORTANCE + 44] > 0.0
            rotations = np.where(cares[:43, None], row[_ROTATIONS].reshape(43, 4), rotations)
            root = row[_ROOT] if cares[43] else root
            poses[k], roots[k] = rotations, root
        ways = [arm.way(poses, roots, _soon(task, rows[-1])) for arm in arms]
        for first in range(0, len(rows), _AT_ONCE):
            some = slice(first, first + _AT_ONCE)
            for arm, way in zip(arms, ways, strict=True):
                arm.over(rows[some], poses[some], roots[some], way, first)
            yield rows[some]


def _soon(task: HumanTask, row: Array) -> Array | None:
    """How far (30, 1, 3) the body goes in the frames after a POSE (260,) or (272,), as its way tells, if it does."""
    if len(row) <= _WAY or np.isnan(row[_WAY]):
        return None
    off = np.append(row[_WAY : _WAY + 2] - row[1:3], 0.0)
    return (np.arange(1.0, len(_ON) + 1.0) / (AHEAD[0] * task.rate))[:, None, None] * off


class _Held:
    """The arm whose hand holds something, or both arms that hold one thing between them: they go aside together.

    led: it is another motion's, until it is seen to be as it is told.
    """

    def __init__(self, task: HumanTask, *sides: str, led: bool = False) -> None:
        self._reachers = [Reacher.of(task.human, side) for side in sides]
        self._aside, self._things = Aside(task.rate), Things(task)
        self._held, self._thick = points_of(task, sides[0], task.in_hand(sides[0]))
        self._led, self._parted, self._as_told = led, False, 0
        self._along: Array | None = None  # the way of the body
        self._last: Array | None = None  # where its points were at the frame before
        self._task, self._given = task, [task.start.rotations[reacher.links].copy() for reacher in self._reachers]

    def way(self, rotations: Array, root: Array, soon: Array | None) -> Array:
        """Points (n + 30, m, 3) of forearm, hand and what it holds in poses (n, 43, 4), (n, 3), and as they go on.

        soon: how far (30, 1, 3) the body is to go on from there, where that is known.
        """
        skins = [skin_of(reacher, rotations, root) for reacher in self._reachers]
        hands = [_hand(reacher, rotations, root) for reacher in self._reachers]
        self._shoulders = np.mean([shoulder for shoulder, _, _ in hands], axis=0)
        _, place, turned = hands[0]
        held = place[:, None] + rotate(turned[:, None], self._held)
        self._radii = np.concatenate([*(radii for _, radii in skins), self._thick])
        skin = np.concatenate([points for points, _ in skins], axis=1)
        self._skin = skin.shape[1]
        points = np.concatenate([skin, held], axis=1)
        before = points[-2] if len(points) > 1 else self._last
        gone = 0.0 if soon is None else float(np.linalg.norm(soon[-1]))
        self._along = None if soon is None or gone < _GOES else soon[-1, 0] / gone
        speed = np.zeros(points.shape[1:]) if before is None else points[-1] - before
        self._last = points[-1]
        return np.concatenate([points, points[-1] + (_ON[:, None, None] * speed if soon is None else soon)])

    def over(self, rows: Array, rotations: Array, root: Array, way: Array, first: int) -> None:
        """Change rows (n, ...) of poses (n, 43, 4), (n, 3), from frame `first` of its points (N + 30, m, 3) on."""
        if self._is_anothers():
            self._aside = Aside(self._task.rate)
            self._given = [rotations[-1, reacher.links] for reacher in self._reachers]
            return
        prisms = self._things.about(root[0], sought=True)
        for k in range(len(rows)):
            self._give(rows[k], [rotations[k, reacher.links] for reacher in self._reachers])
            ahead = way[first + k + np.array(_AHEAD)]
            aside, room = self._aside.moved, float(self._radii.max()) + AIR + _MOVES
            low, high = ahead.min(axis=(0, 1)) - room, ahead.max(axis=(0, 1)) + room
            low, high = np.minimum(low, low + aside), np.maximum(high, high + aside)
            skin = way[first + k, : self._skin] + aside
            near = [prism for prism in prisms if prism.meets(low, high) and not _deep_in(prism, skin)]
            if not near and self._aside.still:
                continue
            radii, shoulder = np.tile(self._radii, len(ahead)), self._shoulders[first + k]
            moved = self._aside.step(near, ahead.reshape(-1, 3), radii, self._along, shoulder)
            if self._aside.still:
                continue
            self._give(rows[k], [with_hand_moved(reacher, rotations[k], root[k], moved) for reacher in self._reachers])
            share = min(float(np.linalg.norm(moved)) / _ALL, 1.0)
            for reacher in self._reachers:
                cares = slice(_IMPORTANCE + reacher.links.start, _IMPORTANCE + reacher.links.stop)
                rows[k, cares] = np.maximum(rows[k, cares], _CARES * share)

    def _give(self, row: Array, arms: list[Array]) -> None:
        """Tell how the arms (3, 4) are in a row (260,) or (272,)."""
        for reacher, arm in zip(self._reachers, arms, strict=True):
            row[_ROTATIONS].reshape(43, 4)[reacher.links] = arm
        self._given = arms

    def _is_anothers(self) -> bool:
        """Whether the arm is led, or not where it was told to be."""
        now = [self._task.present.rotations[reacher.links] for reacher in self._reachers]
        turned = to_rotation_vector(multiply(conjugate(np.array(self._given)), np.array(now)))
        off = float(np.linalg.norm(turned, axis=-1).max())
        self._parted = self._parted or off > _PARTED
        self._as_told = self._as_told + 1 if self._parted and off < _AS_TOLD else 0
        self._led = self._led and self._as_told < _TIMES
        return self._led or off > _OTHERS


def _hand(reacher: Reacher, rotations: Array, root: Array) -> tuple[Array, Array, Array]:
    """Where the shoulder (n, 3) and the hand (n, 3), (n, 4) are in poses (n, 43, 4), (n, 3)."""
    spine = seat(reacher.skeleton, rotations, root)
    wrist = wrist_of(reacher.arm, reacher.arm.from_pose(rotations[:, reacher.links]))
    turn, shoulder = multiply(spine[1], reacher.arm.rotation), reacher.shoulder(spine)
    return shoulder, shoulder + rotate(turn, wrist.place), multiply(turn, wrist.rotation)


def _deep_in(prism: Prism, points: Array) -> bool:
    """Whether one of points (m, 3) is so deep in a thing that it is not in their way."""
    return prism.meets(points.min(axis=0), points.max(axis=0)) and clearance([prism], points, 0.0).min() <= -_DEEP
