"""A foot of a walk brought to where it shall stand, as far on as it is asked for (Ichiguchi 2000, A.3.2, the legs).

A foot that has landed is fixed; the thesis lets the error at lift-off stand, here it is spread over the swing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.contact import runs
from ahmss.motion.easing import minimum_jerk
from ahmss.walking.evening import evened
from ahmss.walking.footprints import Ends, Footprints
from ahmss.walking.leeway import Leeway
from ahmss.walking.legs import foot_frames
from ahmss.walking.line import Line
from ahmss.walking.nominal import Nominal
from ahmss.walking.passing import around
from ahmss.walking.soles import FLAT, clearance, middle, pushed_off, rolled, sole_angles, turned
from ahmss.walking.uncurling import uncurled

__all__ = ["Ends", "Footprints", "Seen", "Tread"]

_UP = np.array([0.0, 0.0, 1.0])
_PIVOTING = np.radians(12.0)  # a foot that turns by more while it bears pivots; by less, it errs
_LEAST = 0.35  # of a step's heel rise and strike that even the shortest keeps
_LIFTED = 0.03  # metres: a short step, which rolls little over heel and toe, is lifted instead
_LEVEL = np.radians(0.5)
_BESIDE, _MOVES = 0.09, 14  # metres between the middle lines of two feet; centimetres that one is moved for it
_LATER, _MOST_LATER = 0.35, np.radians(50.0)  # of the turn of a start, what its second footstep makes
_TURNS_OUT = 0.5  # of the swing that follows, in which the foot is turned as its way is


class Seen:
    """Both feet in the joined clips, looked at as far on as is asked for.

    ankles (F, 2, 3); yaw, pitch (F, 2), radians, yaw without jumps. Frames from `count` on are not there yet.
    """

    def __init__(self, skeleton: Skeleton, nominal: Nominal) -> None:
        self._skeleton, self._nominal = skeleton, nominal
        frames = len(nominal.root)
        self.count = 0
        self.ankles = np.empty((frames, 2, 3))
        self.yaw, self.pitch = np.empty((frames, 2)), np.empty((frames, 2))

    def until(self, end: int) -> None:
        """Have the frames before `end`."""
        if end <= self.count:
            return
        part = slice(self.count, end)
        self.ankles[part], world = foot_frames(self._skeleton, self._nominal.rotations[part], self._nominal.root[part])
        yaw, self.pitch[part] = sole_angles(world)
        if self.count:
            before = self.yaw[self.count - 1]
            yaw = np.unwrap(np.concatenate([before[None], yaw]), axis=0)[1:]
        self.yaw[part] = yaw
        self.count = end


class Tread:
    """One foot: where it stands, and how it gets from one footprint to the next.

    ankles (F, 3), feet (F, 4): in the world. Frames from `count` on are not there yet, of the footprints those from
    `known` on.
    """

    def __init__(
        self, skeleton: Skeleton, nominal: Nominal, seen: Seen, line: Line, ends: Ends, foot: int, turn: Array,
        leeway: Leeway | None = None,
    ) -> None:  # fmt: skip
        self._soles = skeleton.soles * (1.0, 1.0 if foot == 0 else -1.0, 1.0)
        self._seen, self._line, self._ends, self._foot, self._turn = seen, line, ends, foot, turn
        self._along = nominal.root[:, 0]
        self._started = nominal.seams[1] if line.first > 0.0 and len(nominal.seams) > 2 else 0
        frames = len(nominal.root)
        bears: NDArray[np.bool_] = nominal.bearing[:, foot].any(axis=-1)  # pyright: ignore[reportAssignmentType]
        self._aside = None if leeway is None else leeway.foot(bears, foot)
        spans = runs(bears)
        first, end = (np.array([span[i] for span in spans], np.intp) for i in (0, 1))
        n = len(spans)
        self._stances = _Stances(first, end, np.zeros((n, 2)), np.zeros(n), np.zeros((n, 2)), np.zeros(n), np.zeros(n))
        self._yaw = np.empty(frames)  # as in the clips, but constant while the foot bears and does not pivot
        self._fixed = 0  # frames whose yaw is there
        self.other = self  # the other foot, whose leg this one goes round
        self.known = self.count = 0
        self.ankles, self.feet = np.empty((frames, 3)), np.empty((frames, 4))

    @property
    def footprints(self) -> Footprints:
        """Where the foot stands, as far as it is known."""
        known, stances = slice(self.known), self._stances
        return Footprints(stances.first[known], stances.to[known], stances.to_heading[known])

    def know(self, count: int) -> None:
        """Have the first `count` footprints."""
        stances = self._stances
        for i in range(self.known, min(count, len(stances.first))):
            end = int(stances.end[i])
            self._seen.until(end)
            self._take_yaw(end)
            new = slice(i, i + 1)
            ankle, pitch = self._seen.ankles[:, self._foot], self._seen.pitch[:, self._foot]
            _stand(stances, new, ankle, self._yaw, pitch, self._soles)
            self._place(new)
            self.known = i + 1

    def until(self, end: int) -> None:
        """Have the frames before `end`: whole strides, from landing to landing."""
        stances, frames = self._stances, len(self.ankles)
        if end <= self.count:
            return
        begun = int(np.searchsorted(stances.first, self.count, side="right")) - 1
        over = int(np.searchsorted(stances.first, end, side="left"))
        self.know(over + 2)
        stop = int(stances.first[over]) if over < len(stances.first) else frames
        landed = min(stop + 1, frames)  # the landing is looked at, and made again with what follows
        self._seen.until(landed)
        self._take_yaw(landed)
        made = slice(self.count, stop)
        ankles, feet = self._carried(np.arange(int(stances.first[begun]), landed))
        self.ankles[made], self.feet[made] = ankles[: stop - self.count], feet[: stop - self.count]
        self.count = stop

    def _take_yaw(self, end: int) -> None:
        if end > self._fixed:
            part = slice(self._fixed, end)
            self._yaw[part] = self._seen.yaw[part, self._foot]
            self._fixed = end

    def _place(self, new: slice) -> None:
        """Where the foot shall stand: as it stands about the hips when they pass, and these are along the line.

        So the way shrinks and the stance does not. First and last it is where it is and shall be.
        """
        stances, foot = self._stances, self._foot
        passing = self._along[(stances.first[new] + stances.end[new] - 1) // 2]
        s, _ = self._line.along(passing)
        place, heading = self._line.course.at(s)
        ahead = np.stack([np.cos(heading), np.sin(heading)], axis=-1)
        across = np.stack([-np.sin(heading), np.cos(heading)], axis=-1)
        off = stances.place[new] - np.stack([passing, np.zeros(len(passing))], axis=-1)
        stances.to[new] = place + off[:, :1] * ahead + off[:, 1:] * across
        if self._aside is not None:
            stances.to[new] += self._aside[stances.first[new]]
        self._turn_in(new)
        stances.to_heading[new] = stances.heading[new] + stances.more[new] + heading + self._turn[stances.first[new]]
        ends = self._ends
        for i, where, wanted in (
            (0, ends.first, ends.first_heading),
            (len(stances.first) - 1, ends.last, ends.last_heading),
        ):
            if new.start <= i < new.stop:
                stances.to[i] = where[foot]
                off = wanted[foot] - stances.to_heading[i]
                stances.to_heading[i] += (off + np.pi) % (2.0 * np.pi) - np.pi
        if 0 < new.start < len(stances.first) - 1:
            self._clear(new.start)

    def _turn_in(self, new: slice) -> None:
        """The first footstep of a start shares its turn with the next.

        In the clip it makes all of it, for it is the straight step's foot that bears where the two meet.
        """
        stances = self._stances
        if self._starts(new):
            later = _LATER * (stances.heading[1] - stances.heading[0])
            stances.more[1] = -np.clip(later, -_MOST_LATER, _MOST_LATER)

    def _starts(self, new: slice) -> bool:
        """Whether the first footstep of a start is among the new ones."""
        first, end = self._stances.first, self._stances.end
        return new.start <= 1 < new.stop and bool(first[1] < self._started <= end[1])

    def _clear(self, i: int) -> None:
        """Move a footprint away from where the other foot stands, and will at last, until it is clear of it."""
        stances, other = self._stances, self.other
        near = [other.stands(int(stances.first[i]))]
        if other.lands_last < int(stances.end[i]):
            foot = 1 - self._foot
            near.append((self._ends.last[foot], float(self._ends.last_heading[foot])))
        for place, faces in near:
            stood = middle(self._soles, place, faces)
            for _ in range(_MOVES):
                sole = middle(self._soles, stances.to[i], float(stances.to_heading[i]))
                if stood.distance(sole) >= _BESIDE:
                    break
                away = np.subtract(sole.centroid.coords[0], stood.centroid.coords[0])
                stances.to[i] += 0.01 * away / max(float(np.linalg.norm(away)), 1e-9)

    @property
    def lands_last(self) -> int:
        """The first frame of its last footprint."""
        return int(self._stances.first[-1])

    def stands(self, frame: int) -> tuple[Array, float]:
        """Where the foot stands, or stood before, at a frame: the flat foot's ankle (2,) and heading."""
        self.know(int(np.searchsorted(self._stances.first, frame, side="right")))
        return self.footprints.at(frame)

    def _sizes(self) -> Array:
        """How much each swing is of that in the clip, between footprints known (known + 1,), 1 outside of them."""
        known, stances = slice(self.known), self._stances
        moved = np.linalg.norm(np.diff(stances.to[known], axis=0), axis=-1)
        nominally = np.linalg.norm(np.diff(stances.place[known], axis=0), axis=-1)
        return np.concatenate([[1.0], np.clip(moved / np.maximum(nominally, 1e-6), _LEAST, 1.0), [1.0]])

    def _carried(self, frames: NDArray[np.intp]) -> tuple[Array, Array]:
        """The foot as it bears where it shall, and between by both its footsteps, the one passing into the other.

        Args:
            frames: in a row, from a landing on; whole strides, and the frame at which the last of them lands.
        """
        stances, sizes, soles, origin = self._stances, self._sizes(), self._soles, int(frames[0])
        ankle, pitch = self._seen.ankles[frames, self._foot], self._seen.pitch[frames, self._foot]
        loose, yaw = self._seen.yaw[frames, self._foot], self._yaw[frames]
        before = np.searchsorted(stances.first, frames, side="right") - 1
        strides = np.split(pitch, np.flatnonzero(np.diff(before)) + 1)  # from landing to landing
        pitch = np.concatenate([pushed_off(stride) for stride in strides])
        bears = frames < stances.end[before]
        after = np.minimum(before + (~bears), len(stances.first) - 1)
        lift, land = stances.end[before] - 1 - origin, stances.first[after] - origin
        u = np.where(bears, 0.0, (frames - origin - lift) / np.maximum(land - lift, 1))
        lift, land = np.where(bears, 0, lift), np.where(bears, 0, land)  # only those of swings are used
        share = minimum_jerk(u)
        own = np.where(bears, np.where(pitch > 0.0, sizes[before], sizes[before + 1]), sizes[before + 1])
        tilted = np.arcsin(own * np.sin(pitch))
        turn = stances.to_heading - stances.heading
        carried = turn - stances.more
        fixed = yaw - loose
        yaw = np.where(bears, yaw, loose + (1.0 - share) * fixed[lift] + share * fixed[land])
        early = np.where(stances.more[before] != 0.0, minimum_jerk(np.minimum(u / _TURNS_OUT, 1.0)), share)
        heading = yaw + (1.0 - early) * turn[before] + early * turn[after]
        swings = ~bears
        for b in np.unique(before[swings]).tolist():
            swing = swings & (before == b)
            first, last = int(lift[swing][0]), int(land[swing][0])
            heading[first : last + 1] = evened(heading[first : last + 1])
        feet = turned(heading, tilted)

        height = -soles[0, 2]
        level = height * np.cos(tilted) + own * (ankle[:, 2] - height * np.cos(pitch))
        level += (1.0 - own) * _LIFTED * 64.0 * (u * (1.0 - u)) ** 3
        nominal = ankle.copy()
        exact = rolled(stances.place[before], stances.heading[before], yaw, pitch, soles)
        nominal[bears, :2] = exact[bears, :2]
        for at, weight in ((lift, 1.0 - share), (land, share)):
            nominal[swings, :2] += (weight[:, None] * (exact[at] - ankle[at])[:, :2])[swings]
        small = sizes[np.where(bears, before, before + 1)]
        low, high = (_moved(nominal, stances, carried, which, small) for which in (before, after))
        out = np.empty_like(ankle)
        out[:, :2] = (1.0 - share)[:, None] * low + share[:, None] * high
        out[:, 2] = level
        standing = rolled(stances.to[before], stances.to_heading[before], heading, tilted, soles)
        # A foot that rolls less than in the clip leaves and lands a little elsewhere: spread over the swing, too.
        spread = np.zeros_like(ankle)
        for at, which, weight in ((lift, before, 1.0 - share), (land, after, share)):
            there = np.c_[_moved(nominal[at], stances, carried, which, small), level[at]]
            spread += weight[:, None] * (standing[at] - there)
            if self._aside is not None:
                spread[:, :2] -= weight[:, None] * self._aside[frames[at]]
        out += spread
        out[bears] = standing[bears]
        if self._aside is not None:
            out[bears, :2] -= self._aside[frames[bears]]
        for b in np.unique(before[swings]).tolist():
            swing = swings & (before == b)
            first, last = int(lift[swing][0]), int(land[swing][0])
            out[first : last + 1, :2] = uncurled(out[first : last + 1, :2])
            stands = self.other.stands(origin + first)
            way, sign = stances.to[b + 1] - stances.to[b], 1.0 if self._foot else -1.0
            out[swing, :2] += around(out[swing, :2], u[swing], heading[swing], stands, way, sign)
        if self._aside is not None:
            out[:, :2] += self._aside[frames]
        out[bears] = standing[bears]
        sunk = -(out[:, None] + rotate(feet[:, None], soles))[..., 2].min(axis=-1)
        out[:, 2] += np.maximum(sunk, 0.0) + np.where(bears, 0.0, clearance(u, 1.0 / np.maximum(land - lift, 1)))
        return out, feet


@dataclass
class _Stances:
    """A foot's times on the ground: first frames, those after the last; where the flat foot is, nominal and wanted.

    more: of the heading wanted, by how much the foot is turned otherwise than on its way there, radians.
    """

    first: NDArray[np.intp]
    end: NDArray[np.intp]
    place: Array
    heading: Array
    to: Array
    to_heading: Array
    more: Array


def _stand(stances: _Stances, new: slice, ankle: Array, yaw: Array, pitch: Array, soles: Array) -> None:
    """Fill in where a foot stands in the clips; the headings of feet that do not pivot become constant, in place."""
    seen = np.empty(new.stop - new.start, np.intp)
    for i in range(new.start, new.stop):
        a, b = int(stances.first[i]), int(stances.end[i])
        flat = np.flatnonzero(np.abs(pitch[a:b]) <= _LEVEL)
        # Fitted clips slide a little towards their ends: where a foot stands is told by how it first lies flat.
        at = b - 1 if i == len(stances.first) - 1 else a + (int(flat[0]) if len(flat) else (b - a) // 2)
        if not _pivots(yaw[a:b], pitch[a:b]):
            yaw[a:b] = yaw[at]
        seen[i - new.start] = at
    q = turned(yaw[seen], pitch[seen])
    point = np.where((pitch[seen] > FLAT)[:, None], soles[0], soles[2])
    contact = ankle[seen] + rotate(q, point)
    flat_at = contact - rotate(from_axis_angle(_UP, yaw[seen]), point)
    stances.place[new], stances.heading[new] = flat_at[:, :2], yaw[seen]


def _pivots(yaw: Array, pitch: Array) -> bool:
    """Whether a foot that bears turns on its toe, rather than sliding while it lies flat."""
    by = np.abs(np.diff(yaw))
    raised = pitch[1:] < -_LEVEL
    return float(by[raised].sum()) > _PIVOTING and float(by[~raised].sum()) < _PIVOTING


def _moved(nominal: Array, stances: _Stances, turn: Array, which: NDArray[np.intp], size: Array) -> Array:
    """Places (F, 2) as the footstep `which` (F,) brings them from where it is in the clip to where it shall be.

    size: (F,) of how far off it they are in the clip. A swing that turns and goes nowhere would curl otherwise.
    """
    cos, sin = np.cos(turn[which]), np.sin(turn[which])
    d = size[:, None] * (nominal[:, :2] - stances.place[which])
    return stances.to[which] + np.stack([cos * d[:, 0] - sin * d[:, 1], sin * d[:, 0] + cos * d[:, 1]], axis=-1)
