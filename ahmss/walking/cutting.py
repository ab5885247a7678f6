"""What of a recorded walk is which clip: cut at landings and standing, binned by how it went, laid along its way (A.2).

Directions and facings are measured: a way is where the hips go over a whole stride, in which their sway cancels.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import LINKS
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, rotate, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.motion.planting import feet
from ahmss.motion.smoothness import worst_pop
from ahmss.walking.catalogue import STRAIGHT, Key, Side
from ahmss.walking.fitting import Pose
from ahmss.walking.library import RATE, WalkClip
from ahmss.walking.likeness import closing
from ahmss.walking.mirroring import mirror
from ahmss.walking.phases import Walk, level_speed
from ahmss.walking.recording import Recording
from ahmss.walking.selection import bins

__all__ = ["Cut", "Unused", "cuts"]

_UP = np.array([0.0, 0.0, 1.0])
_AHEAD = np.array([0.0, 0.0, -1.0])  # of the hips' frame
_BENDING = 8.0  # degrees between the ways of one stride and the next: no straight walking
_ASIDE = 20.0  # degrees between where the hips face, as a mean, and the way: no walking ahead
_WAVERING = 3.0  # degrees, the same of people who go straight on
_TURN = 20.0  # degrees of a turn in walking that are worth a word
_BESIDE = 0.25  # of the hips' height: how far apart, ahead, feet may be that stand side by side
_LEAD, _SETTLE = (
    1.0,
    1.2,
)  # seconds before the first foot lifts and after the last lands in which standing is looked for
_SHORTEST = 0.08  # metres: less is turning on the spot
_VAGUE = 2  # frames
_POP = 12.0  # degrees: more is a fault of the capture
_SIDES: tuple[Side, Side] = ("right", "left")


@dataclass(frozen=True, eq=False)
class Cut:
    """A part of a recording in its clip's frame, not yet fitted.

    first, last: its frames in the recording. direction, facing: degrees, as measured in the recording.
    """

    clip: WalkClip
    file: str
    first: int
    last: int
    mirrored: bool = False
    direction: float = 0.0
    facing: float = 0.0


@dataclass(frozen=True)
class Unused:
    """Something found in a recording that serves as no clip; frames first to last."""

    file: str
    first: int
    last: int
    what: str


def cuts(recording: Recording, skeleton: Skeleton, standing: Pose) -> Iterator[Cut | Unused]:
    """All that a recording has: what may be a clip, every stride taken for a normal one, and what may not."""
    if not recording.walks:
        yield Unused(recording.file, 0, len(recording.root) - 1, "no steps")
    for walk in recording.walks:
        for found in _Cutter(recording, walk, skeleton, standing).all():
            if isinstance(found, Cut) and (pop := worst_pop(found.clip.rotations)).degrees > _POP:
                what = f"{found.clip.key.name}: {LINKS[pop.joint]} jumps by {pop.degrees:.0f} degrees in one frame"
                yield Unused(found.file, found.first, found.last, what)
            else:
                yield found


class _Cutter:
    """One walk in a recording."""

    def __init__(self, recording: Recording, walk: Walk, skeleton: Skeleton, standing: Pose) -> None:
        self._recording, self._walk, self._stand = recording, walk, standing
        self._ankles = feet(skeleton, recording.rotations, recording.root)[..., :2]
        ahead = rotate(recording.rotations[:, 0], _AHEAD)
        self._headings = np.degrees(np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0])))
        ankles = feet(skeleton, standing.rotations, standing.root)[:, :2].mean(axis=0)
        self._ahead = ankles - standing.root[:2]
        self._beside = _BESIDE * float(standing.root[2])
        self._land = [landing.land for landing in walk.landings]
        self._foot = [landing.foot for landing in walk.landings]
        self._first = walk.before.first if walk.before else 0
        self._last = walk.after.end - 1 if walk.after else len(recording.root) - 1

    def all(self) -> Iterator[Cut | Unused]:
        """What the walk has."""
        count = len(self._land)
        if any(a == b for a, b in pairwise(self._foot)):
            yield self._unused("one foot goes twice")
            return
        if self._walk.before and self._walk.after and count <= 3:
            yield self._short(count)
            return
        if self._walk.before:
            yield from self._start(count)
        yield from self._straights(count)
        if self._walk.after:
            yield from self._ends(count)
        yield from self._turns(count)

    # The kinds

    def _short(self, count: int) -> Cut | Unused:
        if count == 1:
            return self._unused("one foot steps, the other stays")
        first, last = self._stands_before(), self._stands_after()
        way = self._stood_at(last) - self._stood_at(first)
        if np.linalg.norm(way) < _SHORTEST:
            return self._unused(f"a turn on the spot by {self._headings[last] - self._headings[first]:.0f} degrees")
        if self._apart(last):
            return self._unused(f"{count - 1} steps that end with one foot ahead")
        angle = _angle(way)
        direction = _wrapped(angle - self._headings[first])
        facing = _wrapped(self._headings[last] - angle)
        d, f, mirrored = bins(direction, facing)
        key = Key("one_step" if count == 2 else "two_step", d, f)
        return self._cut(key, first, last, angle, mirrored, direction, facing)

    def _start(self, count: int) -> Iterator[Cut | Unused]:
        if count < 3:
            yield self._unused("a start that the recording breaks off")
            return
        first = self._stands_before()
        over = self._turned_in(count)
        angle = self._way(over) if count > 3 else self._way(0)
        direction = _wrapped(angle - self._headings[first])
        d, _, mirrored = bins(direction, 0.0)
        lead = self._foot[0]
        if d in (0, 180):
            mirrored = lead == 0
        if lead == (1 if mirrored else 0):
            what = f"a start to {direction:.0f} degrees led by the {_SIDES[lead]} foot, that of the other side"
            yield Unused(self._recording.file, first, self._land[over], what)
        elif self._apart(first):
            yield Unused(self._recording.file, first, self._land[over], "a start with one foot ahead")
        else:
            for last in self._landed(over):
                yield self._cut(Key("start", d), first, last, angle, mirrored, direction)

    def _turned_in(self, count: int) -> int:
        """The landing at which a start is over: the second; the fourth, where one turns on the spot before."""
        for i in (1, 3):
            if count > i + 2 and abs(_wrapped(self._headings[self._land[i]] - self._way(i))) < _ASIDE:
                return i
        return 1

    def _straights(self, count: int) -> Iterator[Cut]:
        lowest = 2 if self._walk.before else 1
        for i in range(lowest, count - (3 if self._walk.after else 2)):
            before, after = self._way(i - 1), self._way(i)
            way = before + 0.5 * _wrapped(after - before)
            facing = float(self._headings[self._land[i - 1] : self._land[i + 1]].mean())
            if abs(_wrapped(after - before)) < _BENDING and abs(_wrapped(facing - way)) < _ASIDE:
                variants = product(self._landed(i), self._landed(i + 1))
                tried = [self._cut(STRAIGHT, a, b, way, self._foot[i] == 1) for a, b in variants]
                yield min(tried, key=lambda cut: closing(cut.clip))

    def _ends(self, count: int) -> Iterator[Cut | Unused]:
        if count < 3:
            yield self._unused("an end that begins before the recording")
            return
        landing, last = self._land[-3], self._stands_after()
        if self._apart(last):
            yield Unused(self._recording.file, landing, last, "an end with one foot ahead")
            return
        if count > 3:
            angle = self._way(count - 5) if count > 4 else self._way(0)
        else:
            angle = _angle(self._stood_at(last) - self._recording.root[landing, :2])
        facing = _wrapped(self._headings[last] - angle)
        _, f, mirrored = bins(0.0, facing)
        both = (False, True) if f in (0, 180) else (mirrored,)  # its own mirror image serves as well
        for seen, first in product(both, self._landed(count - 3)):
            side = _SIDES[1 - self._foot[-1] if seen else self._foot[-1]]
            yield self._cut(Key("end", 0, f, last=side), first, last, angle, seen, 0.0, facing)

    def _turns(self, count: int) -> Iterator[Unused]:
        """Where the way bends in walking, stretch by stretch."""
        ways = [self._way(i) for i in range(count - 2)]
        bends = [_wrapped(b - a) for a, b in pairwise(ways)]
        begin = 0
        while begin < len(bends):
            end = begin
            while end < len(bends) and abs(bends[end]) >= _WAVERING and bends[end] * bends[begin] > 0.0:
                end += 1
            turn = sum(bends[begin:end])
            if abs(turn) >= _TURN:
                side = "left" if turn > 0.0 else "right"
                what = f"a turn in walking, {abs(turn):.0f} degrees to the {side}"
                yield Unused(self._recording.file, self._land[begin], self._land[end + 2], what)
            begin = max(end, begin + 1)

    # What is measured

    def _way(self, landing: int) -> float:
        """Where the hips go, degrees, in the stride that begins with a landing."""
        root = self._recording.root
        return _angle(root[self._land[landing + 2], :2] - root[self._land[landing], :2])

    def _stood_at(self, frame: int) -> Array:
        """Where the hips are (2,) when they are at rest over the feet: in a small step they sway as far as they go."""
        heading = np.radians(self._headings[frame])
        cos, sin = np.cos(heading), np.sin(heading)
        return self._ankles[frame].mean(axis=0) - np.array([[cos, -sin], [sin, cos]]) @ self._ahead

    def _landed(self, landing: int) -> range:
        """The frames that pass for the moment of a landing, which contact tells to within a few: each is a cut."""
        return range(self._land[landing], self._land[landing] + _VAGUE + 1)

    def _apart(self, frame: int) -> bool:
        """Whether one foot is ahead of the other."""
        heading = np.radians(self._headings[frame])
        across = self._ankles[frame, 0] - self._ankles[frame, 1]
        return bool(abs(across @ np.array([np.cos(heading), np.sin(heading)])) > self._beside)

    def _stands_before(self) -> int:
        stand, lift = self._walk.before, self._walk.landings[0].lift
        assert stand is not None
        return self._most_like_standing(max(stand.first, lift - round(_LEAD * RATE)), min(stand.end, lift))

    def _stands_after(self) -> int:
        stand, land = self._walk.after, self._land[-1]
        assert stand is not None
        return self._most_like_standing(stand.first, min(stand.end, land + round(_SETTLE * RATE)))

    def _most_like_standing(self, first: int, end: int) -> int:
        """The frame, from first to before end, in which one stands best: like the pose, still, over both feet."""
        k = slice(first, max(end, first + 1))
        turned = to_rotation_vector(multiply(conjugate(self._stand.rotations[1:]), self._recording.rotations[k, 1:]))
        unlike = np.linalg.norm(turned, axis=-1).mean(axis=-1)
        off = np.linalg.norm(self._recording.root[k, :2] - self._ankles[k].mean(axis=1), axis=-1)
        speed = level_speed(self._recording.root, RATE)[k]
        return first + int(np.argmin(unlike + off / 0.1 + speed / 0.2))

    # Cutting out

    def _unused(self, what: str) -> Unused:
        return Unused(self._recording.file, self._first, self._last, what)

    def _cut(
        self, key: Key, first: int, last: int, way: float, mirrored: bool, direction: float = 0.0, facing: float = 0.0
    ) -> Cut:
        """The frames laid along the key's direction: what went along `way`, degrees, in the recording."""
        k = slice(first, last + 1)
        rotations, root = self._recording.rotations[k], self._recording.root[k]
        bearing = self._recording.bearing[k]
        if mirrored:
            (rotations, root), bearing, way = mirror(rotations, root), bearing[:, ::-1], -way
        turn = from_axis_angle(_UP, np.radians(key.direction - way))
        rotations, root = rotations.copy(), rotate(turn, root)
        rotations[:, 0] = multiply(turn, rotations[:, 0])
        origin = root[0] * np.array([1.0, 1.0, 0.0])
        if key.kind == "straight":
            origin[1] = 0.5 * (root[0, 1] + root[-1, 1])
        clip = WalkClip(key, rotations, root - origin, bearing, self._source(first, last, mirrored))
        return Cut(clip, self._recording.file, first, last, mirrored, direction, facing)

    def _source(self, first: int, last: int, mirrored: bool) -> str:
        seen = ", mirrored" if mirrored else ""
        return f"{self._recording.file}, {first / RATE:.2f} to {last / RATE:.2f} s{seen}"


def _angle(way: Array) -> float:
    return float(np.degrees(np.arctan2(way[1], way[0])))


def _wrapped(angle: float) -> float:
    """The angle in degrees, greater than -180 and up to 180."""
    return float(180.0 - (180.0 - angle) % 360.0)
