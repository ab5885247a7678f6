"""A trip over the floor, step by step: round what stands there, and round who walks there."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import shapely

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.errors import AlgorithmError
from ahmss.walking.catalogue import STRAIGHT, Key, Stride
from ahmss.walking.clearing import held_arms
from ahmss.walking.course import Course, NoWay, plan
from ahmss.walking.hesitating import back, last_moment
from ahmss.walking.hindering import in_vain, waits
from ahmss.walking.journey import SPOT, Footing, Journey, Standing, footing, journey, onward, stride_at
from ahmss.walking.journey import Stride as Walking
from ahmss.walking.library import RATE, Library
from ahmss.walking.makingway import Option, cut, goes_first, held_up, meets, options
from ahmss.walking.nominal import clip_of, length_of
from ahmss.walking.pacing import Paced
from ahmss.walking.pieces import Clearing, Ground, Piece, footing_at, piece, standing_piece
from ahmss.walking.walkers import LOOKED, MOVING, Walker
from ahmss.walking.wayout import natural, touches

__all__ = ["RADIUS", "Ground", "Piece", "Trip", "Walker"]

RADIUS = 0.27  # metres that a walker keeps from things
_APART = 0.75  # metres that two walkers' middles shall keep apart
_LEAVES, _TOUCHING = 0.03, 0.45  # metres nearer that who stands beside somebody may come on leaving; never nearer
# The ends by which one stops, and to what share of their length.
_STOPS: tuple[tuple[Stride, float], ...] = (("small", 0.55), ("small", 0.8), ("small", 1.0), ("normal", 1.0))
_NEAR = 2.3  # metres: whom one goes round from the beginning
_TRIED = 4  # ways out that are looked at closely
_AGAIN = 12  # frames after which who waits looks again
_POLITE, _BESIDE = 2.0, 2.2  # seconds that one lets others go first, who stand so near (metres)
_LOOKS, _ABOUT = 1.2, 4.8  # seconds that one looks, before setting out, whether others do who are so near
_ASIDE = 0.85  # metres that one steps aside for who wants to be where one is
_YIELDS = 1.0, 5.0  # seconds after which one does, and once more
_IMPATIENT = 0.12  # metres: how much nearer one goes in the end
_TIRED = 6.0  # seconds after which one waits no more for who does hardly move
_KEEPS = 2.5  # seconds for which one keeps to the side on which one has begun to pass
_PATIENCE = 15.0  # seconds that a walker waits for others to go


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
        held: the sides whose arms stay as they are, for what is in their hands.
    """

    skeleton: Skeleton
    library: Library
    ground: Ground
    goal: Array
    facing: float | None
    frames: int = 0
    others: Callable[[], Sequence[Walker]] = lambda: ()
    note: Callable[[str], None] = lambda _: None
    held: Sequence[str] = ()
    standing: Standing = field(init=False)

    def __post_init__(self) -> None:  # noqa: D105 (what it sets is a field)
        self.standing = Standing.of(self.skeleton, self.library)
        self._arms: Array | None = None
        self._made = self._waited = 0  # frames: of the trip so far, and of these for how many one has waited
        self._asides = 0  # steps out of another's way
        self._told = set[str]()  # why one waits: what has been told of it
        self._side, self._sided = 0.0, 0  # on which others are passed, and since which frame
        self._rate, self._rates = 1.0, (1.0, 1.0)  # frames of the clips that pass in one; the least and the most
        self._things = np.array([shapely.Polygon(ring) for ring in self.ground.outlines if len(ring) > 2], dtype=object)

    def pieces(self, rotations: Array, root: Array) -> Iterator[Piece]:
        """The frames, a step at a time, from a standing pose (43, 4), (3,).

        Raises:
            NoWay: the goal can't be reached. AlgorithmError: somebody stands in the way, and stays there.
        """
        self._arms = held_arms(self.skeleton, rotations, root, self.held) if self.held else None
        for made in self._pieces(footing(self.skeleton, rotations, root, self.standing)):
            self._made += len(made.root)
            yield made

    def _pieces(self, now: Footing) -> Iterator[Piece]:
        going, free = self._begun(now)
        self._say_frames(going)
        self._rates = going.natural / going.most, going.natural / going.fewest
        if not free or goes_first(self._ahead(going, 0), self.others(), _ABOUT):
            going = yield from self._wait(piece(going, -1, 0), now, looks=_LOOKS)
        over = False
        while not over:
            clearing = Clearing(self.skeleton, going, last_moment(going), self.ground, self._arms)
            made = yield from self._set_in_motion(going, clearing)
            if made:
                going = clearing.walk()
                self._waited, self._rate = 0, float(going.rates[0])
                going, over = yield from self._steps(going, made)
            if not over:
                end = -1 if made else 0
                going = yield from self._wait(standing_piece(going, end), footing_at(going, end))

    # Planning

    def _begun(self, now: Footing) -> tuple[Journey, bool]:
        """The walk as it is first planned, and whether others let it begin.

        It leads round those who are so near that the first step would be too late for it; where none does, one waits.
        """
        near = [
            (x, y, r) for x, y, r in self._circles(now.place) if np.hypot(x - now.place[0], y - now.place[1]) < _NEAR
        ]
        if near:
            with contextlib.suppress(NoWay):
                return self._set_out(now, near), True
        going = self._set_out(now)
        if near:
            self._tell_waiting(now)
        return going, not near

    def _set_out(self, now: Footing, circles: Sequence[tuple[float, float, float]] = ()) -> Journey:
        course = self._course(now.place, now.heading, circles)
        facing = float(course.heading[-1]) if self.facing is None else self.facing
        if self.facing is None and course.length < SPOT:
            facing = now.heading
        return self._journey(now, course, facing, self._left())

    def _left(self) -> int:
        """How many frames are left of those that were asked for; 0: as many as it takes."""
        return max(self.frames - self._made, 1) if self.frames else 0

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
            way = f"{course.length:.1f} m" if course.length >= 1.0 else f"{100.0 * course.length:.0f} cm"
            what = "a turn on the spot" if course.length < SPOT else way
            self.note(
                f"{self.frames} frames are too {'few' if few else 'many'} for {what}; "
                f"it takes {going.fewest if few else going.most}"
            )

    # Going

    def _set_in_motion(self, going: Journey, clearing: Clearing) -> Iterator[Piece]:  # -> frames; 0: it was called off
        """The first frames, in which weight is shifted, and back again where others have set out as well."""
        made = last_moment(going)
        yield replace(piece(going, 0, made), meanwhile=clearing)
        own = self._ahead(going, made)
        if going.line.course.length < SPOT or not self._held_up(own, begun=True):
            return made  # pyright: ignore[reportReturnType]
        yield Piece(*back(self.skeleton, going, made))
        self._waited += 3 * made
        return 0  # pyright: ignore[reportReturnType]

    def _steps(self, going: Journey, made: int) -> Iterator[Piece]:  # -> Journey, whether it is over
        """The pieces of a walk, and of those that it becomes where others come in its way."""
        seam, stopping = 0, False
        while seam < len(going.seams) - 1:
            seam += 1
            end = going.seams[seam]
            yield piece(going, made, end)
            made = end
            if seam == len(going.seams) - 1 or stopping or not meets(self._ahead(going, made), self.others()):
                continue
            way_out = self._way_out(going, seam)
            if way_out is not None:
                going, stopping = way_out
                seam, made = 0, 0
        return going, not stopping  # pyright: ignore[reportReturnType]

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
        side = self._side if self._made - self._sided < _KEEPS * RATE else 0.0
        for option in options(own, rest, stops, speed, others, around, side)[:_TRIED]:
            if option.course is rest and option.slow == 1.0:
                return None
            if option.course is not rest and touches(option.course, self._things):
                continue
            facing = float(option.course.heading[-1])
            if self.facing is not None and not option.stops:
                facing = self.facing
            made = self._onward(stride, option, facing)
            if natural(made, self.standing.height):
                if option.side:
                    self._side, self._sided = option.side, self._made
                return made, option.stops
        return None

    def _onward(self, now: Walking, option: Option, facing: float) -> Journey:
        """The walk that an option is, as quick as the frames that are left want it after it has been slow."""

        def at(rate: float) -> Journey:
            return onward(
                self.skeleton, self.library, self.standing, now, option.course, facing, rate, option.slow
            )  # fmt: skip

        made = at(self._rate)
        if not self.frames or option.stops:
            return made
        more = len(made.rates) / self._left()
        self._rate = float(np.clip(more * self._rate, *self._rates))
        return at(self._rate)

    def _circles(self, place: Array, nearer: float = 0.0) -> list[tuple[float, float, float]]:
        """Others as circles, where they are; one may pass nearer to them by so many metres.

        Who stands nearer to somebody already may leave from there, but goes no nearer.
        """
        circles: list[tuple[float, float, float]] = []
        for other in self.others():
            away = float(np.linalg.norm(other.place - place)) - _LEAVES
            circles.append((*other.place.tolist(), max(min(_APART - nearer, away), _TOUCHING) - RADIUS))
        return circles

    def _wait(self, last: Piece, now: Footing, looks: float = 0.0) -> Iterator[Piece]:  # -> Journey
        """Stand until the way is free; the walk from there, the nearer to others the longer one has stood.

        Who stands where another wants to be, and is to go second, steps aside.

        Args:
            last: the frame in which one stands. now: where.
            looks: seconds that one stands in any case, to see where others go; 0: others may go first.
        """
        frame = -1
        while self._waited < _PATIENCE * RATE:
            yield last
            frame, self._waited = frame + 1, self._waited + 1
            if frame % _AGAIN or frame < looks * RATE:
                continue
            if self._asides < len(_YIELDS) and frame >= _YIELDS[self._asides] * RATE:
                away = self._aside(now)
                if away is not None:
                    clearing = Clearing(self.skeleton, away, last_moment(away), self.ground, self._arms)
                    made = yield from self._set_in_motion(away, clearing)
                    if made:
                        away, self._asides = clearing.walk(), self._asides + 1
                        yield piece(away, made, away.seams[-1])
                    end = -1 if made else 0
                    last, now = standing_piece(away, end), footing_at(away, end)
            try:
                ahead = self._set_out(now, self._circles(now.place, self._nearer()))
            except NoWay:
                self._course(now.place, now.heading, ())  # refused at once where there is none without others either
                self._tell_waiting(now)
                continue
            own = self._ahead(ahead, 0)
            if not looks and frame < _POLITE * RATE and goes_first(own, self.others(), _BESIDE):
                self._tell_waiting(now)
                continue
            if not self._held_up(own, begun=False):
                return ahead  # pyright: ignore[reportReturnType]
            self._tell_waiting(now)
        raise AlgorithmError(in_vain(self.others(), now.place, self.goal))

    def _tell_waiting(self, now: Footing) -> None:
        """Tell for whom one waits, once each."""
        told = waits(self.others(), now.place, self.goal)
        if told not in self._told:
            self._told.add(told)
            self.note(told)

    def _held_up(self, own: Array, *, begun: bool) -> bool:
        """Whether others may come into the way of a walk along `own`; it counts how long one has waited for them."""
        return held_up(own, self.others(), self._nearer(), begun=begun, tired=self._waited > _TIRED * RATE)

    def _nearer(self) -> float:
        """How much nearer to others (metres) one goes than at first, for having waited; of who all stand soon as near
        as ever: they make no room by being waited for.
        """
        if self._waited > _POLITE * RATE and all(np.linalg.norm(other.velocity) < MOVING for other in self.others()):
            return _IMPATIENT
        return _IMPATIENT * self._waited / (_PATIENCE * RATE)

    def _aside(self, now: Footing) -> Journey | None:
        """A step out of the way of somebody who stands at the goal and is to go first; None: there is none, or no room.

        To the right if there is room, else to the left.
        """
        for other in self.others():
            way = other.place - now.place
            if np.linalg.norm(other.place - self.goal) > _APART or not other.precedes(now.place):
                continue
            right = np.array([way[1], -way[0]]) / max(float(np.linalg.norm(way)), 1e-9)
            for side in (_ASIDE * right, -_ASIDE * right):
                with contextlib.suppress(NoWay):
                    course = self._course(now.place, now.heading, self._circles(now.place), now.place + side)
                    away = self._journey(now, course, now.heading)
                    if course.length < 1.2 * _ASIDE and not held_up(self._ahead(away, 0), self.others(), begun=False):
                        return away
        return None
