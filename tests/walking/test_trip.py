"""Trips among things and people: others walk as they are told to, whatever the walker does."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest
import shapely

from ahmss.body.array import Array
from ahmss.errors import AlgorithmError
from ahmss.motion.contact import foot_points
from ahmss.motion.edit import floor_frame
from ahmss.motion.way import AHEAD, staying
from ahmss.walking import trip
from ahmss.walking.hindering import in_vain, waits
from ahmss.walking.library import BODY, RATE
from ahmss.walking.trip import Ground, Piece, Trip, Walker

from . import measures as m

HIPS = 40.0  # m/s2, the most that the hips of who steps aside may be accelerated; real ones in turns: 38
APART = 0.5  # metres between the hips' middles of two people that pass


def box(x: float, y: float, width: float, depth: float) -> Array:
    return np.array([[-width, -depth], [width, -depth], [width, depth], [-width, depth]]) / 2.0 + [x, y]


TABLE = box(2.5, 0.1, 1.0, 1.2)
CORRIDOR = [box(3.0, 0.55, 9.0, 0.1), box(3.0, -0.55, 9.0, 0.1), box(-1.5, 0.0, 0.1, 1.2), box(7.5, 0.0, 0.1, 1.2)]

Others = Callable[[float], Sequence[Walker]]
"""Who is where at a time in seconds."""


@dataclass
class Made:
    """A trip made to its end: the walk; the pieces' frames; others (F, n, 2); what was noted."""

    walk: m.Walk
    pieces: list[int]
    others: Array
    notes: list[str]

    def nearest(self) -> float:
        away = np.linalg.norm(self.walk.root[:, None, :2] - self.others, axis=-1)
        return float(away.min())


def go(
    goal: tuple[float, float], facing: float | None = None, *, ground: Ground | None = None,
    others: Others = lambda _: (), name: str = "ken", start: float = 0.0, frames: int = 0, most: int = 6000,
) -> Made:  # fmt: skip
    """From the origin, heading `start` degrees, to a goal, facing degrees."""
    body, notes, made = m.subject(name), [], 0
    made_trip = Trip(
        body.skeleton, m.library(), ground or Ground(), np.array(goal), None if facing is None else np.radians(facing),
        frames, lambda: others(made / RATE), notes.append,
    )  # fmt: skip
    rotations, root = body.at((0.0, 0.0), start)
    pieces = []
    for piece in made_trip.pieces(rotations, root):
        pieces.append(piece)
        made += len(piece.root)
        assert made < most, "it never arrives"
    turned = np.concatenate([piece.rotations for piece in pieces])
    whole = np.repeat(body.rotations[None], len(turned), axis=0)
    whole[:, :BODY] = turned
    walk = m.Walk(
        body.skeleton, whole, np.concatenate([piece.root for piece in pieces]), np.zeros((len(turned), 2, 3), bool),
        np.concatenate([piece.ankles for piece in pieces]), np.concatenate([piece.feet for piece in pieces]),
    )  # fmt: skip
    there = [[other.place for other in others((k + 1) / RATE)] for k in range(len(turned))]
    return Made(walk, [len(piece.root) for piece in pieces], np.array(there).reshape(len(turned), -1, 2), notes)


def walking(since: tuple[float, float], velocity: tuple[float, float], begin: float = 0.0, end: float = 99.0) -> Others:
    """Somebody who walks from a place at a velocity from one time to another, and stands before and after."""

    def at(seconds: float) -> Sequence[Walker]:
        moving = begin <= seconds < end
        way = np.clip(seconds, begin, end) - begin
        speed = np.array(velocity)
        return (Walker(np.array(since) + way * speed, speed if moving else np.zeros(2)),)

    return at


def standing(x: float, y: float) -> Others:
    return walking((x, y), (0.0, 0.0))


def check(made: Made, goal: tuple[float, float], facing: float | None = None) -> None:
    """What holds of every trip: it arrives, feet that touch stay, nothing jumps."""
    walk = made.walk
    place, off = m.arrival(walk, np.array(goal), np.radians(facing or 0.0))
    assert place < 0.01
    assert facing is None or off < 1.0
    assert m.sunk(walk) < 0.003
    assert m.knee_flexion(walk).min() > 0.0
    assert m.missed(walk) < 1e-6
    steps = np.linalg.norm(np.diff(walk.root, axis=0), axis=-1)
    assert steps.max() * RATE < 2.2  # nobody is put elsewhere
    soles = np.linalg.norm(np.diff(foot_points(walk.skeleton, walk.rotations, walk.root), axis=0), axis=-1)
    assert soles.min(axis=(1, 2)).max() < 0.003  # at each frame some point of some foot stands
    assert soles.max() * RATE < 8.0
    upright(walk.root)


def upright(root: Array) -> None:
    """Nobody squats as they walk, nor is pulled about."""
    assert root[:, 2].min() > 0.87 * root[0, 2]
    assert np.linalg.norm(np.diff(root, 2, axis=0), axis=-1).max() * RATE**2 < HIPS


def test_over_an_empty_floor_it_is_a_walk() -> None:
    made = go((3.0, -1.0), 90.0)
    check(made, (3.0, -1.0), 90.0)
    assert not made.notes
    assert len(made.pieces) > 3  # a step at a time


def test_without_a_facing_one_looks_where_one_came() -> None:
    made = go((2.0, 2.0))
    check(made, (2.0, 2.0), 45.0)


@pytest.mark.parametrize("name", m.HUMANS)
def test_round_the_table(name: str) -> None:
    made = go((5.0, 0.0), 0.0, ground=Ground([TABLE], ["room/table"]), name=name)
    check(made, (5.0, 0.0), 0.0)
    hips = shapely.points(made.walk.root[:, :2])
    assert shapely.distance(shapely.Polygon(TABLE), hips).min() > 0.15
    feet = shapely.points(made.walk.ankles[:, :, :2].reshape(-1, 2))
    assert shapely.distance(shapely.Polygon(TABLE), feet).min() > 0.03  # nor do the feet go into it


def test_round_somebody_who_stands_in_the_way() -> None:
    made = go((5.0, 0.0), 0.0, others=standing(2.5, 0.0))
    check(made, (5.0, 0.0), 0.0)
    assert made.nearest() > APART


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("late", [-0.8, -0.4, 0.0, 0.4, 0.8])
def test_somebody_who_crosses_is_not_run_into(side: float, late: float) -> None:
    """They are where the walker would be after 3.6 seconds, a little sooner or later."""
    made = go((6.0, 0.0), 0.0, others=walking((3.0, -side * (3.6 + late)), (0.0, side * 1.0)))
    check(made, (6.0, 0.0), 0.0)
    assert made.nearest() > APART


@pytest.mark.parametrize("aside", [-0.2, 0.0, 0.2])
def test_somebody_who_comes_towards_one_is_passed(aside: float) -> None:
    made = go((7.0, 0.0), 0.0, others=walking((8.0, aside), (-1.1, 0.0), end=14.0))
    check(made, (7.0, 0.0), 0.0)
    assert made.nearest() > APART


def test_who_closes_the_way_is_waited_for() -> None:
    made = go((6.0, 0.0), 0.0, ground=Ground(CORRIDOR, ["wall"] * 4), others=gone_after(5.0))
    check(made, (6.0, 0.0), 0.0)
    assert made.nearest() > APART
    waited = [count for count in made.pieces if count == 1]
    assert len(waited) > 20


def test_it_is_told_at_once_and_once_for_whom_one_waits() -> None:
    named = gone_after(5.0)
    others = lambda seconds: [replace(other, name="aiko") for other in named(seconds)]  # noqa: E731
    made = go((6.0, 0.0), 0.0, ground=Ground(CORRIDOR, ["wall"] * 4), others=others)
    assert made.notes == ["waits for aiko, who is in the way"]


def test_it_is_told_that_somebody_is_where_one_is_to_stand(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trip, "_PATIENCE", 0.3)
    body, notes = m.subject("ken"), []
    there = Walker(np.array([2.0, 0.1]), np.zeros(2), name="aiko")
    one = Trip(body.skeleton, m.library(), Ground(), np.array([2.0, 0.0]), None, 0, lambda: (there,), notes.append)
    pieces = one.pieces(*body.at((0.0, 0.0), 0.0))
    next(pieces)
    assert notes == ["waits for aiko, who is where one is to stand (2.00 0.00)"]
    with pytest.raises(AlgorithmError, match="aiko stands in the way, where one is to stand"):
        list(pieces)


def test_who_is_told_to_be_in_the_way_is_near_to_it() -> None:
    """They were told to be where one is to stand 0.7 m off it, and to be in the way by a line through a wall."""
    way = np.array([[0.0, 0.0], [0.0, 3.0], [4.0, 3.0]])  # round a wall
    behind, on_it = (
        Walker(np.array(place), np.zeros(2), name=name) for place, name in (((2.0, 1.2), "cy"), ((0.3, 2.9), "bo"))
    )
    assert waits((behind, on_it), way, way[-1]) == "waits for bo, who is in the way"
    comes = replace(behind, way=np.linspace([2.0, 1.2], [2.0, 3.0], 6), velocity=np.array([0.0, 0.8]))
    assert (
        waits((comes, replace(on_it, place=np.array([-1.5, 0.0]))), way, way[-1]) == "waits for cy, who is in the way"
    )
    beside = replace(behind, place=np.array([4.0, 2.3]))
    assert waits((beside,), way, way[-1]) == "waits for cy, who is too near to where one is to stand (4.00 3.00)"
    assert in_vain((beside,), way, way[-1]).startswith("cy stands in the way, too near to where one is to stand (4.00 ")


def test_who_does_not_go_is_asked_to_go_where_there_is_room() -> None:
    way = np.array([[0.0, 0.0], [2.0, 0.0]])
    ken, bo = (
        Walker(np.array(place), np.zeros(2), name=name) for place, name in (((2.1, 0.1), "ken"), ((2.1, 1.4), "bo"))
    )
    wall = box(2.6, 0.0, 0.2, 6.0)
    told = in_vain((ken, bo), way, way[-1], [wall])
    asked = re.fullmatch(
        r"ken stands in the way, where one is to stand \(2\.00 0\.00\), and does not go; "
        r"ask them to move, as by `ken: do floor walk to (\S+) (\S+)`", told,
    )  # fmt: skip
    assert asked is not None
    x, y = float(asked[1]), float(asked[2])
    assert np.hypot(x - 2.0, y) > 0.95
    assert x < 2.6 - 0.2  # off the wall
    assert np.hypot(x - 2.1, y - 1.4) > 0.95
    assert y < -0.9  # not on the way
    shut = [wall, box(1.0, 0.6, 4.0, 0.1), box(1.0, -0.6, 4.0, 0.1)]  # in a corridor that ends there
    assert in_vain((ken,), way, way[-1], shut).endswith("does not go; ask them to move")


def test_who_stands_and_leaves_little_room_is_soon_gone_by() -> None:
    """Between a panel that was moved up to the walker and somebody who stands there are 0.62 m."""
    around = [box(-0.054, 0.586, 0.34, 0.98), box(0.6, 0.0, 0.1, 3.0), box(-0.4, -1.3, 2.2, 0.1)]
    made = go((-1.5, 1.0), 180.0, ground=Ground(around, ["panel", "wall", "wall"]), others=standing(-0.684, -0.314))
    check(made, (-1.5, 1.0), 180.0)
    assert made.notes == ["waits for somebody, who is in the way"]
    assert sum(count for count in made.pieces if count == 1) < 4.0 * RATE
    assert made.nearest() > 0.42


def gone_after(seconds: float) -> Others:
    """Somebody who stands in the corridor and leaves it through a wall, as only in a test."""

    def at(now: float) -> Sequence[Walker]:
        way = min(1.3 * max(now - seconds, 0.0), 4.0)
        return (Walker(np.array([2.5, way]), np.array([0.0, 1.3 if 0.0 < way < 4.0 else 0.0])),)

    return at


def test_who_never_goes_is_waited_for_but_not_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trip, "_PATIENCE", 0.5)
    with pytest.raises(AlgorithmError, match="somebody stands in the way"):
        go((6.0, 0.0), 0.0, ground=Ground(CORRIDOR, ["wall"] * 4), others=standing(2.5, 0.0))


def test_somebody_far_off_changes_nothing() -> None:
    alone, other = go((4.0, 0.0), 0.0), go((4.0, 0.0), 0.0, others=walking((0.0, 4.0), (1.0, 0.0)))
    np.testing.assert_array_equal(alone.walk.root, other.walk.root)


def test_somebody_behind_is_not_waited_for() -> None:
    made = go((4.0, 0.0), 0.0, others=walking((-2.0, 0.0), (0.6, 0.0), end=3.0))
    assert len(made.walk.root) < 1.2 * len(go((4.0, 0.0), 0.0).walk.root)


@pytest.mark.parametrize(("frames", "said"), [(200, "too few"), (900, "too many"), (0, ""), (420, "")])
def test_frames_that_nobody_walks_in_are_said_to_be_so(frames: int, said: str) -> None:
    made = go((5.0, 0.0), 0.0, frames=frames)
    assert len(made.notes) == (said != "")
    if said:
        assert said in made.notes[0]
        assert str(len(made.walk.root)) in made.notes[0]  # how many it takes
    elif frames:
        assert len(made.walk.root) == frames


@pytest.mark.parametrize("name", m.HUMANS)
@pytest.mark.parametrize("facing", [60.0, -150.0, 180.0, 21.0])
def test_turning_on_the_spot_stays_on_the_spot(facing: float, name: str) -> None:
    made = go((0.0, 0.0), facing, start=20.0, name=name)
    check(made, (0.0, 0.0), facing)
    assert np.linalg.norm(made.walk.root[:, :2], axis=-1).max() < 0.2


def both(first: tuple[float, float], second: tuple[float, float], goals: Sequence[tuple[float, float]]) -> list[Array]:
    return together((first, second), goals)


def together(
    starts: Sequence[tuple[float, float]], goals: Sequence[tuple[float, float]], *,
    names: Sequence[str] = ("ken",), facing: Sequence[float] = (), later: int = 0, late: int = 1,
    ground: Ground | None = None,
) -> list[Array]:  # fmt: skip
    """Trips at once, each seeing the others' frames, and what they tell with them, so many frames late; the hips'
    ways (F, 3) of all.

    names: their bodies, in turn. facing: degrees; towards the goal if left out. later: frames by which the last begins.
    """
    roots: list[list[Array]] = []
    faced: list[list[float]] = []
    told: list[list[Array | None]] = []
    walks = []

    def seen(own: int) -> Callable[[], Sequence[Walker]]:
        def now() -> Sequence[Walker]:
            found: list[Walker] = []
            for i, way in enumerate(roots):
                if i != own:
                    seen = slice(max(begun - late - 70, 0), max(begun - late, 0) + 1)
                    places, angles = np.array(way[seen])[:, :2], np.array(faced[i][seen])
                    found.append(Walker.of(np.arange(len(places)) / RATE, places, "", angles, told[i][seen][-1]))
            return found

        return now

    for i, (place, goal) in enumerate(zip(starts, goals, strict=True)):
        body, way = m.subject(names[i % len(names)]), np.subtract(goal, place)
        rotations, root = body.at(place, facing[i] if facing else float(np.degrees(np.arctan2(way[1], way[0]))))
        roots.append([root])
        faced.append([yaw(rotations[0])])
        told.append([None])
        one = Trip(body.skeleton, m.library(), ground or Ground(), np.array(goal), None, 0, seen(i))
        walks.append(frames(one, rotations, root))
    going, begun = set(range(len(starts))), 0
    while going:
        begun += 1
        for i, walk in enumerate(walks):
            if i == len(walks) - 1 and begun <= later:
                continue
            made = next(walk, None)
            if made is None:
                going.discard(i)
            root, rotations, way = (roots[i][-1], None, None) if made is None else made  # who has arrived stands there
            roots[i].append(root)
            told[i].append(way)
            faced[i].append(faced[i][-1] if rotations is None else yaw(rotations[0]))
        assert max(map(len, roots)) < 2400, "they never arrive"
    for way in roots:
        way += [way[-1]] * (max(map(len, roots)) - len(way))
    made = [np.array(way) for way in roots]
    for way in made:
        upright(way[1:])
    return made


def frames(one: Trip, rotations: Array, root: Array) -> Iterator[tuple[Array, Array, Array]]:
    for piece in one.pieces(rotations, root):
        yield from zip(piece.root, piece.rotations, piece.ways, strict=True)


def yaw(hips: Array) -> float:
    _, turn = floor_frame(hips[None], np.zeros(3))
    return float(2.0 * np.arctan2(turn[3], turn[0]))


@pytest.mark.parametrize("aside", [0.0, 0.15, -0.15, 0.4])
def test_two_who_meet_head_on_pass_each_other(aside: float) -> None:
    ways = both((0.0, 0.0), (6.5, aside), ((6.5, 0.0), (0.0, aside)))
    last = max(map(len, ways))
    a, b = (np.concatenate([way, np.repeat(way[-1:], last - len(way), axis=0)])[:, :2] for way in ways)
    assert np.linalg.norm(a - b, axis=-1).min() > APART
    assert np.linalg.norm(a[-1] - [6.5, 0.0]) < 0.01
    assert np.linalg.norm(b[-1] - [0.0, aside]) < 0.01


@pytest.mark.parametrize("x", [1.0, 1.5, 2.0, 2.6])
def test_two_whose_ways_nearly_meet_pass_upright(x: float) -> None:
    ways = both((-1.0, 1.5), (x, -1.5), ((-1.5, -1.8), (x + 0.3, 0.2)))
    last = max(map(len, ways))
    a, b = (np.concatenate([way, np.repeat(way[-1:], last - len(way), axis=0)])[:, :2] for way in ways)
    assert np.linalg.norm(a - b, axis=-1).min() > APART


@pytest.mark.parametrize("angle", range(-150, 180, 30))
def test_ways_that_cross_at_any_angle(angle: int) -> None:
    a = np.radians(angle)
    way = np.array([np.cos(a), np.sin(a)])
    second, goal = np.array([3.0, 0.0]) - 3.2 * way, np.array([3.0, 0.0]) + 3.0 * way
    if angle == 0 or np.linalg.norm(second) < 1.5:
        pytest.skip("they would begin beside each other")
    ways = both((0.0, 0.0), tuple(second.tolist()), ((6.0, 0.0), tuple(goal.tolist())))
    last = max(map(len, ways))
    one, other = (np.concatenate([way, np.repeat(way[-1:], last - len(way), axis=0)])[:, :2] for way in ways)
    assert np.linalg.norm(one - other, axis=-1).min() > APART


def test_two_whose_ways_cross_do_not_run_into_each_other() -> None:
    ways = both((0.0, 0.0), (3.0, -3.0), ((6.0, 0.0), (3.0, 3.0)))
    last = max(map(len, ways))
    a, b = (np.concatenate([way, np.repeat(way[-1:], last - len(way), axis=0)])[:, :2] for way in ways)
    assert np.linalg.norm(a - b, axis=-1).min() > APART


@pytest.mark.parametrize(
    ("apart", "turned"),
    [
        pytest.param(apart, turned, marks=[pytest.mark.long] if (i - j) % 3 else [])
        for i, apart in enumerate((0.8, 1.5, 2.3, 3.0, 3.6, 4.5))
        for j, turned in enumerate((0.0, 2.0, 4.0))
    ],
)
def test_two_who_change_places_pass_each_other(apart: float, turned: float) -> None:
    there = (apart * np.cos(turned), apart * np.sin(turned))
    ways = both((0.0, 0.0), there, (there, (0.0, 0.0)))
    last = max(map(len, ways))
    a, b = (np.concatenate([way, np.repeat(way[-1:], last - len(way), axis=0)])[:, :2] for way in ways)
    assert np.linalg.norm(a - b, axis=-1).min() > APART
    assert np.linalg.norm(a[-1] - there) < 0.01
    assert np.linalg.norm(b[-1]) < 0.01


@pytest.mark.parametrize("away", [0.6, 1.0, 1.5, 2.0, 3.0])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_nobody_walks_into_who_stands_at_the_goal(away: float, side: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trip, "_PATIENCE", 2.0)
    places: list[Array] = []
    body, other = m.subject("ken"), np.array([side * away, 0.1])
    rotations, root = body.at((0.0, 0.0), 0.0)
    one = Trip(body.skeleton, m.library(), Ground(), other, None, 0, lambda: (Walker(other, np.zeros(2)),))
    with pytest.raises(AlgorithmError, match="somebody stands in the way"):  # noqa: PT012 (what came before counts)
        for piece in one.pieces(rotations, root):
            places.extend(piece.root[:, :2])
    assert np.linalg.norm(np.array(places) - other, axis=-1).min() > min(APART, away - 0.05)


def test_who_goes_second_looks_where_the_other_goes() -> None:
    """Both set out at once, and the hips of who sets out go to one side first."""
    ways = both((1.97, -0.75), (-0.79, -0.33), ((-0.6, -0.47), (1.53, -1.13)))
    last = max(map(len, ways))
    a, b = (np.concatenate([way, np.repeat(way[-1:], last - len(way), axis=0)])[:, :2] for way in ways)
    assert np.linalg.norm(a - b, axis=-1).min() > APART


@pytest.mark.parametrize(
    ("starts", "goals", "facing"),
    [
        (((-2.52, 2.1), (-2.81, 0.36)), ((-0.51, -2.21), (0.44, -2.31)), (-162.0, 76.0)),  # to places side by side
        (((0.25, -2.54), (1.22, -2.63)), ((-1.32, 2.14), (-2.37, -1.76)), (-48.0, -55.0)),  # from places side by side
        (((1.976, -0.012), (1.155, -0.966)), ((-1.703, -2.396), (-2.768, 1.212)), (96.0, 8.0)),  # both turn about first
        (((-2.51, 0.04), (2.51, -0.3)), ((2.51, 0.5), (-2.51, -0.26)), (0.0, 180.0)),
        (((-2.04, -0.35), (-0.36, 0.79)), ((-0.71, 1.05), (-1.78, -0.88)), (16.0, -26.0)),  # to beside
        (((2.24, 1.05), (0.73, -0.05)), ((1.47, -0.72), (1.81, -1.85)), (-68.0, 51.0)),
        (((1.49, -0.48), (-0.68, -2.7)), ((-0.87, -2.09), (0.46, -1.85)), (-139.0, 137.0)),
        (((1.82, -2.18), (-1.3, -1.07)), ((-2.14, -0.42), (0.32, -1.5)), (44.0, -124.0)),  # both turn for seconds
        (((-2.04, 0.4), (2.04, -0.49)), ((2.04, -0.41), (-2.04, 0.44)), (180.0, 0.0)),
        (((2.95, -2.23), (1.45, -0.02)), ((-2.06, 0.54), (2.01, -2.22)), (82.0, 28.0)),  # neither is to go first
    ],
)
@pytest.mark.parametrize(("later", "late"), [(2, 1), (0, 3)])
def test_two_who_face_anywhere_keep_apart_and_arrive(
    starts: tuple[tuple[float, float], ...], goals: tuple[tuple[float, float], ...], facing: tuple[float, ...],
    later: int, late: int,
) -> None:  # fmt: skip
    ways = together(starts, goals, names=("ken", "aiko"), facing=facing, later=later, late=late)
    assert nearest([way[:, :2] for way in ways]) > 0.6
    for way, goal in zip(ways, goals, strict=True):
        assert np.linalg.norm(way[-1, :2] - goal) < 0.01


@pytest.mark.parametrize("heading", [-134.0, 90.0, -90.0])
@pytest.mark.parametrize("apart", [0.6, 0.7])
def test_who_stands_beside_somebody_leaves_at_once_and_does_not_touch_them(apart: float, heading: float) -> None:
    beside = Walker(np.array([-apart, 0.0]), np.zeros(2))
    made = go((-0.1, 3.0), others=lambda _: (beside,), start=heading)
    assert made.nearest() > apart - 0.09
    assert len(made.walk.root) < 8.0 * RATE
    assert np.linalg.norm(made.walk.root[-1, :2] - [-0.1, 3.0]) < 0.01


def nearest(ways: Sequence[Array]) -> float:
    return min(
        float(np.linalg.norm(ways[i] - ways[j], axis=-1).min()) for i in range(len(ways)) for j in range(i)
    )  # fmt: skip


@pytest.mark.parametrize(
    ("starts", "goals"),
    [
        (((0.0, 0.0), (5.09, 1.55)), ((5.09, 1.55), (0.0, 0.0))),
        (((0.0, 0.0), (5.34, 0.23)), ((5.34, 0.23), (0.0, 0.0))),
        (((-0.24, -0.67), (1.46, 1.31)), ((0.99, 2.19), (-0.8, -1.04))),
        (((-2.67, -1.5), (-1.01, -1.34)), ((-2.34, -1.69), (-2.88, -2.62))),
    ],
)
def test_of_two_who_set_out_at_once_one_goes_first(
    starts: Sequence[tuple[float, float]], goals: Sequence[tuple[float, float]]
) -> None:
    """They have stopped, or one steps aside, and neither may go without a look at what the other does."""
    ways = together(starts, goals)
    assert nearest(ways) > APART
    assert all(np.linalg.norm(way[-1, :2] - goal) < 0.01 for way, goal in zip(ways, goals, strict=True))


@pytest.mark.parametrize("turned", [0.0, 0.7, 2.1])
@pytest.mark.parametrize("count", [3, 4])
def test_some_who_meet_at_one_place_all_get_across(count: int, turned: float) -> None:
    angles = np.arange(count) * 2.0 * np.pi / count + turned
    starts = [(3.0 * np.cos(a), 3.0 * np.sin(a)) for a in angles]
    goals = [(-x, -y) for x, y in starts]
    ways = together(starts, goals)
    assert nearest(ways) > APART - 0.05
    assert all(np.linalg.norm(way[-1, :2] - goal) < 0.01 for way, goal in zip(ways, goals, strict=True))


def test_who_makes_way_still_takes_the_frames_asked_for() -> None:
    made = go((7.0, 0.0), 0.0, others=walking((8.0, 0.0), (-1.1, 0.0), end=14.0), frames=480)
    check(made, (7.0, 0.0), 0.0)
    assert made.nearest() > APART
    assert abs(len(made.walk.root) - 480) < 20


def test_a_start_is_called_off_for_who_comes() -> None:
    """They begin to walk across as the walker shifts its weight, and tell nothing."""
    made = go((4.0, 0.0), 0.0, others=walking((1.6, -2.6), (0.0, 1.0), begin=0.2, end=9.0))
    check(made, (4.0, 0.0), 0.0)
    assert made.nearest() > APART
    told, shifted, back = made.pieces[:3]
    assert told < shifted == go((4.0, 0.0), 0.0).pieces[0]
    assert back == 2 * shifted  # back again, no step
    assert np.linalg.norm(made.walk.root[told + 3 * shifted - 1] - made.walk.root[0]) < 1e-9


def test_four_who_set_out_beside_each_other_keep_apart() -> None:
    """One of them takes the way back that another has counted on."""
    starts = ((-2.62, 2.16), (-1.86, -1.32), (-0.81, -1.34), (0.58, 0.38))
    goals = ((-1.91, 1.4), (-1.02, -0.61), (-2.81, 1.27), (-2.52, -2.68))
    ways = together(starts, goals, names=("ken", "aiko"), facing=(3.0, 149.0, -39.0, 118.0))
    assert nearest([way[:, :2] for way in ways]) > 0.55
    assert all(np.linalg.norm(way[-1, :2] - goal) < 0.01 for way, goal in zip(ways, goals, strict=True))


def test_what_is_told_is_where_the_hips_will_be() -> None:
    made = list(pieces((3.0, 1.0), 90.0))
    root, ways = (np.concatenate([getattr(piece, name) for piece in made]) for name in ("root", "ways"))
    steps = np.minimum(np.arange(len(root))[:, None] + np.round(AHEAD * RATE).astype(int), len(root) - 1)
    assert np.abs(ways - root[steps, :2]).max() < 0.01


def test_who_waits_tells_that_it_stays_and_then_that_it_goes() -> None:
    """Somebody walks by, and will be gone."""
    made = list(pieces((4.0, 0.0), 0.0, walking((1.4, -1.5), (0.0, 1.0))))
    waited = [piece for piece in made if len(piece.root) == 1]
    assert waited
    for piece in waited:
        np.testing.assert_array_equal(piece.ways[0], np.repeat(piece.root[:, :2], len(AHEAD), axis=0))
    assert np.linalg.norm(made[-1].ways[-1] - [4.0, 0.0]) < 0.01


def test_a_changed_way_is_told_before_it_is_gone() -> None:
    """Somebody far off is put into the way, as the walker is on it."""

    def appears(seconds: float) -> Sequence[Walker]:
        place = np.array([3.6, 0.0]) if seconds > 0.7 else np.array([9.0, 9.0])
        return (Walker(place, np.zeros(2), way=staying(place)),)

    made = list(pieces((5.0, 0.0), 0.0, appears))
    told = np.concatenate([piece.ways for piece in made])
    ends = np.cumsum([len(piece.root) for piece in made])
    aside = int(np.argmax(np.abs(told[:, -1, 1]) > 0.2))  # the first frame in which another way is told
    assert aside in ends
    assert ends[list(ends).index(aside) + 1] - aside == 7
    root = np.concatenate([piece.root for piece in made])
    assert np.linalg.norm(told[aside, 3] - root[aside + round(1.6 * RATE), :2]) < 0.01
    assert np.linalg.norm(root[:, :2] - [3.6, 0.0], axis=-1).min() > 0.6


@pytest.mark.parametrize("length", [0.8, 2.0, 4.0])
def test_who_is_told_to_stand_too_near_to_somebody_says_so_soon(length: float) -> None:
    made, beside = 0, Walker(np.array([length + 0.4, 0.3]), np.zeros(2), name="aiko")
    with pytest.raises(AlgorithmError, match="aiko stands in the way, where one is to stand"):  # noqa: PT012
        for piece in pieces((length, 0.0), None, lambda _: (beside,)):
            made += len(piece.root)
    assert made < 12.0 * RATE


def pieces(goal: tuple[float, float], facing: float | None, others: Others = lambda _: ()) -> Iterator[Piece]:
    """Those of a trip from the origin, as they are handed out."""
    body, made = m.subject("ken"), 0
    heading = None if facing is None else np.radians(facing)
    one = Trip(body.skeleton, m.library(), Ground(), np.array(goal), heading, 0, lambda: others(made / RATE))
    for piece in one.pieces(*body.at((0.0, 0.0), 0.0)):
        made += len(piece.root)
        yield piece


def test_of_two_who_wait_for_each_other_one_steps_aside() -> None:
    """One stands where the other is to stand, and waits for them, as they stand beside the gap that she has to take."""
    around = Ground(
        [box(0.77, 0.2, 0.9, 1.2), box(2.13, 0.2, 0.45, 0.45), box(2.0, -0.52, 4.0, 0.06)], ["table", "chair", "wall"]
    )
    goals = ((-0.2, 0.0), (1.55, -0.2))
    ways = together(((1.7, 0.9), (-0.3, 0.2)), goals, names=("ken", "aiko"), facing=(180.0, 0.0), ground=around)
    for way, goal in zip(ways, goals, strict=True):
        np.testing.assert_allclose(way[-1, :2], goal, atol=1e-3)
    assert nearest([way[:, :2] for way in ways]) > 0.62


def strolls(begin: float) -> Others:
    """Somebody who tells nothing, and goes straight on from standing to standing, at up to 1.3 m/s."""

    def at(seconds: float) -> Array:
        share = np.clip((seconds - begin) / 4.6, 0.0, 1.0)
        ahead = 0.35 * share**2 * (3.0 - 2.0 * share) + 0.65 * share
        return np.array([-2.5 + 5.0 * ahead, 0.02 * np.sin(5.7 * seconds) * (0.0 < share < 1.0)])

    def seen(now: float) -> Sequence[Walker]:
        since = np.arange(max(now - 70.0 / RATE, 0.0), now + 1e-9, 1.0 / RATE)
        return [Walker.of(since, np.array([at(moment) for moment in since]), "ken", np.zeros(len(since)))]

    return seen


@pytest.mark.parametrize(
    ("start", "goal", "begin"),
    [((-0.12, 2.29), (0.3, -2.38), 0.7), ((1.59, -1.65), (-1.61, 1.78), 0.7), ((2.16, -1.39), (-2.08, 1.2), 1.0)],
)
def test_who_crosses_and_tells_nothing_is_kept_clear_of(
    start: tuple[float, float], goal: tuple[float, float], begin: float
) -> None:
    body, others, made = m.subject("aiko"), strolls(begin), 0
    way = np.subtract(goal, start)
    rotations, root = body.at(start, float(np.degrees(np.arctan2(way[1], way[0]))))
    trip = Trip(body.skeleton, m.library(), Ground(), np.array(goal), None, 0, lambda: others(made / RATE))
    apart: list[float] = []
    for piece in trip.pieces(rotations, root):
        for root in piece.root:
            made += 1
            apart.append(float(np.linalg.norm(root[:2] - others(made / RATE)[0].place)))
    assert min(apart) > 0.6
    np.testing.assert_allclose(root[:2], goal, atol=1e-3)
