"""The posture from which an arm that is too short alone reaches a palm: turned, leant, lowered, as little as will do.

A search over three numbers (turn, lean, drop of the hips), coarse and then finer: nothing is followed downhill, so a
posture that serves is not missed. Where it ends short, or in a thing, there is another over four: the trunk is turned
either way, and leant past what is to be reached, beside a table's edge, say. What they weigh is effort against how far
the arm is stretched, which trunks begin to spare from 85 to 90 % of its length (Kaminski 1995), against joints beyond
their limits, and against being inside things.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.body.inverse import GAZE, solve
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.motion.steps import Steps
from ahmss.reaching.comfort import discomfort
from ahmss.reaching.leans import Leans, past, towards
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.reacher import SIDES, Reacher, seat
from ahmss.reaching.skin import MARGIN, UPPER_ARM, gaps
from ahmss.reaching.standing import Posture, Standing
from ahmss.reaching.trunk import trunk_points

__all__ = ["Stretch", "looking", "overbent", "posture_for", "stretch_of", "sunk"]

EASY, STRETCHED = 0.86, 0.955
"""Shares of the arm's length up to which the trunk stays, and from which it gives all that is missing."""

_MOST_TURN, _ADVANCE, _ASIDE = np.radians(60.0), np.radians(15.0), np.radians(80.0)
_EFFORT = np.array(
    [0.5 / np.radians(40.0) ** 2, 1.0 / np.radians(60.0) ** 2, 1.3 / 0.3**2, 0.5 / np.radians(60.0) ** 2]
)
_KNEES, _LOW = 4.0, (0.25, 0.4)  # a metre of bent knees for what is not low; low ends so high, metres, and over so many
_EASY, _TOO_FAR, _ARM, _INSIDE, _SUNK, _LIMIT = 4.0, 600.0, 0.15, 400.0, 1e5, 3000.0
_FLOOR, _ON_FLOOR = (0.1, 0.15), 10.0  # metres: so low, and over so many, an arm at ease is worth the knees' bending
_HALF = 0.5
_ROOM, _NOTHING = 0.02, 1e-6  # of the arm's length, by which an arm is to be less than bent altogether; metres
_AT_ONCE, _KEPT = 24, 24  # palms whose skin is looked at together; that are tried in other postures too
_TOGETHER = 72  # postures that are looked at together
_FINER = 1.0, 0.4  # shares of a step by which the best of some is made better
_SHORT, _FAR = 0.001, 0.4  # metres, beyond the first of which an arm ends short; of the second no other lean helps
_SINKS = 0.004  # metres: a trunk so deep is in a thing
_LEGS = [INDEX[f"{side}_{link}"] for side in ("right", "left") for link in ("upper_leg", "lower_leg", "foot")]


@dataclass(frozen=True)
class Stretch:
    """How an arm is in a posture: what it costs, whether its joints allow it, metres too short or too long, stretch."""

    cost: float
    found: bool
    missing: float
    stretched: float

    @property
    def folded(self) -> bool:
        """Whether it is rather too long than too short."""
        return self.stretched < _HALF


def posture_for(
    standing: Standing, reacher: Reacher, palms: Array, present: Array, prisms: Sequence[Prism]
) -> Steps[tuple[Posture, int, Stretch]]:
    """The posture, which of the palms (n, 7) it is for, and how the arm then is.

    Args:
        standing: whose feet stay.
        reacher: the arm.
        palms: the same place, turned in different ways; one of them is chosen.
        present: (3, 4) the arm's links now.
        prisms: what trunk and knees are to keep out of.
    """
    order, arm = yield from _easiest(reacher, palms, standing.base, present, prisms)
    if arm.found and arm.stretched <= EASY and arm.missing <= _NOTHING:
        return standing.base, order[0], arm
    low = float(reacher.hand(palms[order[0]])[0][2]) < sum(_LOW)
    cost, found = yield from _sought(standing, reacher, palms, order, towards(low), present, prisms)
    short = found[2].missing
    if short > _FAR or (short <= _SHORT and not _sinks(standing, found[0], prisms)):
        return found
    other, there = yield from _sought(standing, reacher, palms, order, past(low), present, prisms)
    return there if other < cost else found


def stretch_of(
    reacher: Reacher, palms: Array, posture: Posture, present: Array, prisms: Sequence[Prism]
) -> Steps[tuple[int, Stretch]]:
    """The palm of several (n, 7) that the arm takes most easily in a posture (43, 4), and how it then is."""
    order, arm = yield from _easiest(reacher, palms, posture, present, prisms)
    return order[0], arm


def looking(skeleton: Skeleton, rotations: Array, root: Array, place: Array, weight: Array | float = 1.0) -> Array:
    """Poses (..., 43, 4) with head and spine turned to look at a place (..., 3), as they will be shown."""
    targets = np.zeros((*root.shape[:-1], 5, 8))
    targets[..., GAZE, :3] = place
    targets[..., GAZE, 7] = weight
    return solve(skeleton, rotations, root, targets)


def _easiest(
    reacher: Reacher, palms: Array, posture: Posture, present: Array, prisms: Sequence[Prism]
) -> Steps[tuple[list[int], Stretch]]:
    """The palms (n, 7), the easiest first, and how the arm is with that one."""
    seen = looking(reacher.skeleton, posture.rotations, posture.root, palms[0, :3])
    spine = seat(reacher.skeleton, seen, posture.root)
    cost, found, missing = discomfort(reacher, palms, spine, present)
    if prisms and len(palms) > 1:
        cost = yield from _with_skin(reacher, palms, cost, spine, present, prisms)
    order: list[int] = np.argsort(cost, kind="stable").tolist()
    i = order[0]
    stretched = np.linalg.norm(reacher.hand(palms[i])[0] - reacher.shoulder(spine)) / reacher.length
    return order, Stretch(float(cost[i]), bool(found[i]), float(missing[i]), float(stretched))


def _with_skin(
    reacher: Reacher, palms: Array, cost: Array, spine: tuple[Array, Array], present: Array, prisms: Sequence[Prism]
) -> Steps[Array]:
    """What palms (n, 7) cost (n) with what they are too near to things.

    The easiest are looked at first, and only as many as it takes to know which costs least: of the others it is what
    they cost at least.
    """
    total, rising, least, first = cost.copy(), np.argsort(cost, kind="stable"), np.inf, 0
    for end in (_AT_ONCE, *range(2 * _AT_ONCE, len(palms) + 2 * _AT_ONCE, 2 * _AT_ONCE)):
        some = rising[first:end]
        if not len(some) or cost[some[0]] >= least:
            break
        if first:
            yield
        short = np.maximum(MARGIN - gaps(reacher, palms[some], spine, present, prisms), 0.0)
        total[some] += _INSIDE * (short**2).sum(axis=-1)
        least, first = min(least, float(total[some].min())), end
    return total


def _sought(
    standing: Standing,
    reacher: Reacher,
    palms: Array,
    order: Sequence[int],
    leans: Leans,
    present: Array,
    prisms: Sequence[Prism],
) -> Steps[tuple[float, tuple[Posture, int, Stretch]]]:
    """What the posture costs that costs least, and it, the palm of several (n, 7) that is easiest from it, and the arm.

    order: of the palms, the easiest for who stands first.
    """
    kept, best = np.array(order[:_KEPT]), order[0]
    yield
    cost, chosen, posture = yield from _least(standing, reacher, palms[best], leans, leans.grid(), present, prisms)
    yield
    order, _ = yield from _easiest(reacher, palms[kept], posture, present, prisms)
    best = int(kept[order[0]])
    for share in _FINER:  # by a step the arm changes little
        yield
        grid = leans.around(chosen, share)
        cost, chosen, posture = yield from _least(standing, reacher, palms[best], leans, grid, present, prisms)
    yield
    order, arm = yield from _easiest(reacher, palms[kept], posture, present, prisms)
    return cost, (posture, int(kept[order[0]]), arm)


def _least(
    standing: Standing,
    reacher: Reacher,
    palm: Array,
    leans: Leans,
    grid: Array,
    present: Array,
    prisms: Sequence[Prism],
) -> Steps[tuple[float, Array, Posture]]:
    """What those of some leans' numbers (n, 4) cost that cost least, they, and the posture that they make."""
    turn = float(np.clip(_aside(standing, palm) - reacher.sign * _ADVANCE, -_MOST_TURN, _MOST_TURN))
    numbers = leans.turned(grid, turn)
    best: tuple[float, int, Posture] | None = None
    for first in range(0, len(grid), _TOGETHER):
        if first:
            yield
        some = numbers[first : first + _TOGETHER]
        cost, i, made = yield from _least_of(standing, reacher, palm, some, present, prisms)
        best = (cost, first + i, made) if best is None or cost < best[0] else best
    assert best is not None
    cost, i, made = best
    return cost, grid[i], Posture(standing.on_feet(made.rotations, made.root), made.root)


def _least_of(
    standing: Standing, reacher: Reacher, palm: Array, grid: Array, present: Array, prisms: Sequence[Prism]
) -> Steps[tuple[float, int, Posture]]:
    """The same of a few, turns in radians, which of them it is, and the posture as it is sketched."""
    skeleton, n = standing.skeleton, len(grid)
    turn, lean, drop, veer = grid.T
    wrist = reacher.hand(palm)[0]
    toward = standing.heading + np.clip(_aside(standing, palm), -_ASIDE, _ASIDE) + veer
    made = standing.sketched(turn, lean, toward, drop, _load(standing, reacher, wrist))
    yield
    seen = looking(skeleton, made.rotations, made.root, palm[:3])
    spine = seat(skeleton, seen, made.root)
    cost = (_EFFORT * grid**2).sum(axis=-1)
    cost += _KNEES * np.clip((wrist[2] - _LOW[0]) / _LOW[1], 0.0, 1.0) * drop
    stretched = np.linalg.norm(wrist - reacher.shoulder(spine), axis=-1) / reacher.length
    cost += _EASY * np.maximum(stretched - EASY, 0.0) ** 2 + _TOO_FAR * np.maximum(stretched - STRETCHED, 0.0) ** 2
    cost += _TOO_FAR * np.maximum(reacher.shortest / reacher.length + _ROOM - stretched, 0.0) ** 2
    low = np.clip(1.0 - (wrist[2] - _FLOOR[0]) / _FLOOR[1], 0.0, 1.0)
    cost += (_ARM + low * (_ON_FLOOR - _ARM)) * discomfort(reacher, np.broadcast_to(palm, (n, 7)), spine, present)[0]
    cost += _LIMIT * overbent(skeleton, seen) ** 2
    if prisms:
        cost += _SUNK * sunk(standing, Posture(seen, made.root), prisms, SIDES[1 - reacher.row])
        upper = gaps(reacher, np.broadcast_to(palm, (n, 7)), spine, present, prisms)[:, UPPER_ARM]
        cost += _SUNK * (np.minimum(upper, 0.0) ** 2).sum(axis=-1)
    i = int(np.argmin(cost))
    return float(cost[i]), i, Posture(made.rotations[i], made.root[i])


def _aside(standing: Standing, palm: Array) -> float:
    """Radians, to the left, from where one faces to a palm (7,)."""
    off = palm[:2] - standing.base.root[:2]
    return float((np.arctan2(off[1], off[0]) - standing.heading + np.pi) % (2.0 * np.pi) - np.pi)


def _sinks(standing: Standing, posture: Posture, prisms: Sequence[Prism]) -> bool:
    """Whether the trunk of a posture (43, 4) is deeper in things than it is already."""
    one = Posture(posture.rotations[None], posture.root[None])
    return bool(prisms) and float(sunk(standing, one, prisms)[0]) > _SINKS**2


def sunk(standing: Standing, made: Posture, prisms: Sequence[Prism], arm: str = "") -> Array:
    """How deep trunk, head and knees of postures (n) are in things, deeper than they are already: squares (n) added.

    arm: the side whose arm hangs, and its shoulder counts with it.
    """
    base = standing.base
    before, thick = trunk_points(standing.skeleton, base.rotations, base.root, arm)
    places, _ = trunk_points(standing.skeleton, made.rotations, made.root, arm)
    gap = clearance(prisms, np.concatenate([before[None], places]), max(thick)) - thick
    return (np.maximum(np.minimum(gap[0], 0.0) - gap[1:], 0.0) ** 2).sum(axis=-1)


def _load(standing: Standing, reacher: Reacher, wrist: Array) -> Array:
    """Kilograms times metres (3,) by which a reaching arm's weight is elsewhere than the base posture's."""
    skeleton, first = standing.skeleton, reacher.links.start
    mass = float(skeleton.mass[first : first + 3].sum())
    places, _ = forward(standing.base.rotations, standing.base.root, skeleton.offsets)
    return mass * 0.5 * (wrist - places[first + 2])


def overbent(skeleton: Skeleton, rotations: Array) -> Array:
    """Radians (n) by which spine and legs are turned beyond their limits at the most."""
    links = [INDEX["spine"], *_LEGS]
    upright = skeleton.upright()[0][links]
    turned = to_rotation_vector(multiply(conjugate(upright), rotations[:, links]))
    limits = skeleton.limits[links]
    over = np.maximum(np.maximum(limits[..., 0] - turned, turned - limits[..., 1]), 0.0)
    return over.max(axis=(-1, -2))
