"""A walk from where a human stands to where it shall stand: the clips chosen, joined and brought onto the course."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.planting import feet as feet_of
from ahmss.walking.catalogue import STRAIGHT, STRIDES, Key, Side
from ahmss.walking.course import Course
from ahmss.walking.handover import Handover
from ahmss.walking.legs import foot_frames
from ahmss.walking.library import Library
from ahmss.walking.line import Line
from ahmss.walking.nominal import Nominal, clip_of, join, length_of, straights, stretched, woven
from ahmss.walking.pacing import paced
from ahmss.walking.selection import Selection, bins, candidates, measured, select
from ahmss.walking.shaping import Shaped, Shaping
from ahmss.walking.treading import Ends

__all__ = ["SPOT", "AtSeam", "Footing", "Journey", "Standing", "at_seam", "footing", "journey", "onward", "stands_at"]

_FORWARD = np.array([1.0, 0.0, 0.0])
_MIRROR = np.array([1.0, -1.0, 1.0])
SPOT = 0.02  # metres: who goes less far turns on the spot
_THERE, _FACING = 0.015, np.radians(1.0)  # metres, radians: feet so near to where they shall be stay where they are
_SLOWEST, _FASTEST = 0.66, 1.4  # of the clips' cadence, that people still walk at
_TAKEN_OVER = 30  # frames of the clips in which a new walk takes over; the foot that swings lands after 34
_EASED, _HELD = 30, 120  # frames in which who makes way changes the cadence, and for which it is kept
_STRETCHED = 6.0  # how much worse it is to stretch an end than to shrink it


@dataclass(frozen=True)
class Standing:
    """How the walker stands when it does nothing else: where the feet are against the hips' floor frame.

    ankles (2, 2) metres, headings (2,) radians, right and left; height: of the hips, metres.
    """

    ankles: Array
    headings: Array
    height: float

    @classmethod
    def of(cls, skeleton: Skeleton, library: Library) -> Standing:
        """As the library's walks begin, on this skeleton: the rotations are the clips', the height follows."""
        clip = next(clip for key, clip in library.clips.items() if key.kind == "start")
        ankles, q = foot_frames(skeleton, clip.rotations[:1], np.zeros((1, 3)))
        soles = ankles[0, :, None] + rotate(q[0][:, None], np.stack([skeleton.soles, skeleton.soles * _MIRROR]))
        ahead = rotate(q[0], _FORWARD)
        return cls(ankles[0, :, :2], np.arctan2(ahead[:, 1], ahead[:, 0]), -float(soles[..., 2].min()))


@dataclass(frozen=True)
class Footing:
    """Where a human's feet stand, and where its hips would be if it stood at ease on them.

    ankles (2, 2) metres, headings (2,) radians, right and left; place (2,), heading in radians.
    """

    ankles: Array
    headings: Array
    place: Array
    heading: float


def footing(skeleton: Skeleton, rotations: Array, root: Array, standing: Standing) -> Footing:
    """Of a pose (43, 4), (3,) in the world."""
    frames = feet_of(skeleton, rotations, root)
    ahead = rotate(frames[:, 3:], _FORWARD)
    headings = np.arctan2(ahead[:, 1], ahead[:, 0])
    heading = float(np.arctan2(ahead[:, 1].sum(), ahead[:, 0].sum()))
    back = -float(standing.ankles[:, 0].mean())
    place = frames[:, :2].mean(axis=0) + back * np.array([np.cos(heading), np.sin(heading)])
    return Footing(frames[:, :2], headings, place, heading)


def stands_at(standing: Standing, now: Footing, place: Array, facing: float | None) -> bool:
    """Whether both feet are where they shall be already.

    Args:
        standing: how the walker stands.
        now: its footing.
        place: (2,) the goal, metres. facing: the heading there, radians; None: any.
    """
    ankles, headings = _stood(standing, place, now.heading if facing is None else facing)
    off = np.abs((headings - now.headings + np.pi) % (2.0 * np.pi) - np.pi)
    return bool(np.linalg.norm(ankles - now.ankles, axis=-1).max() < _THERE and off.max() < _FACING)


@dataclass(frozen=True)
class Journey:
    """A planned walk.

    shaping: gives its frames, 0 the present one, as far on as they are asked for. seams: the frames at which clips
    meet, at each of which, but the first and the last, a foot lands and the walk may go on otherwise. rates (F - 1,):
    how many frames of the clips pass from each frame to the next. natural, fewest, most: frames that it takes as a
    person does, at the briskest, at the slowest.
    """

    selection: Selection
    shaping: Shaping | Handover
    line: Line
    nominal: Nominal
    rates: Array
    natural: int
    fewest: int
    most: int

    @property
    def seams(self) -> tuple[int, ...]:
        """The frames at which clips meet."""
        return self.nominal.seams

    @property
    def shaped(self) -> Shaped:
        """All its frames."""
        return self.shaping.part(0, self.shaping.frames)


def journey(
    skeleton: Skeleton, library: Library, standing: Standing, now: Footing, course: Course, facing: float,
    frames: int = 0,
) -> Journey:  # fmt: skip
    """Plan a walk from standing to standing.

    Args:
        skeleton: of who walks.
        library: the clips.
        standing: how the walker stands.
        now: its footing at the start.
        course: the way from `now.place` to the goal.
        facing: the heading at the goal, radians, world.
        frames: how many to take; 0: as a person would. What no person could do is brought within what they can.
    """
    scale = standing.height / library.hip_height
    if course.length < SPOT:  # too short a way to have a direction
        course = Course(course.points[-1:], np.array([now.heading]), 0.0)
    begin, over = float(course.heading[0]), float(course.heading[-1])
    way = paced(course)
    d, f, mirror = bins(np.degrees(_wrapped(begin - now.heading)), np.degrees(_wrapped(facing - over)))
    lengths = measured(candidates(d, f), lambda key: scale * length_of(clip_of(library, key)))
    chosen = select(lengths, max(way.length, 1e-4))
    nominal = join(woven(library, d, f, chosen, mirror=mirror), scale)
    natural = len(nominal.root) - 1
    fewest, most = int(np.ceil(natural / _FASTEST)), int(natural / _SLOWEST)
    count = int(np.clip(frames, fewest, most)) if frames else natural
    x = nominal.root[list(nominal.seams), 0]
    nominal, rates = _at_times(nominal, np.linspace(0.0, natural, count + 1))
    sign = -1.0 if mirror else 1.0
    one = len(x) == 2
    line = Line(
        way, length=float(x[-1]), first=float(x[-1] if one else x[1]), last=float(x[-1] if one else x[-2]),
        start=chosen.start_ratio, end=chosen.end_ratio,
        turn_first=_wrapped(now.heading - begin + sign * np.radians(d)),
        turn_last=_wrapped(facing - over - sign * np.radians(f)),
    )  # fmt: skip
    ends = Ends(now.ankles, now.headings, *_stood(standing, course.points[-1], facing))
    shaping = Shaping(skeleton, nominal, line, ends, standing.height)
    return Journey(chosen, shaping, line, nominal, rates, natural, fewest, most)


@dataclass(frozen=True)
class AtSeam:
    """A walker in the middle of a walk, where two clips meet, one foot about to land.

    ahead: the foot that lands. place (2,), heading: of the line at the hips. ankles (2, 2), headings (2,): of the feet,
    the one that lands where it will stand. walk, frame: what it has walked so far, and where in it. rate: frames of the
    clips that pass in one.
    """

    ahead: Side
    place: Array
    heading: float
    ankles: Array
    headings: Array
    walk: Shaping | Handover
    frame: int
    rate: float


def at_seam(going: Journey, seam: int) -> AtSeam:
    """The walker at an inner seam of a walk."""
    frame = going.seams[seam]
    root = going.nominal.root[frame]
    place, heading = going.line.course.at(going.line.along(root[:1])[0])
    # A few frames before, as at other times than the clips' a seam lies between two frames.
    ahead: Side = "left" if going.nominal.bearing[frame - 3, 0].any() else "right"
    prints = [going.shaping.footprint(foot, frame) for foot in (0, 1)]
    ankles, headings = np.array([one[0] for one in prints]), np.array([one[1] for one in prints])
    rate = float(going.rates[frame - 1])
    return AtSeam(ahead, place[0], float(heading[0]), ankles, headings, going.shaping, frame, rate)


def onward(
    skeleton: Skeleton, library: Library, standing: Standing, now: AtSeam, course: Course, facing: float,
    rate: float = 1.0, slow: float = 1.0, since: int = 0,
) -> Journey:  # fmt: skip
    """Go on walking along another course, which begins at `now.place` in its heading.

    Args:
        skeleton: of who walks.
        library: the clips.
        standing: how the walker stands.
        now: how it walks now.
        course: the way from there to the goal.
        facing: the heading at the goal, radians, world.
        rate: frames of the clips that pass in one when it need not make way.
        slow: the share of that rate at which it walks for the next two seconds.
        since: how many frames ago it was there: it has gone on as before, and begins now to go the other way.
    """
    scale = standing.height / library.hip_height
    _, f, mirror = bins(0.0, np.degrees(_wrapped(facing - float(course.heading[-1]))))
    way = paced(course)
    chosen = _rest(library, scale, f, mirror, now.ahead, way.length)
    clips = straights(library, chosen.steps, mirror=now.ahead == "left")
    end = Key("end", 0, -f if mirror else f, chosen.stride, chosen.last)
    nominal = join([*clips, clip_of(library, end)], scale)
    natural = len(nominal.root) - 1
    x = nominal.root[list(nominal.seams), 0]
    nominal, rates = _at_times(nominal, _changing(natural, now.rate, rate, slow))
    line = Line(
        way, length=float(x[-1]), first=0.0, last=float(x[-2]), start=1.0, end=chosen.end_ratio,
        turn_first=_wrapped(now.heading - float(course.heading[0])),
        turn_last=_wrapped(facing - float(course.heading[-1]) - np.radians(-f if mirror else f)),
    )  # fmt: skip
    ends = Ends(now.ankles, now.headings, *_stood(standing, course.points[-1], facing))
    shaping = Shaping(skeleton, nominal, line, ends, standing.height)
    over = Handover(skeleton, now.walk, now.frame, shaping, round(_TAKEN_OVER / max(now.rate, rate)), since)
    return Journey(chosen, over, line, nominal, rates, natural, natural, natural)


def _rest(library: Library, scale: float, facing: int, mirror: bool, ahead: Side, distance: float) -> Selection:
    """How many straights and which end for the rest of a way: that which is shrunk least, or stretched even less."""
    straight = scale * length_of(clip_of(library, STRAIGHT))
    other: Side = "left" if ahead == "right" else "right"
    best: tuple[float, Selection] | None = None
    for steps in range(int(distance / straight) + 2):
        last = ahead if steps % 2 == 0 else other
        for stride in STRIDES:
            key = Key("end", 0, -facing if mirror else facing, stride, last)
            ratio = (distance - steps * straight) / (scale * length_of(clip_of(library, key)))
            badness = max(_STRETCHED * np.log(ratio), -np.log(ratio)) if ratio > 0.0 else np.inf
            if best is None or badness < best[0]:
                best = (float(badness), Selection("3Parts", stride, steps, last, 1.0, max(ratio, 0.05)))
    assert best is not None
    return best[1]


def _at_times(nominal: Nominal, times: Array) -> tuple[Nominal, Array]:
    """A walk at other times, as `stretched` does it, and its rates."""
    rates = np.diff(times)
    natural = len(nominal.root) - 1
    return (nominal if len(times) == natural + 1 and np.ptp(rates) < 1e-9 else stretched(nominal, times)), rates


def _changing(natural: int, now: float, rate: float, slow: float) -> Array:
    """The times of a walk of so many frames of the clips whose rate changes from `now`: smoothly, from 0 on."""
    frames = np.arange(int(2.0 * natural / min(now, slow * rate)) + _HELD)
    rates = now + (slow * rate - now) * minimum_jerk(frames / _EASED)
    rates += (rate - slow * rate) * minimum_jerk((frames - _HELD) / _EASED)
    times = np.concatenate([[0.0], np.cumsum(rates)])
    return np.append(times[times < natural - 0.5 * rate], float(natural))


def _stood(standing: Standing, place: Array, heading: float) -> tuple[Array, Array]:
    """Where the feet stand when the hips are over a place."""
    cos, sin = np.cos(heading), np.sin(heading)
    turned = standing.ankles @ np.array([[cos, sin], [-sin, cos]])
    return place + turned, standing.headings + heading


def _wrapped(angle: float) -> float:
    return float((angle + np.pi) % (2.0 * np.pi) - np.pi)
