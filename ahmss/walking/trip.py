"""A trip over the floor, step by step: round what stands there, and round who walks there."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
import shapely

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.errors import AlgorithmError
from ahmss.walking.catalogue import STRAIGHT, Key, Stride
from ahmss.walking.course import Course, NoWay, plan
from ahmss.walking.journey import SPOT, Footing, Journey, Standing, footing, journey, onward, stride_at
from ahmss.walking.library import RATE, Library
from ahmss.walking.makingway import LOOKED, MET, Walker, cut, least, options
from ahmss.walking.nominal import clip_of, length_of
from ahmss.walking.pacing import Paced

__all__ = ["RADIUS", "Ground", "Piece", "Trip", "Walker"]

RADIUS = 0.27  # metres that a walker keeps from things
_APART = 0.75  # metres that two walkers' middles shall keep apart
_THINGS = 0.17  # metres from things that who makes way may come
# The ends by which one stops, and to what share of their length.
_STOPS: tuple[tuple[Stride, float], ...] = (("small", 0.55), ("small", 0.8), ("small", 1.0), ("normal", 1.0))
_NEAR = 2.3  # metres: whom one goes round from the beginning
_TRIED = 4  # ways out that are looked at closely
_LOWEST, _FASTEST, _HARDEST = 0.9, 2.0, 30.0  # hips' height of that in standing, m/s, m/s2: within that one makes way
_AGAIN = 12  # frames after which who waits looks again
_POLITE, _BESIDE, _STANDS = 4.0, 2.2, 0.1  # seconds that one lets others go first, who are so near and so slow (m/s)
_LOOKS, _ABOUT = 1.2, 4.8  # seconds that one looks, before setting out, whether others do who are so near
_ASIDE, _YIELDS = 0.85, 1.0  # metres that one steps aside for who wants to be where one is, after so many seconds
_FIRST = np.array([0.8, 0.6])  # who stands further that way goes first: any way serves
_IMPATIENT = 0.25  # metres: how much nearer one goes in the end
_PATIENCE = 15.0  # seconds that a walker waits for others to go


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
        self._rate = self._pace = 1.0  # frames that pass in one: of the clips, and of a natural walk
        self._things = np.array([shapely.Polygon(ring) for ring in self.ground.outlines if len(ring) > 2], dtype=object)

    def pieces(self, rotations: Array, root: Array) -> Iterator[Piece]:
        """The frames, a step at a time, from a standing pose (43, 4), (3,).

        Raises:
            NoWay: the goal can't be reached. AlgorithmError: somebody stands in the way, and stays there.
        """
        now = footing(self.skeleton, rotations, root, self.standing)
        going, free = self._begun(now)
        self._say_frames(going)
        self._rate, self._pace = float(going.rates[0]), going.natural / len(going.rates)
        if not free or self._lets_go(self._ahead(going, 0), _ABOUT):
            going = yield from self._wait(_piece(going, -1, 0), now, looks=_LOOKS)
        while True:
            going, over = yield from self._steps(going)
            if over:
                return
            going = yield from self._wait(_last(going), self._footing_after(going))

    # Planning

    def _begun(self, now: Footing) -> tuple[Journey, bool]:
        """The walk as it is first planned, and whether others let it begin.

        It leads round those who are so near that the first step would be too late for it; where none does, one waits.
        """
        near = [(x, y, r) for x, y, r in self._circles() if np.hypot(x - now.place[0], y - now.place[1]) < _NEAR]
        if near:
            with contextlib.suppress(NoWay):
                return self._set_out(now, near, frames=self.frames), True
        return self._set_out(now, frames=self.frames), not near

    def _set_out(
        self, now: Footing, circles: Sequence[tuple[float, float, float]] = (), frames: int = 0, pace: float = 1.0
    ) -> Journey:
        course = self._course(now.place, now.heading, circles)
        facing = float(course.heading[-1]) if self.facing is None else self.facing
        if self.facing is None and course.length < SPOT:
            facing = now.heading
        made = self._journey(now, course, facing, frames)
        return made if pace == 1.0 else self._journey(now, course, facing, round(made.natural / pace))

    def _journey(self, now: Footing, course: Course, facing: float, frames: int = 0) -> Journey:
        return journey(self.skeleton, self.library, self.standing, now, course, facing, frames)

    def _course(
        self, place: Array, heading: float, circles: Sequence[tuple[float, float, float]], goal: Array | None = None
    ) -> Course:
        return plan(
            place, self.goal if goal is None else goal, self.ground.outlines, radius=RADIUS, circles=circles,
            start_heading=heading, names=self.ground.names,
        )  # fmt: skip

    def _say_frames(self, going: Journey) -> None:
        """Say so where the frames asked for are none that people walk in."""
        if self.frames and not going.fewest <= self.frames <= going.most:
            few, course = self.frames < going.fewest, going.line.course
            what = "a turn on the spot" if course.length < SPOT else f"{course.length:.1f} m"
            self.note(
                f"{self.frames} frames are too {'few' if few else 'many'} for {what}; "
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
            way_out = self._way_out(going, seam)
            if way_out is not None:
                going, stopping = way_out
                seam, made = 0, 0
        return going, not stopping  # pyright: ignore[reportReturnType]

    def _meets(self, going: Journey, made: int) -> bool:
        """Whether somebody comes too near in the next seconds."""
        others = self.others()
        return bool(others) and least(self._ahead(going, made), others) < MET

    @staticmethod
    def _ahead(going: Journey, made: int) -> Array:
        """Where the hips will be (n, 2) at the times LOOKED, as far as the walk goes."""
        return going.shaping.level[made:][:: round(RATE * LOOKED[1])][: len(LOOKED)]

    def _way_out(self, going: Journey, seam: int) -> tuple[Journey, bool] | None:
        """The walk from a seam on that makes way best, and whether it stops; None: going on as it is is best."""
        stride, others = stride_at(going, seam), self.others()
        scale = self.standing.height / self.library.hip_height
        straight = clip_of(self.library, STRAIGHT)
        speed = self._rate * scale * length_of(straight) * RATE / straight.frames
        since = float(going.line.along(going.nominal.root[going.seams[seam], :1])[0][0])
        course = going.line.course
        if isinstance(course, Paced):
            course, since = course.course, float(course.placed(since))
        rest = cut(course, since, course.length - since)
        stops = [
            share * scale * length_of(clip_of(self.library, Key("end", 0, 0, stride_size, stride.ahead)))
            for stride_size, share in _STOPS
        ]

        def around(place: Array, heading: float, circles: Sequence[tuple[float, float, float]]) -> Course:
            return self._course(place, heading, [(x, y, apart - RADIUS) for x, y, apart in circles])

        own = self._ahead(going, going.seams[seam])
        for option in options(own, rest, stops, speed, others, around)[:_TRIED]:
            if option.course is rest and option.slow == 1.0:
                return None
            if option.course is not rest and self._touches(option.course):
                continue
            facing = float(option.course.heading[-1])
            if self.facing is not None and not option.stops:
                facing = self.facing
            made = onward(
                self.skeleton, self.library, self.standing, stride, option.course, facing, self._rate, option.slow
            )
            if self._natural(made):
                return made, option.stops
        return None

    def _natural(self, going: Journey) -> bool:
        """Whether the next steps of a walk are such as a person makes."""
        root = going.shaping.part(0, min(going.shaping.frames, 2 * going.seams[1])).root
        moved = np.diff(root, axis=0) * RATE
        return bool(
            root[:, 2].min() > _LOWEST * self.standing.height
            and np.linalg.norm(moved, axis=-1).max() < _FASTEST
            and np.linalg.norm(np.diff(moved, axis=0), axis=-1).max() * RATE < _HARDEST
        )

    def _touches(self, course: Course) -> bool:
        """Whether a course comes too near to things soon, and nearer than where it begins."""
        points = course.points[:150]
        if not len(self._things) or len(points) < 2:
            return False
        near = shapely.distance(self._things, shapely.Point(points[0]))
        return bool(
            (shapely.distance(self._things, shapely.LineString(points)) < np.minimum(near, _THINGS) - 1e-6).any()
        )

    def _circles(self, nearer: float = 0.0) -> list[tuple[float, float, float]]:
        """Others as circles, where they are; one may pass nearer to them by so many metres."""
        return [(*other.place.tolist(), _APART - RADIUS - nearer) for other in self.others()]

    def _wait(self, last: Piece, now: Footing, looks: float = 0.0) -> Iterator[Piece]:  # -> Journey
        """Stand until the way is free; the walk from there, the nearer to others the longer one has stood.

        Who stands where another wants to be, and is to go second, steps aside.

        Args:
            last: the frame in which one stands. now: where.
            looks: seconds that one stands in any case, to see where others go; 0: others may go first.
        """
        count, aside = round(_PATIENCE * RATE), False
        for frame in range(count):
            yield last
            if frame % _AGAIN or frame < looks * RATE:
                continue
            if not aside and frame >= _YIELDS * RATE:
                away = self._aside(now)
                if away is not None:
                    yield _piece(away, 0, away.seams[-1])
                    last, now, aside = _last(away), self._footing_after(away), True
            nearer = _IMPATIENT * frame / count
            try:
                ahead = self._set_out(now, self._circles(nearer), pace=self._pace)
            except NoWay:
                continue
            if not looks and frame < _POLITE * RATE and self._lets_go(self._ahead(ahead, 0), _BESIDE):
                continue
            ways = [way for other in self.others() for way in other.may_go()]
            if least(self._ahead(ahead, 0), ways) >= MET - nearer:
                return ahead  # pyright: ignore[reportReturnType]
        raise AlgorithmError("somebody stands in the way and does not go; take another way, or ask them to move")

    def _lets_go(self, own: Array, beside: float) -> bool:
        """Whether somebody who stands ahead is to go first, if they want to: of two only one waits for the other."""
        for other in self.others():
            way = other.place - own[0]
            stands = np.linalg.norm(other.velocity) < _STANDS and np.linalg.norm(way) < beside
            if stands and way @ _FIRST > 0.0 and way @ (own[-1] - own[0]) > 0.0:
                return True
        return False

    def _aside(self, now: Footing) -> Journey | None:
        """A step out of the way of somebody who stands at the goal and is to go first; None: there is none, or no room.

        To the right if there is room, else to the left.
        """
        for other in self.others():
            way = other.place - now.place
            if np.linalg.norm(other.place - self.goal) > _APART or way @ _FIRST <= 0.0:
                continue
            right = np.array([way[1], -way[0]]) / max(float(np.linalg.norm(way)), 1e-9)
            for side in (_ASIDE * right, -_ASIDE * right):
                with contextlib.suppress(NoWay):
                    course = self._course(now.place, now.heading, self._circles(), now.place + side)
                    if course.length < 1.2 * _ASIDE:
                        return self._journey(now, course, now.heading)
        return None

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


def _last(going: Journey) -> Piece:
    """The frame in which a walk ends."""
    return _piece(going, going.seams[-1] - 1, going.seams[-1])
