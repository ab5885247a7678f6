"""A grasp's task: from what main says (object, shape, site, hand) to a grip of `ahmss.grasping`.

What the shipped algorithms that take hold of something share, and an author may use.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanFrame, HumanTask, ObjectTask
from ahmss.body.array import Array
from ahmss.body.inverse import grips, solve
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import rotate, slerp
from ahmss.errors import AlgorithmError
from ahmss.grasping.field import Field
from ahmss.grasping.hand import Hand
from ahmss.grasping.holding import DEEP, Holding, opener
from ahmss.grasping.power import hooked, is_thick, power
from ahmss.grasping.precision import SPAN, precision
from ahmss.motion.steps import Steps
from ahmss.reaching.comfort import discomfort
from ahmss.reaching.reacher import Reacher, seat
from ahmss.reaching.waist import bent_towards
from ahmss.skills.closing_depth import closing_depth
from ahmss.skills.closing_way import THERE_BY, out_by, there_by
from ahmss.skills.crowded import crowded

__all__ = ["ArmCost", "Closing", "closing", "field_at", "from_skin", "read_shape"]

_LOOKS = np.linspace(0.15, 0.9, 6)  # shares of the way at which the closing fingers are looked at
_MISSES = 0.002  # metres that the palm may be from where it is to hold
_LEVEL, _FROM_BELOW = 0.2, 100.0  # how far up a palm may look, its direction's z, and what one more costs
_SPINE = INDEX["spine"]
_OUTS = (0.0, 0.04, 0.08)  # metres by which a palm goes out whose fingers would be driven into the object else
_SOONER = 1.5  # the palm is there before the fingers have closed, by this much


@dataclass(frozen=True)
class Closing:
    """A grip in the world.

    palm: its frame. shape: (14, 4) rotations of the fingers, in the order of links. wide: (14, 4) of the fingers as
    they must open first; None where they can close from where they are. spine: (4,) as the arm asks the waist to bend;
    None where it may stay. out: metres by which the palm goes out on its way there. by: the share
    of the time at which it is there.
    """

    palm: Transform
    shape: Array
    wide: Array | None
    spine: Array | None = None
    out: float = 0.0
    by: float = THERE_BY


def read_shape(task: HumanTask | ObjectTask) -> None:
    """Have the distances from the object's shape at hand, where it has one: before the first frame there is time.

    Raises:
        AlgorithmError: nothing of it is at the action's site. DataError: it can't be read.
    """
    if task.object is not None and task.object.shape is not None:
        named = task.object.sites.get(task.message.site)
        field_at(task, np.zeros(3) if named is None else np.array(named.position))


def closing(task: HumanTask, side: str, most: float) -> Steps[Closing]:
    """The grip that the action's site asks for: power, about its z, where it says nothing.

    Args:
        task: whose object has a shape.
        side: the hand.
        most: metres that the palm may go to it.

    Raises:
        AlgorithmError: the hand is farther away, or can't hold the object there.
    """
    thing = task.object
    assert thing is not None
    to_object = thing.frame.inverse()
    site, grip = to_object.then(task.site or thing.frame), to_object.then(task.start.grip(side))
    field = crowded(task, field_at(task, site.place), site.place)
    far = float(field.alone.clearance(grip.place))
    if far > 2.0 * most:
        own = thing.name.rpartition("/")[2]
        raise AlgorithmError(
            f"the palm is {far:.2f} m from {thing.name}; reach for it first, and while walking say what follows with "
            f"`then`, as a hand goes back when its reach is over: `with {own} reach then {own} grasp`"
        )
    named = thing.sites.get(task.message.site)
    hand = Hand.of(task.human, side)
    arm = ArmCost(task, side)
    pinched = named is not None and named.grip == "precision"
    if pinched:
        holding = yield from precision(hand, field, grip.row(), site.row(), arm.cost)
    else:
        holding = yield from power(hand, field, grip.row(), site.row(), arm.cost)
    if holding is None or not holding.holds:
        raise AlgorithmError(_why(thing.name, hand, field, holding))
    yield
    try:
        return (yield from closing_into(task, side, holding, most))
    except AlgorithmError:
        if pinched or is_thick(field, site.row()):
            raise
        other = yield from hooked(hand, field, grip.row(), site.row(), arm.cost)
        if other is None or not other.holds:
            raise
    return (yield from closing_into(task, side, other, most))


def closing_into(
    task: HumanTask, side: str, holding: Holding, most: float, shape: Field | None = None
) -> Steps[Closing]:
    """The closing into a grip of the action's site, from where the hand is, on which that is not driven into it.

    shape: what it closes on, where that is more than the object: somebody's hand around it, say.

    Raises:
        AlgorithmError: the arm does not bring the hand there, it is farther away, or would be driven into it;
            says by how much.
    """
    thing = task.object
    assert thing is not None
    to_object = thing.frame.inverse()
    grip, palm = to_object.then(task.start.grip(side)), Transform.of(holding.palm)
    at = to_object.then(task.site or thing.frame).place
    field = crowded(task, shape or field_at(task, at), at)
    spine, hand = ArmCost(task, side).spine_for(palm), Hand.of(task.human, side)
    far = float(np.linalg.norm(palm.place - grip.place))
    if far > most:
        raise AlgorithmError(f"the palm is {far:.2f} m from where it holds {thing.name}; reach for it first")
    present = task.start.rotations[list(fingers(side))]
    wide, out, by = _wide(hand, field, grip, present, holding), 0.0, THERE_BY
    if task.length and not task.message.wish:  # who may take longer takes longer
        by = there_by(grip.row(), holding.palm, task.length)
    if wide is not None:
        yield
        out = out_by(hand, field, (grip.row(), holding.palm), (present, holding.shape, wide), by)
    made = Closing(thing.frame.then(palm), holding.shape, wide, spine, out, by)
    return made if task.carried else (yield from _kept_out(task, side, field, made, holding))


def _kept_out(task: HumanTask, side: str, field: Field, made: Closing, holding: Holding) -> Steps[Closing]:
    """The closing, or one that opens wider and goes farther out, on which the hand is not driven into the object.

    Raises:
        AlgorithmError: it would be on each.
    """
    assert task.object is not None
    least, wide = np.inf, opener(Hand.of(task.human, side), holding) if holding.wide is None else holding.wide
    for way in (made, *(replace(made, wide=wide, out=out) for out in _OUTS)):
        yield
        deep = closing_depth(task, side, field, way.palm.row(), (way.shape, way.wide), way.spine, way.out, way.by)
        outside = np.flatnonzero(deep < DEEP)  # a hand that is in it already has to come out first
        driven = float(deep[outside[0] if len(outside) else -1 :].max())
        if driven < DEEP:
            return way
        least = min(least, driven)
    raise AlgorithmError(
        f"the {side} hand would be {1000.0 * least:.0f} mm in {task.object.name} as it closes; reach for it from "
        "elsewhere, or with the other hand"
    )


class ArmCost:
    """The arm of a hand, as the body is now: which palms, in the object's frame, it can bring the hand to."""

    def __init__(self, task: HumanTask, side: str) -> None:
        assert task.object is not None
        self.task, self.thing = task, task.object
        self.reacher = Reacher.of(task.human, side)

    def cost(self, palms: Array) -> tuple[Array, NDArray[np.bool_]]:
        """What palms (n, 7) cost the arm, and which it can take; more where it looks up: there is what it stands on."""
        start, reacher = self.task.start, self.reacher
        grip = self.thing.frame.then(Transform.of(palms)).row()
        rotations = np.repeat(start.rotations[None], len(palms), axis=0)
        rotations[:, _SPINE] = self._bent(grip)
        spine = seat(self.task.human, rotations, np.repeat(start.root[None], len(palms), axis=0))
        present = reacher.arm.from_pose(start.rotations[reacher.links])
        cost, found, missing = discomfort(reacher, grip, spine, present)
        upward = np.maximum(rotate(grip[:, 3:], np.array([1.0, 0.0, 0.0]))[:, 2] - _LEVEL, 0.0)
        return cost + _FROM_BELOW * upward, found & (missing < _MISSES)

    def spine_for(self, palm: Transform) -> Array | None:
        """The spine (4,) with which the arm brings the palm there; None where it may stay, or while one walks.

        Raises:
            AlgorithmError: the palm stays so far away that thumb or fingers would not be on the object.
        """
        start = self.task.start
        goal = self.thing.frame.then(palm).row()
        if self.task.carried or self._misses(goal, start.rotations[_SPINE]) < _MISSES:
            return None
        bent = self._bent(goal)
        misses = self._misses(goal, bent)
        if misses > _MISSES:
            raise AlgorithmError(
                f"the {self.reacher.side} arm can't bring the hand to where it holds {self.thing.name}: it misses by "
                f"{100.0 * misses:.1f} cm; stand nearer or elsewhere, or give the site another rotation"
            )
        return bent

    def _bent(self, grip: Array) -> Array:
        """Spines (..., 4) bent at the waist as palms (..., 7) in the world ask for."""
        start = self.task.start
        shape = grip.shape[:-1]
        hips, spine = (np.broadcast_to(start.rotations[i], (*shape, 4)) for i in (0, _SPINE))
        root = np.broadcast_to(start.root, (*shape, 3))
        return bent_towards(self.reacher, hips, root, spine, self.reacher.hand(grip)[0])

    def _misses(self, goal: Array, spine: Array) -> float:
        """Metres that the palm stays away from a goal (7,)."""
        start, row = self.task.start, self.reacher.row
        targets = np.zeros((5, 8))
        targets[row, :7], targets[row, 7] = goal, 1.0
        rotations = start.rotations.copy()
        rotations[_SPINE] = spine
        rotations = solve(self.task.human, rotations, start.root, targets)
        return float(np.linalg.norm(grips(self.task.human, rotations, start.root)[row, :3] - goal[:3]))


def from_skin(task: ObjectTask, human: HumanFrame, side: str) -> float:
    """How far the nearest of palm and fingers is from the shape of the object, metres, negative inside."""
    named = task.object.sites.get(task.message.site)
    field = field_at(task, np.zeros(3) if named is None else np.array(named.position))
    hand, palm = Hand.of(task.human, side), task.object.frame.inverse().then(human.grip(side))
    skin = -hand.depth(field, palm.row()[None], human.rotations[None, list(fingers(side))])
    return min(float(field.clearance(palm.place)), skin)


def field_at(task: HumanTask | ObjectTask, place: Array) -> Field:
    """The distances from the object's shape around a place (3,) in its frame.

    Raises:
        AlgorithmError: nothing of it is there.
    """
    assert task.object is not None
    assert task.object.shape is not None
    try:
        return task.object.shape.field(place)
    except ValueError:
        raise AlgorithmError(f"{task.object.name} has nothing to hold at its site {task.message.site!r}") from None


def _why(name: str, hand: Hand, field: Field, holding: Holding | None) -> str:
    """The sentence where no grip holds."""
    if holding is None:
        return f"the hand can't close around {name} there; it spans {SPAN:.2f} m, and must come to it from outside"
    if holding.depth >= DEEP:
        own = hand.depth(field.alone, holding.palm[None], holding.shape[None])
        what = "something of it" if own >= DEEP else "what it stands on or beside"
        return f"the hand can't hold {name} there: {what} is in the way"
    return f"the hand can't hold {name} there: it is too wide for thumb and fingers to come to opposite sides"


def _wide(hand: Hand, field: Field, grip: Transform, present: Array, holding: Holding) -> Array | None:
    """The fingers (14, 4) as they must open first, if closing from the present ones (14, 4) would go through it."""
    if holding.wide is not None:
        return holding.wide
    palm, arrived = Transform.of(holding.palm), np.minimum(_SOONER * _LOOKS, 1.0)
    places = grip.place + arrived[:, None] * (palm.place - grip.place)
    palms = np.concatenate([places, slerp(grip.rotation, palm.rotation, arrived)], axis=1)
    if hand.depth(field, palms, slerp(present, holding.shape, _LOOKS[:, None])) < DEEP:
        return None
    return opener(hand, holding)
