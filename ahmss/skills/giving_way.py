"""An arm that holds something while another motion carries the body gives way to things that it would be in.

The arm knows neither where the body goes nor when: it looks as far ahead as the trunk goes on as it does, and the hand
is moved aside as far as that takes (`ahmss.reaching.aside`), turned as it was. Far from things it is left as it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil

import numpy as np

from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.task import HumanTask
from ahmss.body.arm import wrist_of
from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, from_rotation_vector, multiply, rotate, to_rotation_vector
from ahmss.reaching.aside import Aside
from ahmss.reaching.moved_hand import with_hand_moved
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.reacher import Reacher, seat
from ahmss.reaching.skin import skin_of
from ahmss.skills.reaching import prisms_of

__all__ = ["GivingWay", "Things", "points_of"]

_NEAR = 1.1  # metres from the hips beyond which nothing is in an arm's way
_AHEAD = (0.0, 8.0, 16.0)  # frames
_GOES_ON = 12.0  # frames in which a trunk comes to rest, or turns otherwise, as far as can be known
_ON = (_GOES_ON * (1.0 - np.exp(-(np.array(_AHEAD) + 1.0) / _GOES_ON)))[:, None]  # (f, 1) as if it went on evenly
_NEWEST = 0.3  # of how the trunk moves, that the newest frame makes
_DEEP = 0.06  # metres: what a hand is so deep in (a shelf, a basin), or the hips are over, is not in its way
_ALL = 0.04  # metres
_LARGEST = 0.5  # metres: what is larger in a hand is not looked at
_ROUND = 0.03  # metres by which the edges of a thick one are rounded at the most
_GRAIN, _COARSEST = 0.01, 0.065  # metres between its points at the least, at the most


class GivingWay:
    """One arm, from frame to frame.

    Args:
        task: of who holds something.
        side: the arm.
    """

    def __init__(self, task: HumanTask, side: str) -> None:
        self._task, self._reacher = task, Reacher.of(task.human, side)
        self._things = Things(task)
        self._aside = Aside(task.rate)
        self._held = points_of(task, side, task.object)
        self._seat: tuple[Array, Array] | None = None
        self._speed, self._spin = np.zeros(3), np.zeros(3)

    @property
    def moved(self) -> Array:
        """By how much the hand is aside (3,), metres."""
        return self._aside.moved

    @property
    def share(self) -> float:
        """How far it is aside, 0 to 1, where it is all there."""
        return min(float(np.linalg.norm(self.moved)) / _ALL, 1.0)

    def over(self, rotations: Array, root: Array) -> Array:
        """The arm's rows (3, 4) of a pose (43, 4), (3,) in which it is where it is to be kept, out of things."""
        reacher = self._reacher
        spine = seat(reacher.skeleton, rotations, root)
        self._follow(spine)
        prisms = self._things.about(root)
        if not prisms and self._aside.still:
            return rotations[reacher.links]
        skin, radii = skin_of(reacher, rotations, root)
        links = reacher.arm.from_pose(rotations[reacher.links])
        wrist, turn = wrist_of(reacher.arm, links), multiply(spine[1], reacher.arm.rotation)
        place, turned = reacher.shoulder(spine) + rotate(turn, wrist.place), multiply(turn, wrist.rotation)
        held, thick = self._held
        points = np.concatenate([skin, place + rotate(turned, held)])
        radii = np.concatenate([radii, thick])
        present = points + self.moved
        near = [prism for prism in prisms if clearance([prism], present).min() > -_DEEP]
        ahead = self._carried(points, spine).reshape(-1, 3)
        moved = self._aside.step(near, ahead, np.tile(radii, len(_AHEAD)), None, reacher.shoulder(spine))
        if self._aside.still:
            return rotations[reacher.links]
        return with_hand_moved(reacher, rotations, root, moved)

    def _follow(self, spine: tuple[Array, Array]) -> None:
        """Take in how the trunk moves."""
        before, self._seat = self._seat, (spine[0].copy(), spine[1].copy())
        if before is None:
            return
        turn = to_rotation_vector(multiply(spine[1], conjugate(before[1])))
        self._speed = self._speed + _NEWEST * (spine[0] - before[0] - self._speed)
        self._spin = self._spin + _NEWEST * (turn - self._spin)

    def _carried(self, points: Array, spine: tuple[Array, Array]) -> Array:
        """Points (n, 3) of the arm as the trunk is likely to carry them (f, n, 3) in the frames that are looked at."""
        turns = from_rotation_vector(_ON * self._spin)
        return spine[0] + _ON[:, None] * self._speed + rotate(turns[:, None], points - spine[0])


class Things:
    """What may be in the way, where it is now."""

    def __init__(self, task: HumanTask) -> None:
        self._task = task
        self._known: dict[int, tuple[Array, Array]] = {}
        self._prisms: list[Prism] = []

    def about(self, root: Array, *places: Array, sought: bool = False) -> list[Prism]:
        """The prisms near the hips (3,), but those that these are over or that hold one of some places (3,).

        sought: whether with the object's own, which a hand that takes it comes close to.
        """
        now = {thing.id: (thing.place, thing.rotation) for thing in self._task.world.values() if thing.kind != "human"}
        if now.keys() != self._known.keys() or any(
            (now[i][0] != self._known[i][0]).any() or (now[i][1] != self._known[i][1]).any() for i in now
        ):
            self._known = {i: (place.copy(), rotation.copy()) for i, (place, rotation) in now.items()}
            self._prisms = prisms_of(self._task)
        near = [p for p in self._prisms if sought or not p.sought]
        return [p for p in near if _within(p, root) and not _holds(p, root, places)]


def _holds(prism: Prism, root: Array, places: Sequence[Array]) -> bool:
    inside = bool(places) and bool((clearance([prism], np.stack(places)) <= 0.0).any())
    return inside or bool(prism.over(root[None])[0])


def _within(prism: Prism, root: Array) -> bool:
    away = prism.at_least(np.array([[root[0], root[1], prism.low]]))
    return float(away[0]) < _NEAR


def points_of(task: HumanTask, side: str, thing: WorldObject | None) -> tuple[Array, Array]:
    """Points (n, 3) of what is in the hand, in the hand's frame, and their radii (n,): of what says how large it is."""
    size = None if thing is None else thing.properties.get("size")
    if thing is None or not isinstance(size, (list, tuple)) or len(size) != 3 or max(size) > _LARGEST:
        return np.zeros((0, 3)), np.zeros(0)
    length = np.array(size, float)
    radius = min(0.5 * float(length.min()), _ROUND)
    low, high = np.array([-0.5, -0.5, 0.0]) * length + radius, np.array([0.5, 0.5, 1.0]) * length - radius
    counts = [1 if span <= _GRAIN else max(3, 1 + ceil(span / _COARSEST)) for span in high - low]
    axes = [np.linspace(low[i], high[i], counts[i]) for i in range(3)]
    inner = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    if min(counts) > 2:  # its outside is enough
        inner = inner[((inner < low + 1e-9) | (inner > high - 1e-9)).any(axis=-1)]
    middle = thing.frame.apply(inner)
    reacher = Reacher.of(task.human, side)
    place, turned = reacher.hand(task.start.grip(side).row())
    return rotate(conjugate(turned), middle - place), np.full(len(inner), radius)
