"""The hook grip: fingers through a handle's loop and around its bar, the thumb on top (Napier 1956 calls it so)."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, from_axis_angle, from_matrix, multiply, rotate, to_matrix
from ahmss.grasping.closing import THUMB_MOST, Fingers, Hands, hook_fingers
from ahmss.grasping.field import Field
from ahmss.grasping.hand import FINGERS, Hand, Thumb
from ahmss.grasping.holding import DEEP, THUMB_OPENS_BY, Cost, Holding
from ahmss.motion.steps import Steps

__all__ = ["hook", "until_it_touches"]

# What is tried: radians about the bar by which the palm is turned from how it is, at the knuckles, and of the fingers'
# middle and end joints as they come; metres from the knuckles at which the bar lies across the fingers, and along it.
AROUND = np.radians([0.0, 30.0, -30.0, 60.0, -60.0, 90.0, -90.0])
SLANTS = np.radians([0.0, 15.0, -15.0])  # by which the hand lies askew of the bar, where the arm asks for it
KNUCKLES, ENDS = np.radians([30.0, 10.0, 55.0]), np.radians([[12.0, 55.0], [12.0, 30.0], [75.0, 30.0], [75.0, 30.0]])
THREE = 3  # of these, where the little finger stays straight: it does not go through
ACROSS, NEAR, FAR = np.array([0.022, 0.032]), np.array([0.0, -0.013, 0.013]), np.array([-0.024, 0.024])
TURNS = 1, 3, 6  # of these, counted from how it is: tried alone, then together
ARM = 0.2  # what counts of what a palm costs the arm
MANY, SOME = 48, 2  # hands that are closed; of their balls every second counts as they come
PLENTY, WELL = 3, 0.25  # fingers through the loop that are enough; what then is left over that another might gain
COME, CLOSE_AT_ONCE = 48, 10  # hands that come and that are closed between two pauses
ON = 0.0025  # metres within which a link is on the bar
OPPOSITE = -0.3  # cosine between the normals under the links of a finger that goes around
STRAIGHT = np.radians(10.0)
LEAST = 2  # fingers through the loop
OUTS, RISES, BENDS = (np.radians(a) for a in (np.arange(20.0, 90.0, 2.5), np.arange(0.0, 81.0, 16.0), [8.0, 30.0]))
OPENS, RISEN = np.radians([22.0, 14.0, 7.0, 0.0, 32.0]), np.radians([0.0, -20.0, 20.0, -40.0, 40.0])  # of the thumb
BEHIND = np.array([0.0, 0.01, 0.025, 0.05])  # metres before the bar, where an open thumb is looked at
CLOSER = np.radians(np.linspace(-2.5, 2.5, 21))  # by which the thumb is then turned, to lie on it
BACK, MISSED = 0.12, 0.17  # metres before the bar where the hand begins, and after which it has missed
ROUNDS, CLOSE = 12, 1e-4  # of coming nearer; metres that are none
X = np.array([1.0, 0.0, 0.0])


def hook(hand: Hand, field: Field, rotation: Array, site: Array, cost: Cost | None = None) -> Steps[Holding | None]:
    """The best hook grip about a site's z.

    Args:
        hand: that grips.
        field: of the object, in whose frame all is.
        rotation: (4,) the palm's, its x to the bar, its z along it or against.
        site: (7,) on the bar's axis.
        cost: of palms, for an arm that can't turn the hand to each.

    Returns:
        The grip; None where the bar does not come to lie across at least two fingers that go around it.
    """
    up = rotate(site[3:], np.array([0.0, 0.0, 1.0]))
    slants = SLANTS if cost is not None else SLANTS[:1]
    around, slant = (a.ravel() for a in np.meshgrid(AROUND, slants, indexing="ij"))
    turned = multiply(multiply(from_axis_angle(up, around), rotation), from_axis_angle(X, slant))
    palms = np.concatenate([np.tile(site[:3], (len(around), 1)), turned], axis=1)
    worth = 0.5 * np.abs(around) + 0.5 * np.abs(slant)
    can = np.ones(len(palms), bool)
    if cost is not None:
        of_arm, can = cost(palms)
        worth = worth + ARM * of_arm
    order = np.append(0, 1 + np.argsort(worth[1:], kind="stable"))  # as it is first: a reach may have brought it so
    order = order[can[order]] if can.any() else order  # where it seems to take none its trunk may yet help it
    first, second, third, last = np.split(order, TURNS)
    for few, along in ((first, NEAR), (second, NEAR), (third, NEAR), (last, NEAR), (order[: TURNS[1]], FAR)):
        if not len(few):
            continue
        yield
        hands, start, against = yield from _across(hand, field, palms[few], up, worth[few], along)
        best = yield from _best(hand, field, hands, start, against)
        if best is not None and best.holds:
            yield
            return _held(hand, field, best)
    return None


@dataclass(frozen=True, eq=False)
class _Closed:
    """One hand, its fingers (1, 4, 3) closed from `start` (4, 3), how many go around the bar, and how deep any is."""

    score: float
    one: Hands
    start: Array
    fingers: Fingers
    through: int
    depth: float

    @property
    def holds(self) -> bool:
        return self.through >= LEAST and self.depth < DEEP


def _best(hand: Hand, field: Field, hands: Hands, start: Array, against: Array) -> Steps[_Closed | None]:
    """The best of hands (C) whose fingers close from `start` (C, 4, 3); `against` (C) speaks against each."""
    best: _Closed | None = None
    for first in range(0, len(against), CLOSE_AT_ONCE):
        if best is not None and best.holds and best.score < against[first] - max(best.through, PLENTY) + WELL:
            break  # none that speaks for itself as much as the rest do could be much better
        yield
        some = np.arange(first, min(first + CLOSE_AT_ONCE, len(against)))
        few = hands.chosen(some)
        fingers = hook_fingers(hand, few, field, start[some])
        balls = few.seen(np.broadcast_to(hand.palm, (len(some), *hand.palm.shape)))
        depth = -np.minimum((field.clearance(balls) - hand.palm_radius).min(axis=1), fingers.gaps.min(axis=(1, 2)))
        through = (_around(field, fingers) < OPPOSITE).sum(axis=1)
        off = fingers.loose().mean(axis=1)
        score = against[some] - 1.0 * through + 300.0 * np.maximum(depth - 0.5 * DEEP, 0.0) + 60.0 * off
        i = int(score.argmin())
        if best is None or score[i] < best.score:
            own = Fingers(*(values[[i]] for values in (fingers.flexion, fingers.gaps, fingers.touches)))
            one = few.chosen(np.array([i]))
            best = _Closed(float(score[i]), one, start[first + i], own, int(through[i]), float(depth[i]))
    return best


def _held(hand: Hand, field: Field, closed: _Closed) -> Holding:
    """The grip of a hand whose fingers have closed, the thumb beside them or on top."""
    one, fingers = closed.one, closed.fingers
    flexion, touching = fingers.flexion[0], fingers.gaps[0] < ON
    thumb, gap = _thumb(hand, field, one, flexion)
    names = ["thumb"] if gap < ON else []
    names += [name for name, on in zip(FINGERS, touching.any(axis=1), strict=True) if on]
    q_palm = multiply(from_matrix(one.turn[0]), hand.grip[3:])
    palm = np.concatenate([one.place[0] + one.turn[0] @ hand.grip[:3], q_palm])
    balls = one.seen(hand.palm[None])
    depth = -min(float((field.clearance(balls) - hand.palm_radius).min()), float(fingers.gaps.min()), gap)
    out = _opened(hand, field, one, thumb)
    return Holding(
        palm, hand.rotations(flexion, thumb), flexion, thumb, tuple(names), int(touching.sum()),
        float(_around(field, fingers).min()), max(depth, 0.0), hand.rotations(closed.start, out),
    )  # fmt: skip


def _across(
    hand: Hand, field: Field, turned: Array, up: Array, worth: Array, along: Array
) -> Steps[tuple[Hands, Array, Array]]:
    """Hands (C) whose open fingers (C, 4, 3) lie on a bar along `up`, and what speaks against each (C), the best first.

    The palms' rotations are those of `turned` (n, 7), at a place of the bar; `worth` (n) speaks against these. `along`
    (m) is by how much the fingers' middle is moved along the bar.
    """
    numbers = (range(len(turned)), range(len(KNUCKLES)), range(len(ENDS)), range(len(ACROSS)), range(len(along)))
    which, k, end, a, m = np.array([*product(*numbers)], np.intp).T
    cost = worth[which] + 0.2 * np.abs(KNUCKLES[k] - KNUCKLES[0]) + 4.0 * np.abs(along[m]) + 0.05 * end
    order = np.argsort(cost, kind="stable")
    which, k, end, a, m, cost = (values[order] for values in (which, k, end, a, m, cost))
    knuckle, across, along = KNUCKLES[k], ACROSS[a], along[m]
    start = np.concatenate([knuckle[:, None], ENDS[end]], axis=-1)
    start = np.repeat(start[:, None], 4, axis=1)
    start[end == THREE, 3, 1:] = STRAIGHT
    palms = turned[which, 3:]
    turn = to_matrix(multiply(palms, conjugate(hand.grip[3:])))
    inward = rotate(palms, X)
    root = hand.roots[:3].mean(axis=0)
    bar = np.stack([root[0] + across * np.cos(knuckle), np.zeros_like(across), np.full_like(across, root[2])], axis=-1)
    places = turned[0, :3] + along[:, None] * up - np.einsum("cij,cj->ci", turn, bar) - BACK * inward
    chosen = np.zeros(0, np.intp)
    for low in range(0, len(cost), COME):
        yield
        some = slice(low, low + COME)
        lies, places[some] = _come(hand, field, Hands(places[some], turn[some]), start[some], inward[some])
        chosen = np.concatenate([chosen, low + np.flatnonzero(lies)])[:MANY]
        if len(chosen) == MANY:
            break
    return Hands(places[chosen], turn[chosen]), start[chosen], cost[chosen]


def _come(hand: Hand, field: Field, hands: Hands, start: Array, inward: Array) -> tuple[NDArray[np.bool_], Array]:
    """Whether fingers (C, 4, 3) of hands that come along directions (C, 3) lie on what they meet; their places then."""
    fingers, radii = hand.finger_balls(start)
    some = fingers[..., ::SOME, :].reshape(len(start), -1, 3)
    balls = np.concatenate([some, np.broadcast_to(hand.palm, (len(start), *hand.palm.shape))], axis=1)
    wide = np.concatenate([radii[..., ::SOME].reshape(-1), np.full(len(hand.palm), hand.palm_radius)])
    went, met = until_it_touches(field, hands.seen(balls), inward, wide)
    places = hands.place + went[:, None] * inward
    first = Hands(places, hands.turn).seen(fingers[:, :, 0])
    lies = ((field.clearance(first) - radii[:, 0]).min(axis=-1) < ON).sum(axis=1) >= 1
    return met & lies, places


def _thumb(hand: Hand, field: Field, one: Hands, flexion: Array) -> tuple[Thumb, float]:
    """Where the thumb lies on top of the handle, or else beside the fingers (4, 3); and its gap from the shape."""
    out, rise, bend = (a.ravel() for a in np.meshgrid(OUTS, RISES, BENDS, indexing="ij"))
    i = int(_against(hand, field, one, flexion, Thumb(out, rise, bend), 4.0)[0].argmin())
    few = out[i] + CLOSER
    near = Thumb(few, np.full(len(few), rise[i]), np.full(len(few), bend[i]))
    score, gap = _against(hand, field, one, flexion, near, np.inf)
    k = int(score.argmin())
    return Thumb(few[k], rise[i], bend[i]), float(gap[k])


def _against(hand: Hand, field: Field, one: Hands, flexion: Array, thumbs: Thumb, most: float) -> tuple[Array, Array]:
    """What speaks against thumbs (n) of a hand, and their gaps (n); `most` is what counts of such a gap."""
    balls, radii = hand.thumb_balls(thumbs)
    out = thumbs.out
    seen = one.seen(balls.reshape(1, -1, 3)).reshape(balls.shape)
    gaps = (field.clearance(seen) - radii).reshape(len(out), -1)
    middles, wide = hand.finger_balls(flexion)
    others, wide = middles[:2].reshape(-1, 3), wide[:2].reshape(-1)
    ends = balls[:, 1]
    apart = (np.linalg.norm(ends[:, :, None] - others, axis=-1) - radii[1][:, None] - wide).min(axis=(1, 2))
    nearest = gaps.reshape(len(out), 2, -1)[:, 1].argmin(axis=1)
    pads = seen[np.arange(len(out)), 1, nearest]
    top = -(one.turn[0] @ np.array([0.0, 0.0, 1.0]))  # to the thumb's side
    gap = gaps.min(axis=1)
    score = np.minimum(np.abs(gap) / ON, most) + (1.0 - field.normals(pads) @ top) * (gap < 4.0 * ON) + 0.6 * out
    score += 2000.0 * (np.maximum(-gap - 0.3 * DEEP, 0.0) + np.maximum(-apart - DEEP, 0.0))
    return score, gap


def _opened(hand: Hand, field: Field, one: Hands, thumb: Thumb) -> Thumb:
    """The thumb before it closes: of a few that are as far out as may be that which is clearest of the shape, there and
    on the hand's way to it.
    """
    opens, rise = (a.ravel() for a in np.meshgrid(OPENS, thumb.rise + RISEN, indexing="ij"))
    out = np.minimum(thumb.out + opens, THUMB_MOST)
    balls, radii = hand.thumb_balls(Thumb(out, rise, np.full(len(out), thumb.bend)))
    inward = one.turn[0] @ rotate(hand.grip[3:], X)
    seen = one.seen(balls.reshape(1, -1, 3)).reshape(balls.shape) - BEHIND[:, None, None, None, None] * inward
    gap = (field.clearance(seen) - radii).min(axis=(0, 2, 3))
    against = 0.1 * (np.abs(opens - THUMB_OPENS_BY) + np.abs(rise - thumb.rise))
    i = int((2000.0 * np.maximum(0.5 * DEEP - gap, 0.0) + against).argmin())
    return Thumb(out[i], rise[i], thumb.bend)


def _around(field: Field, fingers: Fingers) -> Array:
    """The least cosine (C, 4) between the normals under a finger's first link and a later one; 1 where it is off."""
    normal = field.normals(fingers.touches)
    on = fingers.gaps < ON
    between = np.einsum("cfi,cfki->cfk", normal[..., 0, :], normal[..., 1:, :])
    return np.where(on[..., :1] & on[..., 1:], between, 1.0).min(axis=-1)


def until_it_touches(
    field: Field, middles: Array, inward: Array, radii: Array | float
) -> tuple[Array, NDArray[np.bool_]]:
    """How far (C) balls (C, B, 3) go along directions (C, 3) until one of each touches, and which do (C)."""
    went, going = np.zeros(len(middles)), np.arange(len(middles))
    for _ in range(ROUNDS):
        on = middles[going] + went[going, None, None] * inward[going, None]
        gap = (field.clearance(on) - radii).min(axis=1)
        went[going] += gap
        going = going[(np.abs(gap) >= CLOSE) & (went[going] < MISSED)]
        if not len(going):
            break
    return went, (went < MISSED) & (went > 0.0)
