"""A hand that is carried goes aside for things, softly, and no faster than its arm's joints turn.

The palm that an arm has come to is moved out of what its hand would be in there, and the arm with it. An arm that is
nearly straight bends far for little of that: of what the hand would go aside in a frame, it goes as much as it can
without a joint turning too fast, what that turns besides included.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ahmss.body.arm import Wrist, hand_angles, with_hand, wrist_of
from ahmss.body.arm_choice import present_side
from ahmss.body.arm_swing import HAND, limits_of, swing_of
from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, rotate, to_rotation_vector
from ahmss.reaching.aside import AIR, nearest
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.reacher import Reacher

__all__ = ["Evading"]

_STARTS = 0.005  # metres a frame by which a hand that goes aside gains speed from one frame to the next
_SOFTLY, _SOFTER = 0.015, 0.3  # metres over which a hand is kept out of things; of its way to its place
_LOOKS = 2.0  # frames ahead that a hand is seen to, if it goes on as it does
_FASTEST, _HASTENS = np.radians([6.2, 6.7])  # that a joint turns in a frame, beyond which a hand goes no further aside
_FAR = 0.02  # metres that it still has to go, from where on it hastens
_STEPS = np.linspace(1.0, 0.0, 6)
_SHARES = np.array([(out, back) for out in _STEPS for back in _STEPS])  # of what it would go in a frame: those tried
_TINY = 1e-6


class Evading:
    """How far one hand is aside, from frame to frame.

    aside: (3,) metres by which it is, in the world.
    """

    def __init__(self, reacher: Reacher, links: Array) -> None:
        """Begin with an arm (3, 4), against the shoulder frame."""
        self._reacher, self._links = reacher, links
        self.aside, self._speed = np.zeros(3), np.zeros(3)
        self._palm: Array | None = None

    def step(
        self, near: Sequence[Prism], hand: tuple[Array, Array] | None, links: Array, palms: tuple[Array, Array],
        spine: tuple[Array, Array],
    ) -> tuple[Array, Array]:  # fmt: skip
        """The arm (3, 4) and the palm (7,) of the next frame.

        Args:
            near: the things.
            hand: points (n, 3) and radii (n,) of the hand as its palm sees them; None where there are no things.
            links: (3, 4) the arm, if it did not go aside.
            palms: where that one's palm is (7,), and where it comes to in the end (7,).
            spine: place (3,) and rotation (4,) of the spine link.
        """
        palm, end = palms
        goes = np.zeros(3) if self._palm is None else palm[:3] - self._palm
        self._palm = palm[:3].copy()
        wanted = np.zeros(3)
        if hand is not None:
            soon = np.concatenate([palm[:3] + _LOOKS * goes, palm[3:]])
            wanted = max((_out_of(near, hand, one, end) for one in (palm, soon)), key=lambda out: float(out @ out))
        if max(float(np.abs(one).max()) for one in (wanted, self.aside, self._speed)) < _TINY:
            self._links = links
            return links, palm
        off = wanted - self.aside
        size = max(float(np.linalg.norm(off)), _TINY)
        most = np.sqrt(2.0 * _STARTS * size + 0.25 * _STARTS**2) - 0.5 * _STARTS  # so fast it still comes to rest there
        gain = min(1.0, most / size) * off - self._speed
        speed = self._speed + gain * min(1.0, _STARTS / max(float(np.linalg.norm(gain)), _TINY))
        # Out of things it goes before it comes back from where it was out of others.
        way = wanted / max(float(np.linalg.norm(wanted)), _TINY)
        out = max(float(speed @ way), 0.0) * way
        fastest = _HASTENS if size > _FAR else _FASTEST
        for shares in (_SHARES[:1], _SHARES[1:]):  # most often it may go as far as it would
            speeds = shares[:, :1] * out + shares[:, 1:] * (speed - out)
            arms, turned = self._arms(links, self.aside + speeds, spine)
            slow = np.flatnonzero(turned <= fastest)
            if len(slow):
                break
        best = int(slow[0]) if len(slow) else int(turned.argmin())
        self._speed, self._links = speeds[best], arms[best]
        self.aside = self.aside + self._speed
        return self._links, np.concatenate([palm[:3] + self.aside, palm[3:]])

    def _arms(self, links: Array, moved: Array, spine: tuple[Array, Array]) -> tuple[Array, Array]:
        """The arms (n, 3, 4) of one (3, 4) whose hand is moved by (n, 3) in the world, its elbow going along.

        And what a joint of each turns at the most (n,), radians, from the last frame's.
        """
        arm, n = self._reacher.arm, len(moved) + 1
        moved = np.concatenate([np.zeros((1, 3)), moved])
        wrist = wrist_of(arm, links)
        place = wrist.place + rotate(conjugate(multiply(spine[1], arm.rotation)), moved)
        before = np.broadcast_to(links, (n, 3, 4))
        side = present_side(arm, before, place)
        made = swing_of(arm, Wrist(place, np.broadcast_to(wrist.rotation, (n, 4))), side).links(np.zeros(n))
        held, (low, high) = hand_angles(links), limits_of(arm)[HAND].T
        made = with_hand(made, np.clip(hand_angles(made), np.minimum(low, held), np.maximum(high, held)))
        arms = multiply(links, multiply(conjugate(made[0]), made[1:]))  # its own bends and turns stay as they are
        turned = to_rotation_vector(multiply(conjugate(self._links), arms))
        return arms, np.linalg.norm(turned, axis=-1).max(axis=-1)


def _out_of(near: Sequence[Prism], hand: tuple[Array, Array], palm: Array, end: Array) -> Array:
    """By how much a palm (7,) goes aside for things (3,) that its hand would be in there.

    It comes as near to them as it is to be in the end (7,), softly as long as it is far from that.
    """
    inner, radii = hand
    soft = min(_SOFTLY, _SOFTER * float(np.linalg.norm(palm[:3] - end[:3])))
    here, there = (one[:3] + rotate(one[3:], inner) for one in (palm, end))
    far = AIR + 4.0 * soft
    gap = clearance(near, here, far + float(radii.max())) - radii
    worst = int(gap.argmin())
    if gap[worst] > far:
        return np.zeros(3)
    least = min(float((clearance(near, there, AIR + float(radii.max())) - radii).min()), AIR)
    lack = least - float(gap[worst])
    out = nearest(near, here[worst]).way_out(here[worst])
    return out * (soft * float(np.logaddexp(0.0, lack / soft)) if soft > _TINY else max(lack, 0.0))
