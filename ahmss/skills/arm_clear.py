"""An arm that uses a control, with its hand, is in nothing that stands about: a console's plate, say, under it.

Where the hand is in what is beside a control is looked at elsewhere (`clearing`): here it is the things that fill more
than a control does, and for the arm without the hand what is beside as well.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.errors import AlgorithmError
from ahmss.reaching.arm_on_way import SUNK
from ahmss.reaching.plan import Plan, Reaching
from ahmss.reaching.prism import Prism, clearance, in_the_way
from ahmss.reaching.reacher import Reacher, seat
from ahmss.reaching.skin import ARM, bare_arm, gaps, hand_skin
from ahmss.skills.box import boxes_of, filled, nearest
from ahmss.skills.neighbours import neighbours

__all__ = ["beyond", "refuse_sunk", "standing_about", "sunk_at", "sunk_in"]

_EVERY = 2  # frames that are looked at
_STANDS_BEFORE = 0.9  # metres from a thing, of who may take the place from which another could do it
_LARGE = 0.25  # metres across, or high: what is smaller is a control, or as one
_SLACK = 0.003  # metres by which balls of fingers may be thicker than their skin
_AT_ONCE = 24  # palms, about, that are looked at


def standing_about(task: HumanTask) -> list[Prism]:
    """What fills more than a control, but for what the hand comes into."""
    return [prism for _, prisms in _things(task) for prism in prisms]


def sunk_in(task: HumanTask, side: str, rotations: Array, root: Array) -> tuple[float, str]:
    """Metres by which an arm is in a thing at the most, deeper than at first, in frames (n, 43, 4), (n, 3); and which.

    Below 0, and "", where it is in none.
    """
    reacher, shown = Reacher.of(task.human, side), (rotations[::_EVERY], root[::_EVERY])
    arm, hand = bare_arm(reacher, *shown), hand_skin(reacher, *shown)
    points, radii = np.concatenate([arm[0], hand[0]], axis=-2), np.concatenate([arm[1], hand[1] - _SLACK])
    deepest = (-np.inf, "")
    for thing, prisms in _things(task):
        deepest = max(deepest, (_deeper(clearance(prisms, points, float(radii.max())) - radii), thing.name))
    beside = _beside(task)
    deep = _deep_in(beside, *arm)
    if deep > max(deepest[0], 0.0):
        deepest = deep, max(beside, key=lambda thing: _deep_in([thing], *arm)).name
    return deepest if deepest[0] > 0.0 else (deepest[0], "")


def _deep_in(things: Sequence[WorldObject], points: Array, radii: Array) -> float:
    """The same for points (n, m, 3) with radii (m,) in the boxes of things."""
    boxes = [box for thing in things for box in boxes_of(thing)]
    gap = nearest(boxes, points.reshape(-1, 1, 3), float(radii.max())).reshape(points.shape[:-1]) - radii
    return _deeper(gap)


def _deeper(gap: Array) -> float:
    """Metres by which skin with such gaps (n, m) is in a thing at the most, deeper than at first."""
    return float((np.minimum(gap[0], 0.0) - gap).max())


def sunk_at(reaching: Reaching, palms: Mapping[str, Array], place: Array, plates: Sequence[Prism]) -> float:
    """Metres by which an arm whose hand is at a place (3,) would be in plates at the least, by sides palms (n, 7).

    The body upright, and the elbow where it goes by itself: it may be less. 0: it need be in none.
    """
    near = in_the_way(plates, reaching.base.root, place)
    if not near:
        return 0.0
    spine, least = seat(reaching.skeleton, reaching.base.rotations, reaching.base.root), np.inf
    for side, rows in palms.items():
        reacher = Reacher.of(reaching.skeleton, side)
        some = rows[:: 1 + len(rows) // _AT_ONCE]
        deep = -gaps(reacher, some, spine, reaching.present(reacher), near)[:, ARM].min(axis=-1)
        least = min(least, float(deep.min(initial=np.inf)))
    return least if SUNK < least < np.inf else 0.0


def beyond(deep: float) -> float:
    """Metres by which such a depth is more than may be."""
    return max(deep - SUNK, 0.0)


def refuse_sunk(task: HumanTask, plan: Plan, rotations: Array, root: Array) -> None:
    """Refuse frames (n, 43, 4), (n, 3) in which the arm of a plan is in what stands about.

    Raises:
        AlgorithmError: says in what, how deep, and what to do.
    """
    deep, name = sunk_in(task, plan.reacher.side, rotations, root)
    if deep > SUNK:
        assert task.object is not None
        if name in [thing.name for thing in _beside(task)]:
            raise AlgorithmError(
                f"{name} is in the way of an arm at {task.object.name}, which would be {1000.0 * deep:.0f} mm in it "
                "however it comes; move one of the two, or use it with the other hand"
            )
        arm = f"the {plan.reacher.side} arm would be {1000.0 * deep:.0f} mm in {name} however it comes to"
        if others := _before(task, task.object):
            raise AlgorithmError(
                f"{arm} {task.object.name} from where there is room beside {others[0].name}; do it when they have gone"
            )
        raise AlgorithmError(
            f"{arm} {task.object.name}, which is too high up, or too far in, for who is {task.human.stature:.2f} m "
            "tall; have somebody taller do it, or move it nearer to an edge"
        )


def _before(task: HumanTask, thing: WorldObject) -> list[WorldObject]:
    """The others who stand before a thing, the nearest first."""
    far = {
        other.id: float(np.linalg.norm((other.place - thing.place)[:2]))
        for other in task.world.values()
        if other.kind == "human"
    }
    return sorted((task.world[number] for number in far if far[number] < _STANDS_BEFORE), key=lambda one: far[one.id])


def _things(task: HumanTask) -> Iterator[tuple[WorldObject, list[Prism]]]:
    """What is about and fills more than a control, each as it fills it."""
    at = None if task.object is None else task.object.place[None]
    for thing in task.world.values():
        if thing.kind == "human" or "blocks" not in thing.properties:
            continue
        prisms = [one for one in filled(thing) if _large(one) and (at is None or clearance([one], at, 0.0)[0] > 0.0)]
        if prisms:
            yield thing, prisms


def _beside(task: HumanTask) -> list[WorldObject]:
    """The controls beside the one that is used; none where none is."""
    is_control = task.object is not None and "box" in task.object.properties
    return neighbours(task) if is_control else []


def _large(prism: Prism) -> bool:
    return max(float(np.ptp(prism.ring, axis=0).max()), prism.high - prism.low) > _LARGE
