"""A thing that somebody else holds, their hand around it, as one who takes it from them sees both."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ahmss.algorithm.place import Transform, WorldObject
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, rotate, slerp, to_matrix
from ahmss.grasping.coming_off import coming_off
from ahmss.grasping.field import STEP, Field, Joined
from ahmss.grasping.hand import Hand
from ahmss.grasping.holding import DEEP, Holding
from ahmss.grasping.hook import until_it_touches
from ahmss.grasping.power import power_at
from ahmss.motion.steps import Steps

__all__ = ["InHand", "in_their_hand"]

_OPENS = (0.0, 0.5, 1.0)  # how far open a hand is that lets go, and then how far back it is, metres
_BACKS = np.arange(0.02, 0.11, 0.02)
_NEAR = 0.02  # metres from a hand, and skin, within which distances from it are kept
_SPACING, _NODES = 0.005, 2048  # metres between nodes of a field of a hand; nodes at a time
_EACH = 3  # balls of a link: every so many, its ends among them
_ABOUT = 0.13  # metres about that hand where the own one may meet it
_BACK = 0.12  # metres before the axis where palms come from
_INTO_FINGERS = 0.02  # metres by which the axis lies before the palm's middle, towards the fingers
_BESIDE = np.array([0.0, -0.025, 0.025])  # metres along the axis
_OFF, _LATER, _TRIED = 0.015, 1e-4, 16  # metres off the thing at the most; what a later palm costs of it; grips tried
_AROUND = np.radians(55.0)  # that fingers are bent which go around something
_X, _UP = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class InHand:
    """A thing and the hand around it.

    thing, both: distances from it, and from it and the hand, in its frame. found: grips past that hand.
    """

    thing: Field
    both: Field
    found: list[Holding] = field(default_factory=list[Holding])

    def holdings(self, hand: Hand, palms: Array, axis: Array, came: Array, before: float) -> Steps[list[Holding]]:
        """The grips of a hand whose fingers go around the thing too, past the one that has it.

        Args:
            hand: the own. palms: (n, 7) in the thing's frame, turned to its axis as they may come, the best first.
            axis: (7,) whose z it is. came: (14, 4) the fingers as the hand comes. before: metres before where it holds
            that it comes first.
        """
        places, off = self._nearest(hand, palms, axis)
        yield
        order = np.argsort(off + _LATER * np.arange(len(off)), kind="stable")
        found: list[Holding] = []
        for k in order[off[order] < _OFF][:_TRIED].tolist():
            holding = yield from power_at(hand, self.both, places[k], axis)
            bent = holding.flexion[:3].sum(axis=1)  # the little one may hang in the air
            there = holding.palm - np.concatenate([before * rotate(holding.palm[3:], _X), np.zeros(4)])
            free = hand.depth(self.both, there[None], came[None]) < DEEP
            if holding.holds and free and bent.min() > _AROUND:
                found.append(holding)
            yield
        return found

    def _nearest(self, hand: Hand, palms: Array, axis: Array) -> tuple[Array, Array]:
        """Where (m, 7) palms (n, 7) come to, a few for each, and how far (m) off the thing, metres: inf, to nothing."""
        up, out = rotate(axis[3:], _UP), rotate(palms[:, 3:], _X)
        turned = to_matrix(multiply(palms[:, 3:], np.broadcast_to(conjugate(hand.grip[3:]), (len(palms), 4))))
        aside = turned[:, :, 0] - (turned[:, :, 0] @ up)[:, None] * up
        starts = axis[:3] - _BACK * out[:, None] + _BESIDE[:, None] * up - _INTO_FINGERS * aside[:, None]
        balls = np.repeat((hand.palm - hand.grip[:3]) @ turned.swapaxes(1, 2), len(_BESIDE), axis=0)
        starts, out = starts.reshape(-1, 3), np.repeat(out, len(_BESIDE), axis=0)
        went, met = until_it_touches(self.both, starts[:, None] + balls, out, hand.palm_radius)
        places = starts + went[:, None] * out
        gaps = (self.thing.clearance(places[:, None] + balls) - hand.palm_radius).min(axis=1)
        turns = np.repeat(palms[:, 3:], len(_BESIDE), axis=0)
        return np.concatenate([places, turns], axis=1), np.where(met, gaps, np.inf)


def in_their_hand(task: HumanTask, whom: WorldObject, side: str, shape: Field) -> Steps[InHand]:
    """A thing (its shape) in somebody's hand, `"right"` or `"left"`, as it holds it, and as it lets go of it."""
    thing, site = task.object, task.site
    assert thing is not None
    assert site is not None
    hand = _hand_of(task, whom, side)
    to_thing = thing.frame.inverse()
    palm = to_thing.then(whom.site(f"{side}_hand", task.start.root))
    holding = yield from power_at(hand, shape, palm.row(), to_thing.then(site).row())
    yield
    on = palm.then(Transform.of(hand.grip).inverse())
    shapes = slerp(holding.shape, coming_off(hand, holding.shape), np.array(_OPENS)[:, None, None])
    middles, radii = hand.balls(shapes)
    middles, radii = on.apply(middles[..., ::_EACH, :].reshape(len(shapes), -1, 3)), radii[:, ::_EACH].ravel()
    inner = on.apply(hand.palm)
    back = _BACKS[:, None, None] * rotate(palm.rotation, -_X)
    balls = np.concatenate([middles, middles[-1] + back]), np.concatenate([inner[None], inner + back])
    wide = [np.tile(radii, len(balls[0])), np.full(balls[1][..., 0].size, hand.palm_radius)]
    also = yield from _of_balls(
        np.concatenate([some.reshape(-1, 3) for some in balls]), np.concatenate(wide), palm.place
    )
    return InHand(shape, Joined.of(shape, also))


def _hand_of(task: HumanTask, whom: WorldObject, side: str) -> Hand:
    """Their hand: the own, as much larger as their upper arm is."""
    own, (shoulder, elbow) = Hand.of(task.human, side), (f"{side}_shoulder", f"{side}_elbow")
    if shoulder not in whom.sites or elbow not in whom.sites:
        return own
    arm = whom.site(elbow, task.start.root).place - whom.site(shoulder, task.start.root).place
    k = float(np.linalg.norm(arm) / np.linalg.norm(task.human.offsets[INDEX[f"{side}_lower_arm"]]))
    return replace(
        own, roots=k * own.roots, lengths=k * own.lengths, radii=k * own.radii, thumb_root=k * own.thumb_root,
        thumb_lengths=k * own.thumb_lengths, thumb_radii=k * own.thumb_radii, palm=k * own.palm,
        palm_radius=k * own.palm_radius, grip=np.concatenate([k * own.grip[:3], own.grip[3:]]),
    )  # fmt: skip


def _of_balls(middles: Array, radii: Array, place: Array) -> Steps[Field]:
    """The field of balls, their middles (m, 3), of so many metres (m), about a place (3,) where a hand meets them."""
    margin = float(radii.max()) + _NEAR
    first = np.maximum(middles.min(axis=0) - margin, place - _ABOUT)
    last = np.minimum(middles.max(axis=0) + margin, place + _ABOUT)
    shape = tuple((np.ceil((last - first) / _SPACING).astype(int) + 1).tolist())
    found, square = np.empty(shape), (middles**2).sum(axis=1)
    flat = found.reshape(-1)
    for k in range(0, len(flat), _NODES):
        yield
        some = slice(k, min(k + _NODES, len(flat)))
        at = first + _SPACING * np.stack(np.unravel_index(np.arange(some.start, some.stop), shape), axis=-1)
        apart = (at**2).sum(axis=1)[:, None] + square - 2.0 * at @ middles.T
        flat[some] = (np.sqrt(np.maximum(apart, 0.0)) - radii).min(axis=1)
    return Field(first, _SPACING, np.round(found / STEP).astype(np.int16))
