"""A trip over the floor, step by step: round what stands there, and round who walks there.

With each frame a walker tells where it will be. What it has told it changes only into what keeps clear of what others
have told; a changed way is told some frames before it is gone, and taken back if somebody else, who goes first, has
changed theirs at the same time.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.errors import AlgorithmError
from ahmss.motion.way import ways_of
from ahmss.walking.hesitating import back, last_moment
from ahmss.walking.hindering import in_vain, waits
from ahmss.walking.journey import SPOT, AtSeam, Footing, Journey, at_seam, footing
from ahmss.walking.library import RATE, Library
from ahmss.walking.limbs import held_arms
from ahmss.walking.makingway import held_up, least, meets, yields
from ahmss.walking.pieces import (
    Clearing,
    Ground,
    Piece,
    footing_at,
    part,
    piece,
    repeated,
    setting_out,
    standing_piece,
)  # fmt: skip
from ahmss.walking.planning import IMPATIENT, RADIUS, Planner, ahead, beginning
from ahmss.walking.walkers import Walker
from ahmss.walking.wayout import Pace, WayOut, halted, way_out

__all__ = ["RADIUS", "Ground", "Piece", "Trip", "Walker"]

_WINDOW = 7  # frames that a changed way is told before it is gone: twice as long as others may be seen late, and one
_SOON = 1.5  # seconds: who comes so soon is looked for in a step
_SUDDEN, _NEWS = 0.6, 0.08  # metres: for who is to come so near one makes way at once, if by the latter it is news
_AGAIN = 12  # frames after which who waits looks again
_YIELDS = 1.0, 1.0, 2.5  # seconds after which one steps aside for who wants to be where one is, and again
_TIRED = 6.0  # seconds after which one waits no more for who does hardly move
_STUCK = 4.0  # seconds after which one steps aside also for who may wait for oneself
_STILL = 2.0  # seconds after which one goes as near as ever to who all stand
_KEEPS = 2.5  # seconds for which one keeps to the side on which one has begun to pass
_PATIENCE, _TAKEN = 15.0, 6.0  # seconds that a walker waits for others to go; for who just stands at the goal


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
        things: points (n, 3) of what that is, by the side, in the hand's frame.
        rests: tells whether one is to stop where one is, and stand.
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
    rests: Callable[[], bool] = lambda: False
    things: Mapping[str, Array] = field(default_factory=dict[str, Array])
    planner: Planner = field(init=False)

    def __post_init__(self) -> None:  # noqa: D105 (what it sets is a field)
        self.planner = Planner(self.skeleton, self.library, self.ground, self.goal, self.facing)
        self._arms: Array | None = None
        self._made = self._waited = 0  # frames: of the trip so far, and of these for how many one has waited
        self._taken = 0  # frames that one has waited for who just stands at the goal
        self._asides = 0  # steps out of another's way
        self._back = False  # whether one has stepped back as one stands
        self._notes = set[str]()  # why one waits: what has been told of it
        self._side, self._sided = 0.0, 0  # on which others are passed, and since which frame
        self._pace = Pace()
        self._sudden: tuple[WayOut, int] | None = None  # what a step has become, and after how many of its frames

    def pieces(self, rotations: Array, root: Array) -> Iterator[Piece]:
        """The frames, a step at a time, from a standing pose (43, 4), (3,).

        Raises:
            NoWay: the goal can't be reached. AlgorithmError: somebody stands in the way, and stays there.
        """
        self._arms = held_arms(self.skeleton, rotations, root, self.held, self.things) if self.held else None
        for made in self._pieces(footing(self.skeleton, rotations, root, self.planner.standing)):
            yield made
            self._made += len(made.root) if self._sudden is None else self._sudden[1]

    def _pieces(self, now: Footing) -> Iterator[Piece]:
        going: Journey | None = self.planner.walk(now, frames=self.frames)
        over = False
        self._say_frames(going)
        self._pace = Pace(1.0, going.natural / going.most, going.natural / going.fewest)
        if self.others():
            going = yield from self._wait(standing_piece(going, 0), now)
        while going is not None and not over:
            made, going = yield from self._set_in_motion(going)
            if made:
                self._waited, self._pace = 0, replace(self._pace, rate=float(going.rates[0]))
                going, over = yield from self._steps(going, made)
            if not over:
                end = -1 if made else 0
                going = yield from self._wait(standing_piece(going, end), footing_at(going, end))

    def _left(self, later: int = 0) -> int:
        """How many frames are left of those that were asked for; 0: as many as it takes."""
        return max(self.frames - self._made - later, 1) if self.frames else 0

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

    def _set_in_motion(self, going: Journey) -> Generator[Piece, None, tuple[int, Journey]]:
        """The first frames, in which weight is shifted, and back again where others have set out as well.

        Returns:
            how many were made, 0: it was called off; the walk.
        """
        made, before = last_moment(going), self.others()
        ground = self.planner.crowded(going.shaping.level[0], before)
        going = setting_out(self.skeleton, going, made, ground, self._arms)
        clearing = Clearing(self.skeleton, going, made, ground, self._arms)
        yield replace(piece(going, 0, made), meanwhile=clearing)
        own, others = beginning(going, made), self.others()
        guessed = [other for other in others if other.way is None]
        if not self.rests() and (
            going.line.course.length < SPOT
            or not (
                held_up(own, guessed, self._nearer(guessed), begun=True, tired=self._tired)
                or yields(own, _stays(own), others, _later(before, made))
            )
        ):
            return made, clearing.walk()
        rotations, root, ankles, feet = back(self.skeleton, going, made)
        yield Piece(rotations, root, ankles, feet, ways_of(root[:, :2], 0, len(root), RATE))
        self._waited += 3 * made
        return 0, going

    def _steps(self, going: Journey, made: int) -> Generator[Piece, None, tuple[Journey, bool]]:
        """The pieces of a walk, and of those that it becomes where others come in its way.

        Returns:
            the walk that it has become, and whether it is over.
        """
        seam, stopping = 0, False
        here: AtSeam | None = None  # at the last seam
        known = np.inf  # how near others were to come, as one came there
        while seam < len(going.seams) - 1:
            seam += 1
            end = going.seams[seam]
            last = stopping or seam == len(going.seams) - 1
            window = min(_WINDOW, end - made - 1) if self.others() and not last else 0
            begins, step, made = made == going.seams[seam - 1], piece(going, made, end), end
            first = part(step, 0, len(step.root) - window)
            if here is not None and begins and not stopping:
                first = replace(first, look=partial(self._looks, going, seam - 1, here, known))
            yield first
            if self._sudden is not None:
                (way, made), self._sudden = self._sudden, None
                going, stopping, seam, here = self._on(way), way.stops, 0, way.here
                continue
            if last:
                continue
            step = part(step, len(step.root) - window, len(step.root))
            if window and all(other.way is None for other in self.others()):
                yield step  # of who tells nothing more is known the later it is
                window = 0
            others = _later(self.others(), window)
            way, here = None, at_seam(going, seam)
            if self.rests():
                if window:
                    yield step
                way = halted(self.planner, going, seam, here, self._pace)
                assert way is not None
                going, stopping, seam, made = way.going, True, 0, 0
                continue
            if meets(ahead(going, end), others):
                way = self._way_out(going, seam, here, others, self._left(window))
            if window:
                if way is not None:
                    level = np.concatenate([going.shaping.level[: end + 1], way.going.shaping.level[1:]])
                    step = replace(step, ways=ways_of(level, end - window + 1, end + 1, RATE))
                yield step
            known = least(ahead(going, end) if way is None else ahead(way.going, 0), others)
            if way is None or (window and yields(ahead(way.going, 0), ahead(going, end), self.others(), others)):
                continue
            going, stopping, seam, made, here = self._on(way), way.stops, 0, 0, way.here
        return going, not stopping

    def _looks(self, going: Journey, seam: int, here: AtSeam, known: float, made: int) -> bool:
        """Look for who is suddenly in the way, in a step that is being made, and whether one is to stop; whether it
        becomes another now.

        Args:
            going: the walk. seam: with which the step begins. here: the walker there.
            known: how near others were to come (metres), when it was decided on.
            made: frames of the step so far.
        """
        way, others = None, self.others()
        if self.rests():
            way = halted(self.planner, going, seam, here, self._pace, made)
        elif others and least(ahead(going, going.seams[seam] + made, _SOON), others) < min(_SUDDEN, known - _NEWS):
            way = self._way_out(going, seam, here, _later(others, -made), self._left(), made)
        self._sudden = None if way is None else (way, made)
        return self._sudden is not None

    def _way_out(
        self, going: Journey, seam: int, here: AtSeam, others: Sequence[Walker], left: int, since: int = 0
    ) -> WayOut | None:
        """How one makes way for others at a seam, with so many frames left (0: any), or so many after it."""
        side = self._side if self._made - self._sided < _KEEPS * RATE else 0.0
        return way_out(self.planner, going, seam, here, others, replace(self._pace, left=left), side, since)

    def _on(self, way: WayOut) -> Journey:
        """The walk that one goes on with."""
        if way.side:
            self._side, self._sided = way.side, self._made
        self._pace = replace(self._pace, rate=way.rate)
        return way.going

    # Waiting

    def _wait(self, stands: Piece, now: Footing) -> Generator[Piece, None, Journey | None]:
        """Stand until the way is free, if it is not; the walk from there, None where one is to stay.

        One goes the nearer to others the longer one has stood. Who stands where another wants to be, and is to go
        second, steps aside.

        Args:
            stands: the frame in which one stands. now: where.
        """
        stood, again, self._back = 0, 0, self._made == 0  # who begins leaves from where they stand
        while self._waited < _PATIENCE * RATE and self._taken < _TAKEN * RATE:
            if self.rests():
                return None
            if again == 0:
                again = _AGAIN
                away = self.planner.dodge(now, self.others())
                if away is None and self._asides < len(_YIELDS) and stood >= _YIELDS[self._asides] * RATE:
                    away = self.planner.aside(
                        now, self.others(), tired=self._waited > _STUCK * RATE, late=self._waited > _TIRED * RATE
                    )
                    self._asides += away is not None
                if away is not None:
                    stands, now = yield from self._stepped(away)
                    stood = 0
                others = self.others()
                window = _WINDOW if any(other.way is not None or other.stays for other in others) else 0
                soon = _later(others, window)
                going = self.planner.free(now, soon, self._left(window), self._nearer(others), tired=self._tired)
                back = None if going is None or self._back else self.planner.retreat(now, going, others)
                if back is not None:
                    stands, now = yield from self._stepped(back)
                    self._back, again = True, 0
                    continue
                if going is not None:
                    hinder = (yield from self._announced(going, stands, soon, window)) if window else []
                    if not hinder:
                        return going
                    again = 1 if all(other.stays for other in hinder) else 3 * window  # who goes first tries first
                else:
                    self._tell_waiting(now)
                    self._taken += _AGAIN if self.planner.taken(others) else 0
            yield stands
            stood, again, self._waited = stood + 1, again - 1, self._waited + 1
        raise AlgorithmError(in_vain(self.others(), self._straight(now), self.goal, self.ground.outlines))

    def _stepped(self, away: Journey) -> Generator[Piece, None, tuple[Piece, Footing]]:
        """The frames of a step aside, unless it is called off; the frame in which one stands then, and where."""
        made, away = yield from self._set_in_motion(away)
        if made:
            yield piece(away, made, away.seams[-1])
        end = -1 if made else 0
        return standing_piece(away, end), footing_at(away, end)

    def _announced(
        self, going: Journey, stands: Piece, others: Sequence[Walker], window: int
    ) -> Generator[Piece, None, list[Walker]]:
        """The frames in which one stands and tells that one will go; for whom one does not.

        Args:
            going: the walk. stands: the frame. others: as they will be then. window: how many frames.
        """
        level = np.concatenate([np.repeat(going.shaping.level[:1], window, axis=0), going.shaping.level])
        yield replace(repeated(stands, window), ways=ways_of(level, 0, window, RATE))
        self._waited += window
        own = beginning(going, 0)
        return yields(own, _stays(own), self.others(), others)

    def _tell_waiting(self, now: Footing) -> None:
        """Tell for whom one waits, once each."""
        note = waits(self.others(), self._straight(now), self.goal)
        if note not in self._notes:
            self._notes.add(note)
            self.note(note)

    def _straight(self, now: Footing) -> Array:
        """The way (n, 2) that one would go if nobody were there."""
        return self.planner.course(now.place, now.heading).points

    @property
    def _tired(self) -> bool:
        return self._waited > _TIRED * RATE

    def _nearer(self, others: Sequence[Walker]) -> float:
        """How much nearer to others (metres) one goes than at first, for having waited; of who all stand soon as near
        as ever: they make no room by being waited for.
        """
        if self._waited > _STILL * RATE and all(other.stays for other in others):
            return IMPATIENT
        return IMPATIENT * self._waited / (_PATIENCE * RATE)


def _later(others: Sequence[Walker], frames: int) -> list[Walker]:
    return [other.later(frames / RATE) for other in others] if frames else [*others]


def _stays(own: Array) -> Array:
    """Where one is (n, 2) who stays where one would set out along `own`."""
    return np.repeat(own[:1], len(own), axis=0)
