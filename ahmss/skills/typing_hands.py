"""Two hands over a keyboard: where the palms rest, and where palms and fingers are at each moment of the strokes.

All in the frame of the keys: x to who types, y to their right, z up from the tops of the keys. A hand goes along with
a finger that reaches for a key, by more than half of the way; the finger does the rest. The others stay over theirs.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import conjugate, from_axis_angle, from_matrix, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.grasping.fingertips import Fingertips
from ahmss.grasping.hand import FINGERS
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.steps import Steps
from ahmss.skills.keystrokes import HOMES, Key, Stroke

__all__ = ["HOVER", "TypingHand"]

HOVER = 0.007  # metres of the pads over the keys at rest
OVER = 0.0003  # metres beyond the travel, so that it is pressed all the way
INTO = np.array([0.0, 0.0, -1.0])
PRESSED = 0.004  # metres under them where a key is all the way in
NATURAL = np.radians([26.0, 38.0, 22.8])  # of a finger's joints at rest
YAWS, SLOPES, ROLLS = np.radians([5.0, 14.0, 23.0]), np.radians([-16.0, -6.0, 4.0, 14.0]), np.radians([2.0, 11.0, 20.0])
EASES, AHEAD = (0.65, 0.8, 0.95, 1.1), (0.0, 0.007, 0.014)  # shares of that; metres by which the hand is further on
REACHED = 0.0004  # metres
THUMB_OFF = 0.012  # metres that a thumb at rest may be from its key
ON, SINKS = (0.0, 0.005, 0.01, 0.015, 0.02), (0.0, 0.006, 0.012)  # metres, by which a hand helps its thumb
ALONE = (0.012, 0.008, 0.004, 0.001)  # metres by which a finger reaches beside its home without the hand, if it can
# Seconds from the moment in which a key is all the way in: the finger is over it from and to, it goes down from and to,
# and up from and to; it has left home before, and is there again.
OVER_IT, DOWN, UP, HOME = (-0.05, 0.06), (-0.085, -0.008), (0.016, 0.095), (-0.17, 0.2)
_WAYS = np.array([[x, y] for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0)])
HAND_HOME = 0.45  # seconds between two strokes from which on a hand goes home between them
HAND = (-0.03, 0.03)  # seconds about a stroke in which the hand stays


@dataclass(frozen=True, eq=False)
class TypingHand:
    """One hand.

    tips: its fingers. home (4, 3): the pads of index to little over their keys. thumb (3,): its pad. rest (7,): the
    palm.
    """

    side: str
    tips: Fingertips
    home: Array
    thumb: Array
    rest: Array = field(default_factory=lambda: np.zeros(7))
    _goes: dict[str, Array] = field(default_factory=dict[str, Array], repr=False)

    @classmethod
    def of(cls, skeleton: Skeleton, side: str, keys: Mapping[str, Key]) -> TypingHand:
        """The "right" or "left" hand of a human, over a keyboard that has the home keys."""
        by_character = {key.writes: key for key in keys.values()}
        home = np.array([[*by_character[HOMES[f"{side}_{finger}"]].at, HOVER] for finger in FINGERS])
        space = next((key for key in keys.values() if key.finger == "thumb"), None)
        aside = home[0, 1] - (0.022 if side == "right" else -0.022)
        ahead = home[0, 0] + 0.038 if space is None else float(space.at[0])
        if space is not None:
            half = 0.5 * float(space.size[1]) - 0.008
            aside = float(np.clip(aside, space.at[1] - half, space.at[1] + half))
        return cls(side, Fingertips.of(skeleton, side), home, np.array([ahead, aside, HOVER]))

    def palms(self) -> Steps[Array]:
        """Palms (n, 7) at rest, turned in different ways, from which all fingers come to their keys, and press them."""
        sign = 1.0 if self.side == "right" else -1.0
        flat = from_matrix(np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, sign], [0.0, sign, 0.0]]).T)
        grid = np.meshgrid(sign * YAWS, SLOPES, -sign * ROLLS, EASES, AHEAD, indexing="ij")
        yaw, slope, roll, ease, ahead = (a.ravel() for a in grid)
        x, y, z = np.eye(3)
        turn = multiply(from_axis_angle(z, yaw), multiply(from_axis_angle(y, slope), from_axis_angle(x, roll)))
        turn = multiply(turn, flat)
        bent = ease[:, None, None] * np.tile(NATURAL, (4, 1))
        into = rotate(conjugate(turn), np.broadcast_to(INTO, (len(turn), 3)))
        pads = rotate(turn[:, None], self.tips.pads_bent(bent, into))
        wrist = (self.home - pads).mean(axis=1) - ahead[:, None] * x
        grip = self.tips.hand.grip
        palms = np.concatenate([wrist + rotate(turn, grip[:3]), multiply(turn, grip[3:])], axis=-1)
        off = yield from self._off(palms)
        palms = palms[off <= max(REACHED, float(off.min()))]
        yield
        apart = np.linalg.norm(self._pad_of("thumb", palms, self.thumb) - self.thumb, axis=-1)
        return palms[apart <= max(THUMB_OFF, float(apart.min()) + 0.002)]

    def _pad_of(self, finger: str, palms: Array, place: Array) -> Array:
        """Where a pad is (n, 3), of a finger brought to a place (3,) on palms (n, 7), as far as it goes at ease."""
        grip, tips = self.tips.hand.grip, self.tips
        q_keys_hand = multiply(palms[:, 3:], conjugate(grip[3:]))
        wrist, back = palms[:, :3] - rotate(q_keys_hand, grip[:3]), conjugate(q_keys_hand)
        into, seen = rotate(back, np.broadcast_to(INTO, (len(palms), 3))), rotate(back, place - wrist)
        found = tips.thumb_pad(seen, into) if finger == "thumb" else tips.pad_of(finger, seen, into)
        return wrist + rotate(q_keys_hand, found)

    def _off(self, palms: Array) -> Steps[Array]:
        """How far (n,) pads of fingers stay from where they rest, or press, at the most, of palms (n, 7), metres."""
        off = np.zeros(len(palms))
        for down, (i, finger) in itertools.product((0.0, HOVER + PRESSED), enumerate(FINGERS)):
            yield
            place = self.home[i] + down * INTO
            off = np.maximum(off, np.linalg.norm(self._pad_of(finger, palms, place) - place, axis=-1))
        return off

    def _bent(self, palms: Array, pads: Array) -> Array:
        """Rotations (F, 14, 4) of fingers whose pads are at (F, 5, 3), thumb first, on palms (F, 7)."""
        grip, first = self.tips.hand.grip, fingers(self.side)[0]
        q_keys_hand = multiply(palms[:, 3:], conjugate(grip[3:]))
        wrist, back = palms[:, :3] - rotate(q_keys_hand, grip[:3]), conjugate(q_keys_hand)
        into = rotate(back, np.broadcast_to(INTO, (len(palms), 3)))
        seen = rotate(back[:, None], pads - wrist[:, None])
        rotations = np.zeros((len(palms), 14, 4))
        rotations[:, :2] = self.tips.thumb(seen[:, 0], into)
        for i, finger in enumerate(FINGERS):
            start = INDEX[f"{self.side}_{finger}_proximal"] - first
            rotations[:, start : start + 3] = self.tips.finger(finger, seen[:, i + 1], into)
        return rotations

    def resting(self, palm: Array) -> TypingHand:
        """The same with its palm (7,) at rest there, its thumb as near to its key as it comes from there."""
        return replace(self, rest=palm, _goes={}, thumb=self._pad_of("thumb", palm[None], self.thumb)[0])

    def goes(self, strokes: Sequence[Stroke], palm: Array) -> Array:
        """How far (k, 3) a hand that rests there (7,) goes for its strokes to every side, and not at all."""
        hand = self.resting(palm)
        shifts = np.array([np.zeros(3), *(hand._shift(stroke) for stroke in strokes if stroke.side == self.side)])
        ends = {int((shifts[:, :2] @ way).argmax()) for way in _WAYS}
        return shifts[sorted(ends | {0})]

    def shifts(self, strokes: Sequence[Stroke], time: Array) -> Array:
        """How far (F, 3) the hand is from where it rests at times (F,), seconds."""
        anchors: list[tuple[float, float, Array]] = [(-np.inf, -np.inf, np.zeros(3))]
        own = [stroke for stroke in strokes if stroke.side == self.side]
        for stroke in own:
            if stroke.time - anchors[-1][1] > HAND_HOME:
                begun = stroke.time + HOME[0] - 0.05
                anchors.append((min(anchors[-1][1] + 0.22, begun), begun, np.zeros(3)))
            anchors.append((stroke.time + HAND[0], stroke.time + HAND[1], self._shift(stroke)))
        last = anchors[-1][1] + 0.25
        anchors.append((last, np.inf, np.zeros(3)))
        return _between(anchors, time)

    def shapes(self, strokes: Sequence[Stroke], time: Array, palms: Array, travel: float) -> Array:
        """Rotations (F, 14, 4) of the fingers at times (F,), the palms (F, 7) being where they are."""
        own = [stroke for stroke in strokes if stroke.side == self.side]
        shift = self.shifts(strokes, time)
        pads: list[Array] = []
        for i, finger in enumerate(("thumb", *FINGERS)):
            rest = (self.thumb if i == 0 else self.home[i - 1]) + shift * (1.0, 1.0, i == 0)
            pads.append(self._pads([stroke for stroke in own if stroke.finger == finger], rest, time, travel))
        return self._bent(palms, np.stack(pads, axis=1))

    def _pads(self, strokes: Sequence[Stroke], rest: Array, time: Array, travel: float) -> Array:
        """The pad (F, 3) of one finger that has these strokes, `rest` (F, 3) where it is over its own key."""
        anchors: list[tuple[float, float, Array]] = []
        down = np.zeros(len(time))
        for stroke in strokes:
            place = self.place_on(stroke)
            if (
                not anchors or stroke.time + HOME[0] > anchors[-1][1] + HOME[1]
            ):  # home between, on the way from the last
                begins = anchors[-1][1] + HOME[1] if anchors else -np.inf
                anchors.append((begins, stroke.time + HOME[0], np.array([*place, 0.0])))
            anchors.append((stroke.time + OVER_IT[0], stroke.time + OVER_IT[1], np.array([*place, 1.0])))
            falls = minimum_jerk((time - stroke.time - DOWN[0]) / (DOWN[1] - DOWN[0]))
            rises = minimum_jerk((time - stroke.time - UP[0]) / (UP[1] - UP[0]))
            down = np.maximum(down, falls - rises)
        if not strokes:
            return rest
        anchors.append((strokes[-1].time + HOME[1], np.inf, np.array([*self.place_on(strokes[-1]), 0.0])))
        way = _between(anchors, time)
        target = np.concatenate([way[:, :2], np.full((len(time), 1), HOVER)], axis=-1)
        pads = rest + way[:, 2:] * (target - rest)
        pads[:, 2] -= down * (HOVER + travel + OVER)
        return pads

    def place_on(self, stroke: Stroke) -> Array:
        """Where (2,) a key is pressed: in its middle, a wide one where the finger is nearest to it."""
        key = stroke.key
        rest = self.thumb if stroke.finger == "thumb" else self.home[FINGERS.index(stroke.finger)]
        half = np.maximum(0.5 * key.size - 0.5 * float(key.size.min()), 0.0)
        return np.clip(rest[:2], key.at - half, key.at + half)

    def _shift(self, stroke: Stroke) -> Array:
        """How far (3,) the hand goes along with a stroke: so far that its finger gets there."""
        if stroke.key.name not in self._goes:
            self._goes[stroke.key.name] = self._along(stroke)
        return self._goes[stroke.key.name]

    def _along(self, stroke: Stroke) -> Array:
        rest = self.thumb if stroke.finger == "thumb" else self.home[FINGERS.index(stroke.finger)]
        off = self.place_on(stroke) - rest[:2]
        far = max(float(np.linalg.norm(off)), 1e-9)
        shares = np.maximum(1.0 - np.array(ALONE) * np.tanh(far / (2.0 * np.array(ALONE))) / far, 0.0)
        shifts = np.array([[*(share * off), 0.0] for share in shares])
        if stroke.finger == "thumb":
            shifts = np.array([[-on, 0.0, -down] for on in ON for down in SINKS])
        palms = np.repeat(self.rest[None], len(shifts), axis=0)
        palms[:, :3] += shifts
        place = np.array([*self.place_on(stroke), -PRESSED])
        apart = np.linalg.norm(self._pad_of(stroke.finger, palms, place) - place, axis=-1)
        there = np.flatnonzero(apart <= REACHED)
        return shifts[there[0] if len(there) else int(apart.argmin())]


def _between(anchors: Sequence[tuple[float, float, Array]], time: Array) -> Array:
    """What is held (3,) from one time to another, by anchors in their order, and in between goes over (F, 3)."""
    made = np.repeat(anchors[0][2][None], len(time), axis=0)
    for (_, leaves, before), (comes, _, after) in itertools.pairwise(anchors):
        begins = comes - 0.2 if leaves == -np.inf else leaves
        share = minimum_jerk((time - begins) / max(comes - begins, 1e-6))[:, None]
        made = np.where(share > 0.0, before + share * (after - before), made)
    return made
