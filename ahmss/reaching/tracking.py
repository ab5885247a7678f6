"""An arm after a palm from frame to frame, what comes next being unknown: within its limits, and never with a jerk.

Of what is asked, the arm does what it can. Too far away, it is stretched towards it, though not stiff. The elbow stays
where it is carried by the smallest turns, and swings aside as far as that spares the hand; what is left then of a turn
that the hand's joints don't allow is left out, and the palm keeps its place. Each joint turns and gains speed no faster
than a person's does, and so lags behind what leaps.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ahmss.body.arm import Wrist, hand_angles, with_hand, wrist_of
from ahmss.body.arm_choice import present_side
from ahmss.body.arm_swing import HAND, SHOULDER, limits_of, swing_of
from ahmss.body.array import Array
from ahmss.body.quaternion import align, between, conjugate, from_rotation_vector, multiply, rotate, to_rotation_vector
from ahmss.motion.easing import minimum_jerk
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.reacher import Reacher

__all__ = ["Tracking", "speed_towards"]

_FASTEST, _GAINS = np.radians(6.0), np.radians(1.2)  # of a joint in a frame, and from one frame to the next
# At first what is shown still catches up with this, from what the arm did before: a joint turns by so much less until
# the one share of the time, and as usual from the other on.
_AT_FIRST, _UNTIL, _USUAL = np.radians(1.6), 0.3, 0.5
_NEARLY, _FULLY = 0.82, 0.92  # of the arm's length, on the way: from where on it is spared, and what it never is
_AT_END, _STIFF = 0.985, 0.9995  # the same at either end, where it may be stretched as it must
_BEGINS, _ENDS = 0.5, 0.1  # of the time, in which the one becomes the other
_BRAKES = 5.0  # frames, by which a hand that goes on as it does stays before its limits
_ROUNDS = 3  # of finding the wrist's place for a hand that isn't turned as asked
_SWINGS = np.radians(np.linspace(-70.0, 70.0, 57))  # of the elbow, that are tried
_SWUNG, _SHOULDER = 0.25, 3.0  # what a radian of it costs, and one over the shoulder's limits, where the hand's costs 1
_KEEPS = np.radians(4.0)  # from a limit that a joint keeps where it can
_GIVES = np.radians(3.0)  # beyond a limit, that a hand gives before the palm is turned otherwise than asked
_FOREARM = np.array([[0.0], [0.35], [0.7]])  # of the way from elbow to wrist: places on it that keep out of things
_ROOM, _DEEP = 0.055, 0.01  # metres around these, and what of it may lack for as much as a radian beyond a limit
_X = np.array([1.0, 0.0, 0.0])
_TINY = 1e-9


class Tracking:
    """One arm's joints, from frame to frame.

    links: (3, 4) as they are, against the shoulder frame.
    """

    def __init__(self, reacher: Reacher, links: Array, before: Array | None = None) -> None:
        """Begin at links (3, 4), which were others (3, 4) a frame before."""
        self._reacher, self.links = reacher, links
        before = links if before is None else align(before, links)
        self._speed = to_rotation_vector(multiply(conjugate(before), links))
        self._limits = limits_of(reacher.arm)
        self._near: Sequence[Prism] = ()
        self._most = np.inf
        self._hand = self._limits[HAND] + np.array([-_GIVES, _GIVES])
        self._place = wrist_of(reacher.arm, links).place
        self._side = present_side(reacher.arm, links, self._place)

    def step(
        self, palm: Array, spine: tuple[Array, Array], time: float, near: Sequence[Prism] = (), most: float = np.inf
    ) -> Array:
        """Bring the arm, by a frame, as near as it can come to a palm (7,) in the world; returns the palm it has (7,).

        Args:
            palm: what is asked for.
            spine: place (3,) and rotation (4,) of the spine link as it is about to be.
            time: share of the reach's: towards either end the arm may be stretched further.
            near: things that the elbow swings out of.
            most: metres from the shoulder that the wrist is to be by now at the most.
        """
        self._near, self._most = near, most
        wanted = self._allowed(palm, spine, time)
        fastest = _FASTEST - _AT_FIRST * float(np.clip((_USUAL - time) / (_USUAL - _UNTIL), 0.0, 1.0))
        self._speed = speed_towards(self.links, wanted, self._speed, fastest, _GAINS)
        self._brake()
        self.links = multiply(self.links, from_rotation_vector(self._speed))
        return self._palm(self.links, spine)

    def _brake(self) -> None:
        """Slow a hand down before its limits: who lets go of it then is not carried beyond them."""
        bent = to_rotation_vector(self.links[2])[1:]
        low, high = self._hand[1:].T
        self._speed[2, 1:] = np.clip(self._speed[2, 1:], (low - bent) / _BRAKES, (high - bent) / _BRAKES)

    def _allowed(self, palm: Array, spine: tuple[Array, Array], time: float) -> Array:
        """The links (3, 4), within their limits, that come as near as they can to a palm."""
        asked, links = palm, self.links
        for _ in range(_ROUNDS):
            wrist = self._reacher.wrist(self._within_reach(asked, spine, time), spine)
            links = self._easiest(wrist, spine)
            asked = np.concatenate([palm[:3], self._palm(links, spine)[3:]])
        place = wrist_of(self._reacher.arm, links).place
        self._side, self._place = self._carried_side(place), place
        return links

    def _easiest(self, wrist: Wrist, spine: tuple[Array, Array]) -> Array:
        """The links (3, 4) for a wrist pose, the elbow swung a little where that spares a joint."""
        arm, n = self._reacher.arm, len(_SWINGS)
        side = np.tile(self._carried_side(wrist.place), (n, 1))
        swing = swing_of(arm, Wrist(np.tile(wrist.place, (n, 1)), np.tile(wrist.rotation, (n, 1))), side)
        arms = swing.links(_SWINGS)
        cost = self._strain(arms) + _SWUNG**2 * _SWINGS**2
        if self._near:
            cost += (self._lack(arms[:, 0], wrist.place, spine) / _DEEP) ** 2
        best = int(np.clip(cost.argmin(), 1, n - 2))
        left, here, right = cost[best - 1 : best + 2]
        between_two = 0.5 * (left - right) / max(left - 2.0 * here + right, _TINY)
        phi = _SWINGS[best] + np.clip(between_two, -1.0, 1.0) * (_SWINGS[1] - _SWINGS[0])
        links = swing.links(np.full(n, phi))[0]
        return with_hand(links, np.clip(hand_angles(links), *self._hand.T))

    def _lack(self, upper: Array, wrist: Array, spine: tuple[Array, Array]) -> Array:
        """The room (n) that forearms lack, metres, whose upper arms are turned so (n, 4)."""
        reacher = self._reacher
        elbow = reacher.arm.lengths[0] * rotate(upper, _X)
        points = elbow[:, None] + _FOREARM * (wrist - elbow)[:, None]
        points = reacher.shoulder(spine) + rotate(multiply(spine[1], reacher.arm.rotation), points)
        return np.maximum(_ROOM - clearance(self._near, points, _ROOM), 0.0).max(axis=-1)

    def _strain(self, links: Array) -> Array:
        """What arms (n, 3, 4) cost (n): their angles over the limits, squared."""
        upper = np.where(links[:, 0, :1] < 0.0, -links[:, 0], links[:, 0])
        shoulder = 2.0 * np.arctan2(upper[:, 1:], upper[:, :1])
        angles = np.concatenate([shoulder, hand_angles(links)], axis=-1)
        low, high = self._limits[:, 0] + _KEEPS, self._limits[:, 1] - _KEEPS
        over = np.maximum(np.maximum(low - angles, angles - high), 0.0)
        over[:, SHOULDER] *= _SHOULDER
        return (over**2).sum(axis=-1)

    def _carried_side(self, place: Array) -> Array:
        """Where the elbow points (3,), carried by the smallest turn to a wrist's place (3,)."""
        if min(float(np.linalg.norm(place)), float(np.linalg.norm(self._place))) < _TINY:
            return self._side
        return rotate(between(self._place, place), self._side)

    def _within_reach(self, palm: Array, spine: tuple[Array, Array], time: float) -> Array:
        """A palm (7,) drawn in to where the arm isn't stiff.

        On the way that begins early and goes on softly: a place which the body only comes to is asked for beyond the
        arm's length, and an arm that is stretched out for it has to turn back all at once. It has ended when fingers
        come round what they take: a hand that is drawn in there is in it.
        """
        reacher = self._reacher
        share = float(minimum_jerk(np.array([1.0 - time / _BEGINS, 1.0 - (1.0 - time) / _ENDS])).max())
        nearly = (_NEARLY + share * (_AT_END - _NEARLY)) * reacher.length
        span = (_FULLY + share * (_STIFF - _FULLY)) * reacher.length - nearly
        nearly = min(nearly, self._most - span)
        off = reacher.hand(palm)[0] - reacher.shoulder(spine)
        distance = float(np.linalg.norm(off))
        if distance <= nearly:
            return palm
        kept = nearly + span * (1.0 - np.exp(-(distance - nearly) / span))
        return np.concatenate([palm[:3] - (1.0 - kept / distance) * off, palm[3:]])

    def _palm(self, links: Array, spine: tuple[Array, Array]) -> Array:
        """The palm (7,) in the world of an arm (3, 4)."""
        reacher = self._reacher
        wrist, turned = wrist_of(reacher.arm, links), multiply(spine[1], reacher.arm.rotation)
        rotation = multiply(turned, wrist.rotation)
        own = reacher.skeleton.grips[reacher.row]
        place = reacher.shoulder(spine) + rotate(turned, wrist.place) + rotate(rotation, own[:3])
        return np.concatenate([place, multiply(rotation, own[3:])])


def speed_towards(now: Array, wanted: Array, speed: Array, fastest: float, gains: float) -> Array:
    """What joints (..., 4) turn in the next frame (..., 3), radians, on their way to others (..., 4).

    Args:
        now: unit quaternions, parent <- child. wanted: the same.
        speed: (..., 3) what they turned in the last frame, in their own frames.
        fastest: the most that a joint turns in a frame. gains: by which that changes from one frame to the next.
    """
    off = to_rotation_vector(multiply(conjugate(now), align(wanted, now)))
    size = np.linalg.norm(off, axis=-1, keepdims=True)
    most = np.minimum(fastest, np.sqrt(2.0 * gains * size))  # so fast it still comes to rest there
    gain = off * np.minimum(1.0, most / np.maximum(size, _TINY)) - speed
    size = np.linalg.norm(gain, axis=-1, keepdims=True)
    return speed + gain * np.minimum(1.0, gains / np.maximum(size, _TINY))
