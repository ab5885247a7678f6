"""The arm on a plan's way, solved for all frames at once: how its elbow swings, how fast it turns, what it touches."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from ahmss.body.arm import hand_angles, with_hand
from ahmss.body.arm_path import Way, follow
from ahmss.body.arm_yielding import yielding
from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, rotate, to_rotation_vector
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.steps import Steps
from ahmss.reaching.bearing import Bearing
from ahmss.reaching.clear_swings import clear_swings
from ahmss.reaching.plan import HAND_BY, Plan
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.skin import arm_skin, bare_arm
from ahmss.reaching.twist import handed_back, untwisted

__all__ = ["AIMED", "FASTEST", "SUNK", "ArmOnWay", "Sought", "farther", "fastest_of", "solved", "swung_clear"]

Sought = Callable[[Array, Array], float]
"""Metres by which a hand is in what is sought at the most, in poses (n, 43, 4), (n, 3) on its way; below 0 in none."""

FASTEST = np.radians(6.0)
"""What a joint turns in a frame at the most, where that can be helped."""

SUNK = 0.002
"""Metres that an arm may be in things, where there is no other way."""

AIMED = 0.88 * FASTEST
"""What is aimed at for that: what is shown goes on from how the body moves, and catches up."""

_DEEP, _FAST, _BEYOND = 0.01, np.radians(3.0), np.radians(5.0)  # metres in things, radians too fast and beyond limits
_JUMPS = 10.0  # which are as bad as these
_SWING = np.radians(4.5)  # of an elbow whose joints give way, in a frame at the most
_SLOWER = np.radians([4.5, 3.0])  # the same, where its joints turn too fast else
_SOFTLY = 10  # frames
_FOLDED = 0.45  # of the arm's length: nearer to its own shoulder a hand on its way turns the arm fast
_FARTHER = 0.12, 0.24  # metres ahead, or out to its side, by which the way's middle then keeps away from there
_AIR = 0.002  # metres between the skin and things on the way
_NEARLY, _FULLY = 0.94, 0.985  # of the arm's length, on the way: from where on it is spared, and what it never is
_ENDS, _SOFTEST = 0.15, 10  # of the time, at either end, in which it may be stretched as it is there; frames at least
_SOFT, _RAMP = 3.0, 8  # frames: over which a hand that meets a limit is slowed down, and at either end not


@dataclass(frozen=True, eq=False)
class ArmOnWay:
    """The plan that it follows, its links (F, 3, 4), the palms (F, 7) that it has, and the rest as of `Performed`.

    fastest is of all frames, paced of those on the way. sunk: metres by which the skin of the arm, but for the hand, is
    in things that are not sought, in any frame.
    """

    plan: Plan
    links: Array
    palms: Array
    jumps: bool
    fastest: float
    paced: float
    beyond: float
    deep: float = 0.0
    sunk: float = 0.0

    @property
    def flaw(self) -> float:
        """How bad it is on its way, 0: it is fine; in what it is sunk as it is there no other way helps."""
        return self._worse_than(FASTEST)

    @property
    def strain(self) -> float:
        """The same by what is aimed at, and how far it is sunk: of two ways one takes that which has less."""
        return self._worse_than(AIMED) + (self.sunk / _DEEP if self.sunk > SUNK else 0.0)

    def _worse_than(self, fastest: float) -> float:
        too_fast = max(self.fastest - fastest, 0.0)
        return max(self.deep, 0.0) / _DEEP + too_fast / _FAST + self.beyond / _BEYOND + _JUMPS * self.jumps


def solved(plan: Plan, body: Bearing, then: Array, sought: Sought | None = None) -> Steps[ArmOnWay]:
    """The arm on a plan's way, and then after palms (m, 7) that follow."""
    n, palms = len(body.time) - len(then), _asked(plan, body, then)
    arm = yield from _reached(plan, body, palms, n)
    near = [prism for prism in plan.near if not prism.sought]
    if not near and sought is None:
        return arm
    yield
    return _touching(near, body, arm, n, sought)


def swung_clear(arm: ArmOnWay, body: Bearing, then: Array, sought: Sought | None = None) -> Steps[ArmOnWay]:
    """The same arm, its elbow swung out of what it is sunk in, as far as that makes it better."""
    if arm.sunk <= SUNK:
        return arm
    plan, n, palms = arm.plan, len(body.time) - len(then), _asked(arm.plan, body, then)
    near = [prism for prism in plan.near if not prism.sought]
    wrist = plan.reacher.wrist(palms, body.spine)
    serve = yield from clear_swings(plan.reacher, wrist, _present(plan), body.spine, near)
    yield
    other = yield from _reached(plan, body, palms, n, serve)
    yield
    return min(arm, _touching(near, body, other, n, sought), key=lambda one: one.strain)


def _touching(near: Sequence[Prism], body: Bearing, arm: ArmOnWay, n: int, sought: Sought | None) -> ArmOnWay:
    """The arm, and how deep it is in things."""
    reacher = arm.plan.reacher
    if near:
        arm = replace(arm, deep=_touch(reacher, near, body, arm, n), sunk=_sunk(reacher, near, body, arm))
    if sought is None:
        return arm
    seen = body.seen[:n].copy()
    seen[:, reacher.links] = arm.links[:n]
    return replace(arm, deep=max(arm.deep, sought(seen, body.trunk.root[:n])))


def farther(plan: Plan, body: Bearing) -> list[Plan]:
    """The same by ways that keep away from the own shoulder, before or beside it; none where this one does."""
    reacher, (_, turned) = plan.reacher, body.spine
    wrist = reacher.hand(plan.palms(body.time))[0]
    off = np.linalg.norm(wrist - reacher.shoulder(body.spine), axis=-1)
    nearest = int(off.argmin())
    if off[nearest] >= _FOLDED * reacher.length or nearest in (0, len(off) - 1):
        return []
    ahead, out = (rotate(turned[nearest], np.array(axis)) for axis in ([0.0, 0.0, -1.0], [0.0, reacher.sign, 0.0]))
    return [plan.moved(by * way) for way in (ahead, out) for by in _FARTHER]


def fastest_of(rotations: Array) -> float:
    """Radians that any joint (F, n, 4) turns from one frame to the next at the most."""
    steps = multiply(conjugate(rotations[:-1]), rotations[1:])
    return float(np.linalg.norm(to_rotation_vector(steps), axis=-1).max(initial=0.0))


def _asked(plan: Plan, body: Bearing, then: Array) -> Array:
    """The palms (F, 7) along the plan's way, and then those (m, 7) that follow."""
    palms = np.concatenate([plan.palms(body.time[: len(body.time) - len(then)]), then])
    palms = body.begun(plan, plan.reacher.row, palms)
    return _within_reach(plan.reacher, palms, body.spine, body.time)


def _reached(
    plan: Plan, body: Bearing, palms: Array, n: int, serve: NDArray[np.bool_] | None = None
) -> Steps[ArmOnWay]:
    """The arm after palms (F, 7), of which the first n are on the way, its elbow on such of the `SWINGS` as serve."""
    reacher, present = plan.reacher, _present(plan)
    wrist = reacher.wrist(palms, body.spine)
    way = follow(reacher.arm, wrist, present, softly=_SOFTLY, serves=serve)
    if way.jumps.any():
        yield
        way = yielding(reacher.arm, wrist, present, _SWING, _SOFTLY)
    made = _along(plan, body, palms, way, n)
    for step in _SLOWER:
        if made.fastest <= AIMED:
            break
        yield
        way = follow(reacher.arm, wrist, present, step, _SOFTLY, serve)
        if way.jumps.any():
            yield
            way = yielding(reacher.arm, wrist, present, step, _SOFTLY)
        made = min(made, _along(plan, body, palms, way, n), key=lambda one: one.strain)
    return made


def _present(plan: Plan) -> Array:
    """The arm's links (3, 4) as it sets out."""
    reacher = plan.reacher
    return untwisted(reacher.arm.from_pose(plan.start.rotations[reacher.links]))[0]


def _along(plan: Plan, body: Bearing, palms: Array, way: Way, n: int) -> ArmOnWay:
    """The arm that goes such a way after palms (F, 7), as it is shown."""
    reacher = plan.reacher
    begun = reacher.arm.from_pose(plan.start.rotations[reacher.links])
    links, own = _slowed(way, n)
    if own.any():  # on the way a hand is turned as its joints allow, not as the shortest turn would have it
        palms = np.where(own[:, None], reacher.palm(links, body.spine), palms)
    links = handed_back(links, untwisted(begun)[1])
    moved = np.concatenate([begun[None], links])
    fastest, paced = fastest_of(moved), fastest_of(moved[: n + 1])
    beyond = float(way.beyond[len(links) // 4 :].max())  # not where an arm begins beyond its limits
    return ArmOnWay(plan, reacher.arm.into_pose(links), palms, bool(way.jumps.any()), fastest, paced, beyond)


def _slowed(way: Way, n: int) -> tuple[Array, Any]:
    """The arm's links (F, 3, 4), a hand that meets a limit in the first n frames slowed down before, and where the hand
    is not turned as asked (F,).
    """
    own: Any = way.turned > 0.0
    if not own[:n].any():
        return way.links, own
    angles = hand_angles(way.links)
    frames = np.arange(len(angles))
    share = np.clip(np.minimum(frames, n - 1 - frames) / _RAMP, 0.0, 1.0)[:, None]
    smooth = gaussian_filter1d(angles, _SOFT, axis=0, mode="nearest")
    return with_hand(way.links, angles + share * (smooth - angles)), own | (share[:, 0] > 0.0)


def _within_reach(reacher: Reacher, palms: Array, spine: tuple[Array, Array], time: Array) -> Array:
    """Palms (n, 7) that wait, on the way, for a trunk which is not there yet: an arm stretched out is stiff."""
    shoulder = reacher.shoulder(spine)
    off = reacher.hand(palms)[0] - shoulder
    distance = np.linalg.norm(off, axis=-1)
    stretched, span = distance / reacher.length, _FULLY - _NEARLY
    kept = _NEARLY + span * (1.0 - np.exp(-np.maximum(stretched - _NEARLY, 0.0) / span))
    back = np.maximum(stretched - kept, 0.0) * np.where(stretched > _NEARLY, 1.0, 0.0)
    ends = max(_ENDS, _SOFTEST * float(np.diff(time, prepend=0.0).max()))
    # An elbow bends by the root of what is drawn in: squared, it begins as softly.
    on_the_way = minimum_jerk(time / ends) ** 2 * minimum_jerk((HAND_BY - time) / ends)
    out = palms.copy()
    out[:, :3] -= (back * on_the_way * reacher.length / np.maximum(distance, 1e-9))[:, None] * off
    return out


def _touch(reacher: Reacher, prisms: Sequence[Prism], body: Bearing, arm: ArmOnWay, n: int) -> float:
    """How deep, metres, the skin of arm, hand and fingers is in things in the first n frames; below 0 in none.

    Towards either end it may be as near as it is there.
    """
    seen = body.seen[:n].copy()
    seen[:, reacher.links] = arm.links[:n]
    points, radii = arm_skin(reacher, seen, body.trunk.root[:n])
    gap = clearance(prisms, points, _AIR + float(radii.max())) - radii
    time = np.arange(1, n + 1) / n
    first, last = np.minimum(gap[0], _AIR), np.minimum(gap[-1], _AIR)
    leaving = np.where(first < 0.0, 0.4, 0.2)  # what begins in a thing has to come out of it first
    least = np.where(time[:, None] < leaving, first, np.where(time[:, None] > 0.75, last, _AIR))
    return float((least - gap).max())


def _sunk(reacher: Reacher, prisms: Sequence[Prism], body: Bearing, arm: ArmOnWay) -> float:
    """How deep, metres, the skin of upper arm, forearm and palm is in things in any frame, deeper than at first."""
    seen = body.seen.copy()
    seen[:, reacher.links] = arm.links
    points, radii = bare_arm(reacher, seen, body.trunk.root)
    gap = clearance(prisms, points, float(radii.max())) - radii
    return float((np.minimum(gap[0], 0.0) - gap).max())
