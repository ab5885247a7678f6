"""Arms that a walk would let hang from over a thing stay as they are until there is room: on the way they would go
through a table's top.

So it is with an arm whose hand holds something as one sets out, and with one that another motion has had on the way, a
grasp in passing: when that is over, only the walk has it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ahmss.algorithm.task import HumanFrame, HumanTask
from ahmss.body.array import Array
from ahmss.body.quaternion import align, conjugate, multiply, slerp, to_rotation_vector
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.reacher import SIDES, Reacher
from ahmss.reaching.skin import skin_of
from ahmss.skills.giving_way import Things

__all__ = ["let_down", "let_down_free"]

_AT_ONCE = 2  # frames that are worked out before they are shown
_AHEAD = np.arange(0, 41, 8)  # frames that are looked at
_WAY = (0.0, 0.35, 0.7, 1.0)  # shares of an arm's way from where it hangs to where it is
_ENOUGH = 0.05  # metres between skin and things on all of that way, with which it is let down
_LOW, _SUNK = 0.35, 0.04  # metres over a top, and under it, that the lowest skin of a hand may be which is over it
_OTHERS, _MOVED = 0.6, 0.02  # radians from how it was given: so far off an arm is another motion's; it is not still
_COMES = 60  # frames in which an arm comes from where it was as one set out
# Seconds of each of three lags one after the other, by which it is let down softly, and is kept while it is another's.
_LAG, _LAG_KEPT = 0.12, 0.05
_NONE = 1e-3  # how much it is kept, which is none
_ROOT, _ROTATIONS = slice(1, 4), slice(4, 176)  # of a POSE


def let_down(task: HumanTask, made: Iterator[Array]) -> Iterator[Array]:
    """The frames (n, 260) or (n, 272) of a walk, arms that hold something over things kept so until there is room."""
    things = Things(task)
    arms = [_Arm(task, side) for side in task.busy]
    for rows in made:
        rows = np.atleast_2d(np.array(rows))
        for some in _pieces(rows):
            for arm in arms:
                arm.over(rows, some, things)
        yield rows


def let_down_free(task: HumanTask, made: Iterator[Array]) -> Iterator[Array]:
    """The same with arms whose hands held nothing when one set out, which another motion has had meanwhile."""
    things, begun = Things(task), 0
    arms = [_Arm(task, side) for side in SIDES if side not in task.busy]
    for rows in made:
        rows = np.atleast_2d(np.array(rows))
        for some in _pieces(rows):
            for arm in arms:
                arm.take_in(things, begun)
                arm.over(rows, some, things)
            begun += len(rows[some])
            yield rows[some]


def _pieces(rows: Array) -> Iterator[slice]:
    """Slices of rows, a few each."""
    return (slice(first, first + _AT_ONCE) for first in range(0, len(rows), _AT_ONCE))


class _Arm:
    """One arm, from frame to frame. `_given`: its rotations (3, 4) as they were told last."""

    def __init__(self, task: HumanTask, side: str) -> None:
        self._task, self._reacher = task, Reacher.of(task.human, side)
        self._down, self._up = (1.0 - np.exp(-1.0 / (lag * task.rate)) for lag in (_LAG, _LAG_KEPT))
        self._given = self._pose = task.start.rotations[self._reacher.links]
        self._levels, self._wanted = np.zeros(3), False
        if side in task.busy and _is_over(Things(task).about(task.start.root, sought=True), self._skin(task.start)):
            self._levels[:], self._wanted = 1.0, True

    def take_in(self, things: Things, begun: int) -> None:
        """See, after so many frames, whether it is another motion's now, over a thing."""
        present = self._task.present
        now = present.rotations[self._reacher.links]
        off = float(np.linalg.norm(to_rotation_vector(multiply(conjugate(self._given), now)), axis=-1).max())
        if begun >= _COMES and off > _OTHERS and _is_over(things.about(present.root, sought=True), self._skin(present)):
            self._pose, self._wanted = now.copy(), True
        elif self._wanted and off > _MOVED:  # it is moved on, where it is kept
            self._pose = now.copy()

    def over(self, rows: Array, some: slice, things: Things) -> None:
        """Change some of the rows (n, ...), of which all are known."""
        links = self._reacher.links
        own = rows[some, _ROTATIONS].reshape(-1, 43, 4)
        if not self._wanted and float(self._levels.max()) < _NONE:
            self._given = own[-1, links].copy()
            return
        self._wanted = self._wanted and self._gap(rows[some.start :], things) < _ENOUGH
        for row, rotations in zip(rows[some], own, strict=True):
            level = self._level()
            end = align(self._pose, rotations[links])
            self._given = slerp(rotations[links], end, np.full(3, level))
            row[_ROTATIONS].reshape(43, 4)[links] = self._given

    def _level(self) -> float:
        """How much it is kept in the next frame, softly on its way to what is wanted."""
        towards, share = (1.0, self._up) if self._wanted else (0.0, self._down)
        for i in range(len(self._levels)):
            self._levels[i] += share * (towards - self._levels[i])
            towards = float(self._levels[i])
        return towards

    def _skin(self, frame: HumanFrame) -> Array:
        """Points (n, 3) of forearm and hand."""
        return skin_of(self._reacher, frame.rotations, frame.root)[0]

    def _gap(self, rows: Array, things: Things) -> float:
        """Metres between the skin and things in rows to come, on the arm's way from where it hangs, the least."""
        ahead = rows[np.minimum(_AHEAD, len(rows) - 1)]
        root, rotations = ahead[:, _ROOT], ahead[:, _ROTATIONS].reshape(-1, 43, 4)
        near = things.about(root[0], sought=True)
        if not near:
            return np.inf
        links = self._reacher.links
        hangs = rotations[:, links]
        end = align(np.broadcast_to(self._pose, hangs.shape), hangs)
        ways = np.tile(rotations, (len(_WAY), 1, 1))
        ways[:, links] = np.concatenate([slerp(hangs, end, np.full(hangs.shape[:-1], share)) for share in _WAY])
        points, radii = skin_of(self._reacher, ways, np.tile(root, (len(_WAY), 1)))
        return float((clearance(near, points, _ENOUGH + float(radii.max())) - radii).min())


def _is_over(prisms: Sequence[Prism], skin: Array) -> bool:
    """Whether points (n, 3) of a hand are just over a thing."""
    for prism in prisms:
        over = skin[prism.over(skin), 2]
        if len(over) and -_SUNK < over.min() - prism.high < _LOW:
            return True
    return False
