"""Reaching while something else carries the body: the place is met in the world, wherever the body then is.

Nothing is known ahead: each frame starts from where the body is now. The palm leaves its place on the body gradually,
by the same profile as if the body stood, and is at its place in the world with the last frame. How the palm is turned
there is chosen as if the body were carried on straight until the arm reaches, and anew until shortly before the end.
A place that the body leaves behind, out of reach, is let go of: the hand comes back to where it was on the body.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ahmss.body.array import Array
from ahmss.body.floor_frame import floor_frame
from ahmss.body.inverse import grips
from ahmss.body.links import INDEX
from ahmss.body.quaternion import align, conjugate, from_rotation_vector, multiply, rotate, slerp, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.motion.easing import minimum_jerk
from ahmss.reaching.comfort import across, discomfort
from ahmss.reaching.evading import Evading
from ahmss.reaching.goal import Goal, palms_of
from ahmss.reaching.led import Led
from ahmss.reaching.prism import Prism
from ahmss.reaching.reacher import Reacher, heading_of, seat
from ahmss.reaching.skin import hand_skin
from ahmss.reaching.tracking import Tracking, speed_towards
from ahmss.reaching.waist import bent_towards

__all__ = ["Carried"]

_SPINE = INDEX["spine"]
_NEAR = 0.85  # of the arm's length: how near the body is taken to be carried
_LED_BY = 0.8  # share of the time until which the way changes for things
_FULL = np.radians(8.0)  # of help from the waist, at which the spine is the reach's
_BETTER = 0.25  # by which another palm must be easier than the one that is gone for: the two do not take turns
_STEP = np.radians(1.0)  # by which the palm at the end is chosen anew from frame to frame
_SETTLED = 0.8  # of the time: from then on the palm's end stays
_MOVE = 0.004  # metres that its end may move in a frame before
_WALKS, _LEAVES_IT = 0.4, 0.001  # a walk's importance for the spine, and what is left to it of that in the end
_TURNS_ON = np.radians(1.5)  # of the trunk, that it is expected to turn on in a frame at the most
_LEFT_FROM = 0.88  # of the arm's length: what is farther off
_LEAVES = 0.004  # and goes away by so many metres a frame, is let go of
_NEWEST = 0.1  # of how fast it goes away that the newest frame makes
_LETS_GO = 36  # frames
_FASTEST, _GAINS = np.radians(2.0), np.radians(0.25)  # of the waist in a frame, and from one frame to the next
_LOOKS, _BENDS = 12, np.radians(4.5)  # frames ahead; a frame, of an elbow that a body which comes on bends
_TINY = 1e-3  # of the time
_COMES_TO_REST = 0.85  # of the speed against the body that the hand had: what is left of it a frame later


class Carried:
    """One hand of a human who is carried, from frame to frame.

    reacher: the arm; palm (7,): where it comes to. short: metres by which the hand was not there in the last step.
    behind: metres by which its arm was behind on its way, as it does not turn so fast, or reach so far yet.

    Args:
        skeleton: the human's measures. goal: where the palm shall be.
        rotations: (43, 4) the pose at the start. root: (3,).
        sides: the hands that may be used; the one that comes there more easily is.
        before: rotations and root a frame before: an arm that swings comes to rest on the way.
    """

    def __init__(
        self,
        skeleton: Skeleton,
        goal: Goal,
        rotations: Array,
        root: Array,
        sides: Sequence[str],
        before: tuple[Array, Array] | None = None,
    ) -> None:
        found: list[tuple[float, int]] = []
        arms = [Reacher.of(skeleton, side) for side in sides]
        palms = [palms_of(goal, reacher, _shoulder(reacher, rotations, root)) for reacher in arms]
        best: list[int] = []
        for i, reacher in enumerate(arms):
            present = reacher.arm.from_pose(rotations[reacher.links])
            spine = _carried_on(reacher, palms[i][:, :3].mean(axis=0), rotations, root)
            cost, _, _ = discomfort(reacher, palms[i], spine, present)
            best.append(int(np.argmin(cost)))
            aside = across(reacher, goal.place, _shoulder(reacher, rotations, root), heading_of(rotations, root))
            found.append((float(cost[best[i]]) + aside, i))
        _, chosen = min(found)
        self.reacher, self.palm = arms[chosen], palms[chosen][best[chosen]]
        self._aim = self.palm[3:]
        self._goal, self._spine = goal, rotations[_SPINE].copy()  # the present changes in place
        self._begun = self.reacher.arm.from_pose(rotations[self.reacher.links])
        self._on_body = _on_body(self.reacher, rotations, root)
        then = (rotations, root) if before is None else before
        self._drift = (self._on_body - _on_body(self.reacher, *then))[:3]
        links = self.reacher.arm.from_pose(then[0][self.reacher.links])
        self._led, self._evading = Led(), Evading(self.reacher, self._begun)
        self._tracking, self.short, self.behind = Tracking(self.reacher, self._begun, links), 0.0, 0.0
        self._waist, self._bends = self._spine, np.zeros(3)
        self._chest = seat(skeleton, *then)[1]
        self._distance, self._goes, self._left, self._time = np.inf, 0.0, 0.0, 0.0

    @property
    def passed(self) -> bool:
        """Whether the body has left the place behind, out of reach."""
        return self._left > 0.0

    @property
    def let_go(self) -> bool:
        """Whether the hand is back where it was on the body."""
        return self._left >= 1.0

    def step(
        self,
        rotations: Array,
        root: Array,
        time: float,
        ahead: Array,
        near: Sequence[Prism] = (),
        *,
        settles: bool = True,
    ) -> tuple[Array, Array, float]:
        """The next frame at a share of the time, from the present pose (43, 4), (3,).

        Args:
            rotations: now. root: where it is about to be.
            time: share of it.
            ahead: (3,) how far the root is likely to be carried until the end, metres: what is still missing then is
                the waist's to give.
            near: things that the arm is to keep out of.
            settles: whether the palm's end stays from shortly before the end on; else it is chosen anew to the last.

        Returns:
            rotations (43, 4), the arm near where its target brings it; the target (8,), its
            weight last: what is let go of has none; the spine's importance.
        """
        reacher = self.reacher
        place, turn = floor_frame(rotations, root)
        self._on_body[:3] += self._drift
        self._drift *= _COMES_TO_REST
        start = np.concatenate([place + rotate(turn, self._on_body[:3]), multiply(turn, self._on_body[3:])])
        spine = self._about_to_be(rotations, root)
        left = self._letting_go(reacher.shoulder(spine))
        done = minimum_jerk(np.array(time)) * (1.0 - left)
        wanted = self._bent(rotations[0], root, ahead, done)
        self._bends = speed_towards(self._waist, wanted, self._bends, _FASTEST, _GAINS)
        bent = self._waist = multiply(self._waist, from_rotation_vector(self._bends))
        angle = np.linalg.norm(to_rotation_vector(multiply(conjugate(self._spine), bent)))
        share = min(float(angle) / _FULL, 1.0)
        out = rotations.copy()
        out[_SPINE] = bent
        if time < _SETTLED or not settles:
            self._end_from(out, root)
        # A hand that sets out goes to where the body will bring it to its place from.
        with_body = 0.0 if settles else 1.0 - minimum_jerk(np.array(time))
        end = np.concatenate([self.palm[:3] - with_body * ahead, self.palm[3:]])
        if near and time < _LED_BY:
            self._led.step(near, self._hand_in(out, root), (start, end), time, ahead)
        others = [prism for prism in near if not prism.sought]  # an elbow comes close to what the hand takes
        wanted = self._led.at(start, end, time)
        wanted = np.concatenate([wanted[:3] + left * (start - wanted)[:3], slerp(wanted[3:], start[3:], left)])
        palm = self._tracking.step(wanted, spine, time, others, self._stretched(time))
        self.behind = float(np.linalg.norm(palm[:3] - wanted[:3]))
        hand = self._hand_in(rotations, root) if near else None
        links, palm = self._evading.step(near, hand, self._tracking.links, (palm, self.palm), spine)
        self.short = float(np.linalg.norm(palm[:3] - self.palm[:3]))
        out[reacher.links] = reacher.arm.into_pose(links)
        return out, np.append(palm, 1.0 - left), _importance(share)

    def _hand_in(self, rotations: Array, root: Array) -> tuple[Array, Array]:
        """Points (n, 3) and radii (n,) of the hand as its palm sees them, with the fingers of a pose."""
        present = grips(self.reacher.skeleton, rotations, root)[self.reacher.row]
        points, radii = hand_skin(self.reacher, rotations, root)
        return rotate(conjugate(present[3:]), points - present[:3]), radii

    def _bent(self, hips: Array, root: Array, ahead: Array, share: Array) -> Array:
        """The spine's rotation (4,), bent by a share of what the waist gives, the body not carried past the place."""
        reacher = self.reacher
        wrist, _ = reacher.hand(self.palm)
        way = max(float(np.linalg.norm(ahead)), 1e-9)
        on = float(np.clip((wrist - root) @ ahead / way, 0.0, way))
        bent = bent_towards(reacher, hips, root + on / way * ahead, self._spine, wrist, eases=True)
        return slerp(self._spine, bent, share)

    def _about_to_be(self, rotations: Array, root: Array) -> tuple[Array, Array]:
        """The spine link's place and rotation in the next frame, the trunk turning on as it does."""
        place, now = seat(self.reacher.skeleton, rotations, root)
        before, self._chest = self._chest, now
        turn = to_rotation_vector(multiply(conjugate(before), now))
        turn = turn * min(1.0, _TURNS_ON / max(float(np.linalg.norm(turn)), 1e-9))
        return place, multiply(now, from_rotation_vector(turn))

    def _letting_go(self, shoulder: Array) -> Array:
        """How far the place is let go of, 0 to 1, where it goes away from the shoulder (3,), beyond the arm."""
        distance = float(np.linalg.norm(self.reacher.hand(self.palm)[0] - shoulder))
        if np.isfinite(self._distance):
            self._goes += _NEWEST * (distance - self._distance - self._goes)
        self._distance = distance
        leaves = self._goes > _LEAVES and distance > _LEFT_FROM * self.reacher.length
        self._left = float(np.clip(self._left + (1.0 if leaves else -1.0) / _LETS_GO, 0.0, 1.0))
        return minimum_jerk(np.array(self._left))

    def _stretched(self, time: float) -> float:
        """Metres from the shoulder that the wrist may be at a share of the time.

        A body that comes on bends the arm of a hand which is at its place, and the faster the straighter that is: the
        elbow is bent so far by now that it need not bend too fast to be as bent as the body is then about to bend it.
        """
        left = (1.0 - time) / max(time - self._time, _TINY)
        self._time = time
        then = np.arange(1.0, min(left, _LOOKS) + 1.0)
        upper, lower = self.reacher.arm.lengths
        far = np.clip(self._distance + self._goes * then, self.reacher.shortest, self.reacher.length)
        cosine = (far**2 - upper**2 - lower**2) / (2.0 * upper * lower)
        bent = float((np.arccos(np.clip(cosine, -1.0, 1.0)) - _BENDS * then).max(initial=0.0))
        return float(np.sqrt(upper**2 + lower**2 + 2.0 * upper * lower * np.cos(bent)))

    def _end_from(self, rotations: Array, root: Array) -> None:
        """Bring the palm at the end, by a step, nearer to what it would be from a pose as this."""
        palms = palms_of(self._goal, self.reacher, _shoulder(self.reacher, rotations, root))
        spine = _carried_on(self.reacher, palms[:, :3].mean(axis=0), rotations, root)
        cost, _, _ = discomfort(self.reacher, palms, spine, self._begun)
        best, same = int(np.argmin(cost)), int(np.argmax(np.abs(palms[:, 3:] @ self._aim)))
        aim = palms[best if cost[best] < cost[same] - _BETTER else same]
        self.palm, self._aim = _nearer(self.palm, aim), aim[3:]

    def missing(self, rotations: Array, root: Array) -> float:
        """Metres by which the arm is too short for its palm in a pose, less than 0 where it is not."""
        wrist, _ = self.reacher.hand(self.palm)
        return float(np.linalg.norm(wrist - _shoulder(self.reacher, rotations, root))) - self.reacher.length


def _importance(share: float) -> float:
    """The spine's importance where so much of it, 0 to 1, is the reach's: little is left to change when a walk ends."""
    owned = share * share * (3.0 - 2.0 * share)
    return _WALKS * owned / (1.0 + _LEAVES_IT - owned)


def _nearer(palm: Array, better: Array) -> Array:
    """A palm (7,) a step on to a better one."""
    rotation = _stepped(palm[3:], align(better[3:], palm[3:]))
    off = better[:3] - palm[:3]
    return np.concatenate([palm[:3] + min(1.0, _MOVE / max(float(np.linalg.norm(off)), 1e-9)) * off, rotation])


def _stepped(rotations: Array, better: Array) -> Array:
    """Rotations (..., 4) at the most a step on to better ones."""
    angle = np.linalg.norm(to_rotation_vector(multiply(conjugate(rotations), better)), axis=-1)
    return slerp(rotations, better, np.minimum(_STEP / np.maximum(angle, 1e-9), 1.0))


def _on_body(reacher: Reacher, rotations: Array, root: Array) -> Array:
    """The palm (7,) of a pose (43, 4), (3,) as seen from the floor under the hips."""
    grip = grips(reacher.skeleton, rotations, root)[reacher.row]
    place, turn = floor_frame(rotations, root)
    back = conjugate(turn)
    return np.concatenate([rotate(back, grip[:3] - place), multiply(back, grip[3:])])


def _shoulder(reacher: Reacher, rotations: Array, root: Array) -> Array:
    return reacher.shoulder(seat(reacher.skeleton, rotations, root))


def _carried_on(reacher: Reacher, place: Array, rotations: Array, root: Array) -> tuple[Array, Array]:
    """The spine link's place and rotation when the body has come straight on to where the arm reaches a place (3,)."""
    off = place - _shoulder(reacher, rotations, root)
    level = float(np.hypot(off[0], off[1]))
    wanted = np.sqrt(max((_NEAR * reacher.length) ** 2 - off[2] ** 2, (0.4 * reacher.length) ** 2))
    on = max(level - float(wanted), 0.0) / max(level, 1e-9) * off * np.array([1.0, 1.0, 0.0])
    spine = seat(reacher.skeleton, rotations, root)
    return spine[0] + on, spine[1]
