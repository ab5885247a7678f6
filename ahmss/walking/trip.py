"""A trip over the floor, step by step: round what stands there, and round who walks there."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.errors import AlgorithmError
from ahmss.walking.course import Course, NoWay, plan
from ahmss.walking.journey import SPOT, Footing, Journey, Standing, footing, journey, onward, stride_at
from ahmss.walking.library import RATE, Library

__all__ = ["RADIUS", "Ground", "Piece", "Trip", "Walker"]

RADIUS = 0.27  # metres that a walker keeps from things
_APART = 0.75  # metres that two walkers' middles shall keep apart
_MET, _CLOSE = 0.62, 0.50  # metres apart at which one makes way, and that one accepts in making it
_SEEN = 2.4  # seconds that a walker looks ahead for others
_TURNED_IN = 0.8  # metres in which a walker who goes on passes over to another course
_ASIDE = 0.16  # metres by which an oncoming walker is taken to be further to the left: both pass on the right
_STOP = 0.75  # metres in which a walker stops
_PATIENCE = 15.0  # seconds that a walker waits for others to go


@dataclass(frozen=True)
class Walker:
    """Somebody else on the floor: place (2,) metres, velocity (2,) metres a second."""

    place: Array
    velocity: Array

    def after(self, seconds: Array) -> Array:
        """Where they will be (..., 2)."""
        return self.place + seconds[..., None] * self.velocity


@dataclass(frozen=True)
class Ground:
    """What stands on the floor: outlines (n, 2) in the world, and whose they are."""

    outlines: Sequence[Array] = ()
    names: Sequence[str] = ()


@dataclass(frozen=True)
class Piece:
    """Frames of a trip to be made next: rotations (n, 15, 4), root (n, 3), ankles (n, 2, 3), feet (n, 2, 4)."""

    rotations: Array
    root: Array
    ankles: Array
    feet: Array


@dataclass
class Trip:
    """From where a human stands to a goal.

    Args:
        skeleton: of who walks.
        library: the clips.
        ground: what stands on the floor.
        goal: (2,) metres. facing: the heading there, radians; None: as one arrives.
        frames: how many to take; 0: as a person would.
        others: tells who else is on the floor now.
        note: is told, in one sentence, what a person should know.
    """

    skeleton: Skeleton
    library: Library
    ground: Ground
    goal: Array
    facing: float | None
    frames: int = 0
    others: Callable[[], Sequence[Walker]] = lambda: ()
    note: Callable[[str], None] = lambda _: None
    standing: Standing = field(init=False)

    def __post_init__(self) -> None:  # noqa: D105 (what it sets is a field)
        self.standing = Standing.of(self.skeleton, self.library)

    def pieces(self, rotations: Array, root: Array) -> Iterator[Piece]:
        """The frames, a step at a time, from a standing pose (43, 4), (3,).

        Raises:
            NoWay: the goal can't be reached. AlgorithmError: somebody stands in the way, and stays there.
        """
        now = footing(self.skeleton, rotations, root, self.standing)
        self.others()  # so that their speed is known when it matters
        going = self._set_out(now)
        self._say_frames(going)
        while True:
            going, over = yield from self._steps(going)
            if over:
                return
            yield from self._wait(going)
            now = self._footing_after(going)
            going = self._set_out(now, self._circles())

    # Planning

    def _set_out(self, now: Footing, circles: Sequence[tuple[float, float, float]] = ()) -> Journey:
        course = self._course(now.place, now.heading, circles)
        facing = float(course.heading[-1]) if self.facing is None else self.facing
        if self.facing is None and course.length < SPOT:
            facing = now.heading
        return journey(self.skeleton, self.library, self.standing, now, course, facing, self.frames)

    def _course(self, place: Array, heading: float, circles: Sequence[tuple[float, float, float]]) -> Course:
        return plan(
            place, self.goal, self.ground.outlines, radius=RADIUS, circles=circles, start_heading=heading,
            names=self.ground.names,
        )  # fmt: skip

    def _say_frames(self, going: Journey) -> None:
        """Say so where the frames asked for are none that people walk in."""
        if self.frames and not going.fewest <= self.frames <= going.most:
            few = self.frames < going.fewest
            self.note(
                f"{self.frames} frames are too {'few' if few else 'many'} for {going.line.course.length:.1f} m; "
                f"it takes {going.fewest if few else going.most}"
            )

    # Going

    def _steps(self, going: Journey) -> Iterator[Piece]:  # -> Journey, whether it is over
        """The pieces of a walk, and of those that it becomes where others come in its way."""
        seam, made, stopping = 0, 0, False
        while seam < len(going.seams) - 1:
            seam += 1
            end = going.seams[seam]
            yield _piece(going, made, end)
            made = end
            if seam == len(going.seams) - 1 or stopping or not self._meets(going, made):
                continue
            going, stopping = self._instead(going, seam)
            seam, made = 0, 0
        return going, not stopping  # pyright: ignore[reportReturnType]

    def _meets(self, going: Journey, made: int, apart: float = _MET) -> bool:
        """Whether somebody comes nearer than that in the next seconds."""
        others = self.others()
        if not others:
            return False
        ahead = going.shaping.level[made : made + round(_SEEN * RATE) : 6]
        seconds: Array = np.arange(0.0, len(ahead)) * (6.0 / RATE)
        return any(self._near(ahead, other.after(seconds), apart) for other in others)

    @staticmethod
    def _near(own: Array, other: Array, apart: float) -> bool:
        """Whether two come nearer to each other than they are, and too near."""
        away = np.linalg.norm(own - other, axis=-1)
        return bool(away.min() < apart and away.min() < away[0] - 0.02)

    def _instead(self, going: Journey, seam: int) -> tuple[Journey, bool]:
        """The walk from a seam on round those who come in its way, or to a stop; and whether it stops."""
        stride = stride_at(going, seam)
        along = np.array([np.cos(stride.heading), np.sin(stride.heading)])
        since = stride.place + 0.3 * along
        try:
            course = self._course(since, stride.heading, self._circles(since, along))
            course = _passing(stride.place, stride.heading, course)
            facing = float(course.heading[-1]) if self.facing is None else self.facing
            around = onward(self.skeleton, self.library, self.standing, stride, course, facing)
            if not self._meets(around, 0, _CLOSE):
                return around, False
        except NoWay:
            pass  # somebody closes the way: wait for them
        straight = np.linspace(0.0, _STOP, 38)[:, None]
        stop = Course(stride.place + straight * along, np.full(38, stride.heading), _STOP)
        return onward(self.skeleton, self.library, self.standing, stride, stop, stride.heading), True

    def _circles(self, place: Array | None = None, along: Array | None = None) -> list[tuple[float, float, float]]:
        """Others as circles: where they are while they are met, an oncoming one further to the left."""
        circles: list[tuple[float, float, float]] = []
        for other in self.others():
            radius = _APART - RADIUS
            if place is None or along is None:
                circles.append((*other.place.tolist(), radius))
                continue
            speed = float(np.linalg.norm(other.velocity))
            left = np.array([-along[1], along[0]])
            oncoming = speed > 0.1 and float(other.velocity @ along) < -0.5 * speed
            away = float(np.linalg.norm(other.place - place))
            meeting = away / (1.2 + (speed if oncoming else 0.0))
            for share in (0.6, 1.0, 1.4) if speed > 0.1 else (1.0,):
                x, y = other.after(np.array(min(share * meeting, _SEEN))) + (_ASIDE * left if oncoming else 0.0)
                circles.append((float(x), float(y), radius))
        return circles

    def _wait(self, going: Journey) -> Iterator[Piece]:
        """Stand until the way is free."""
        last = _piece(going, going.seams[-1] - 1, going.seams[-1])
        for _ in range(round(_PATIENCE * RATE)):
            yield last
            try:
                ahead = self._set_out(self._footing_after(going), self._circles())
            except NoWay:
                continue
            if not self._meets(ahead, 0, _CLOSE):
                return
        raise AlgorithmError("somebody stands in the way and does not go; take another way, or ask them to move")

    def _footing_after(self, going: Journey) -> Footing:
        """How the walker stands at the end of a walk."""
        prints = [going.shaping.footprint(foot, going.seams[-1]) for foot in (0, 1)]
        ankles, headings = np.array([one[0] for one in prints]), np.array([one[1] for one in prints])
        heading = float(np.arctan2(np.sin(headings).sum(), np.cos(headings).sum()))
        return Footing(ankles, headings, going.line.course.points[-1], heading)


def _piece(going: Journey, first: int, last: int) -> Piece:
    """The frames after `first` up to `last`."""
    shaped = going.shaping.part(first + 1, last + 1)
    return Piece(shaped.rotations, shaped.root, shaped.ankles, shaped.feet)


def _passing(place: Array, heading: float, course: Course) -> Course:
    """A course that leaves a place in a heading and passes over to another course."""
    join = min(_TURNED_IN, 0.5 * course.length)
    end, towards = course.at(np.array(join))
    reach = float(np.linalg.norm(end - place))
    u = np.linspace(0.0, 1.0, max(int(reach / 0.02), 4))[:, None]
    d0 = 1.2 * reach * np.array([np.cos(heading), np.sin(heading)])
    d1 = 1.2 * reach * np.array([np.cos(towards), np.sin(towards)])
    h = 2.0 * u**3 - 3.0 * u**2
    curve = place * (1.0 + h) + end * -h + d0 * (u**3 - 2.0 * u**2 + u) + d1 * (u**3 - u**2)
    rest, _ = course.at(np.linspace(join, course.length, max(int((course.length - join) / 0.02), 2))[1:])
    points = np.concatenate([curve, rest])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=-1))])
    even = np.linspace(0.0, along[-1], len(points))
    points = np.stack([np.interp(even, along, points[:, i]) for i in range(2)], axis=-1)
    step = np.gradient(points, axis=0)
    headings = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    headings += 2.0 * np.pi * np.round((heading - headings[0]) / (2.0 * np.pi))
    return Course(points, headings, float(along[-1]))
