"""Others of whom something is known suddenly: whose main is gone, or who plays a clip and makes way for nobody."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.motion.smoothness import pops
from ahmss.motion.way import AHEAD
from ahmss.walking.journey import Footing
from ahmss.walking.library import BODY, RATE
from ahmss.walking.pieces import LOOKS
from ahmss.walking.planning import Planner
from ahmss.walking.trip import Ground, Trip, Walker

from . import measures as m

LATE = 2  # frames by which others are seen late
UNHEARD = 8  # frames after which who is heard of no more is taken to stand

Somebody = Callable[[int], Walker]
"""Who is seen at a frame."""


def strolls(place: tuple[float, float], degrees: float, since: float, length: float = 4.0) -> Somebody:
    """Somebody who stands, and then plays a clip of a walk, heading so."""
    start, ahead = np.array(place), np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])

    def at(seconds: float) -> Array:
        gone = max(seconds - since, 0.0)
        way = gone**2 / 1.2 if gone < 0.6 else gone - 0.3
        return start + 1.2 * min(way, length / 1.2) * ahead

    def seen(frame: int) -> Walker:
        now = frame / RATE
        ways = np.array([at(now + later) if now >= since else start for later in AHEAD])
        return Walker.of(np.array([now]), at(now)[None], "aiko", way=ways)

    return seen


class Crosses:
    """Somebody who crosses the way, and of whom nothing more is heard from a moment on.

    Args:
        degrees: heading. at: where the way is crossed, x; seconds: when. near: metres from the walker at which that is.
    """

    def __init__(self, degrees: float, at: float, seconds: float, near: float) -> None:
        self._velocity = 1.15 * np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
        self._at, self._seconds, self._near = np.array([at, 0.0]), seconds, near
        self._gone = 10**9

    def place(self, frame: int, later: float = 0.0) -> Array:
        return self._at + (min(frame, self._gone) / RATE + later - self._seconds) * self._velocity

    def __call__(self, frame: int) -> Walker:
        place = self.place(frame)[None]
        if frame > self._gone + UNHEARD:
            return Walker.of(np.array([frame / RATE]), place, "aiko")
        ways = np.array([self.place(frame, later) for later in AHEAD])
        return Walker.of(np.array([frame / RATE]), place, "aiko", way=ways)

    def look(self, frame: int, walker: Array) -> None:
        if frame > 20 and np.linalg.norm(self.place(frame) - walker) < self._near:
            self._gone = min(self._gone, frame)


def nearest(other: Somebody) -> float:
    """How near (metres) ken comes to somebody, who walks 5.2 m along x: smoothly, and all the way."""
    body = m.subject("ken")
    rotations, root = body.at((-2.6, 0.0), 0.0)
    made, turned = [root], [rotations[:BODY]]

    def others() -> Sequence[Walker]:
        return (other(max(len(made) - 1 - LATE, 0)),)

    trip = Trip(body.skeleton, m.library(), Ground(), np.array([2.6, 0.0]), None, others=others)
    for piece in trip.pieces(rotations, root):
        frames = len(piece.root)
        for k in range(1, frames + 1):
            made.append(piece.root[k - 1])
            turned.append(piece.rotations[k - 1])
            if isinstance(other, Crosses):
                other.look(len(made) - 1, made[-1][:2])
            if piece.look is not None and k in LOOKS and k < frames and piece.look(k):
                break
        assert len(made) < 1500, "it never arrives"
    there = np.array([other(frame).place for frame in range(len(made))])
    way = np.array(made)
    assert np.linalg.norm(way[-1, :2] - [2.6, 0.0]) < 0.01
    assert pops(np.array(turned)).max() < m.POP
    assert np.linalg.norm(np.diff(way, 2, axis=0), axis=-1).max() * RATE**2 < 30.0
    return float(np.linalg.norm(way[:, :2] - there, axis=-1).min())


@pytest.mark.parametrize(("degrees", "at", "seconds"), [(-90.0, -0.38, 2.78), (120.0, 0.16, 2.13), (90.0, -0.56, 2.02)])
def test_whose_main_dies_in_the_way_is_gone_round(degrees: float, at: float, seconds: float) -> None:
    assert nearest(Crosses(degrees, at, seconds, 1.5)) > 0.55


@pytest.mark.parametrize(("x", "y", "since"), [(2.0, 0.0, 1.48), (1.0, 0.18, 0.86), (1.5, 0.11, 1.59)])
def test_who_plays_a_clip_straight_at_one_is_dodged(x: float, y: float, since: float) -> None:
    assert nearest(strolls((x, y), 180.0, since)) > 0.45


def test_who_waits_steps_aside_for_who_would_walk_through_them() -> None:
    assert nearest(strolls((0.2, 0.03), 180.0, 0.3)) > 0.7


def test_nobody_steps_aside_for_who_passes_by_or_where_it_is_of_no_use() -> None:
    body = m.subject("ken")
    planner = Planner(body.skeleton, m.library(), Ground(), np.array([2.6, 0.0]), None)
    now = Footing(body.standing.ankles, body.standing.headings, np.zeros(2), 0.0)
    comes = strolls((2.4, 0.05), 180.0, 0.0)(30)
    assert planner.dodge(now, [comes]) is not None
    assert planner.dodge(now, [strolls((2.4, 0.6), 180.0, 0.0)(30)]) is None
    assert planner.dodge(now, [strolls((0.6, 0.05), 180.0, 0.0)(24)]) is None


def stander(place: Array) -> Walker:
    return Walker(place, np.zeros(2), name="aiko", way=np.repeat(place[None], len(AHEAD), axis=0))


def test_who_stands_close_before_somebody_steps_back_before_going_round_them() -> None:
    body = m.subject("ken")
    planner = Planner(body.skeleton, m.library(), Ground(), np.array([3.0, 0.0]), None)
    now = Footing(body.standing.ankles, body.standing.headings, np.zeros(2), 0.0)
    going = planner.walk(now)
    near, beside, behind = (stander(np.array(place)) for place in ((0.55, 0.1), (0.0, 0.6), (-0.6, 0.0)))
    back = planner.retreat(now, going, [near])
    assert back is not None
    assert np.linalg.norm(back.line.course.points[-1] - near.place) == pytest.approx(0.8, abs=0.01)
    assert planner.retreat(now, going, [beside, behind]) is None


def test_where_there_is_no_room_at_either_hand_one_steps_aside_farther_on() -> None:
    body = m.subject("ken")
    walls = [np.array([[-4.0, y], [0.9, y], [0.9, y + 0.1], [-4.0, y + 0.1]]) for y in (-0.6, 0.5)]
    walls.append(np.array([[-4.1, -0.6], [-4.0, -0.6], [-4.0, 0.6], [-4.1, 0.6]]))
    ground = Ground(walls, ["left", "right", "back"], [1.0, 1.0, 1.0])
    goal = np.array([1.6, 0.0])
    planner = Planner(body.skeleton, m.library(), ground, goal, None)
    now = Footing(body.standing.ankles, body.standing.headings, np.zeros(2), 0.0)
    assert planner.aside(now, [stander(goal)]) is None  # in a lane with who waits at its mouth
    there = Footing(body.standing.ankles + goal, body.standing.headings, goal, 0.0)
    out = Planner(body.skeleton, m.library(), ground, np.zeros(2), None)
    assert out.aside(there, [stander(np.zeros(2))]) is None  # who goes first does not
    late = out.aside(there, [stander(np.zeros(2))], late=True)
    assert late is not None
    spot = late.line.course.points[-1]
    assert 0.8 < np.linalg.norm(spot - goal) < 2.5
    assert abs(spot[1]) > 0.8
