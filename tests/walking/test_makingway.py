"""What a walker knows of others, what it may do about them, and how it turns in."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.motion.way import AHEAD
from ahmss.walking.course import Course, NoWay, plan
from ahmss.walking.makingway import MET, SAFE, Option, held_up, least, met, options, yields
from ahmss.walking.turning_in import cut, turned_into
from ahmss.walking.walkers import LOOKED, Walker

STILL = np.zeros(2)
STOPS = (0.42, 0.62, 0.77)


def straight(length: float = 6.0, heading: float = 0.0, since: tuple[float, float] = (0.0, 0.0)) -> Course:
    s = np.linspace(0.0, length, int(length / 0.02) + 1)
    points = np.array(since) + s[:, None] * np.array([np.cos(heading), np.sin(heading)])
    return Course(points, np.full(len(s), heading), length)


def around(place: Array, heading: float, circles: Sequence[tuple[float, float, float]]) -> Course:
    rings = [(x, y, r - 0.27) for x, y, r in circles]
    return plan(place, np.array([6.0, 0.0]), [], radius=0.27, circles=rings, start_heading=heading)


def best(other: Walker, rest: Course | None = None) -> Option:
    rest = rest or straight()
    return options(rest.at(1.2 * LOOKED)[0], rest, STOPS, 1.2, [other], around)[0]


def seen(*legs: tuple[float, tuple[float, float]], rate: float = 60.0) -> Walker:
    """Somebody who walked for so many seconds at one velocity after the other."""
    velocities = np.concatenate([np.repeat([v], round(seconds * rate), axis=0) for seconds, v in legs])
    places = np.concatenate([np.zeros((1, 2)), np.cumsum(velocities / rate, axis=0)])
    return Walker.of(np.arange(len(places)) / rate, places)


def test_a_speed_is_that_of_the_last_step() -> None:
    other = seen((0.5, (0.0, 0.0)), (1.0, (0.6, -0.8)))
    np.testing.assert_allclose(other.velocity, [0.6, -0.8])
    np.testing.assert_allclose(other.after(np.array(2.0)) - other.place, [1.2, -1.6])
    assert not other.stops


def test_who_has_just_set_out_is_as_fast_as_now() -> None:
    np.testing.assert_allclose(seen((0.5, (0.0, 0.0)), (0.2, (0.0, 1.0))).velocity, [0.0, 1.0], atol=1e-9)


def test_who_gets_slow_is_about_to_stop() -> None:
    other = seen((0.5, (1.2, 0.0)), (0.2, (0.5, 0.0)))
    assert other.stops
    way = (other.after(LOOKED) - other.place)[:, 0]
    assert (np.diff(way) > 0.0).all()
    assert way[-1] == pytest.approx(0.15, abs=0.01)


def test_who_sways_goes_where_they_face_and_who_turns_or_goes_sideways_does_not() -> None:
    time = np.arange(70) / 60.0
    sway = -0.03 * np.cos(2.0 * np.pi * (time - time[-1]) / 1.1)
    hips = np.radians(8.0) * np.cos(2.0 * np.pi * time / 1.1)  # to and fro with each step
    places = np.stack([1.2 * time, sway], axis=-1)
    assert abs(Walker.of(time, places).velocity[1]) > 0.1  # what the sway makes of it
    other = Walker.of(time, places, "ken", hips)
    np.testing.assert_allclose(other.velocity, [1.2, 0.0], atol=0.03)
    assert other.name == "ken"
    sideways = Walker.of(time, places, "", hips + np.radians(80.0))
    turns = Walker.of(time, places, "", hips + 1.2 * time)
    for one in (sideways, turns):
        np.testing.assert_array_equal(one.velocity, Walker.of(time, places).velocity)


def test_once_seen_one_stands() -> None:
    other = Walker.of(np.array([1.0]), np.array([[2.0, 3.0]]))
    np.testing.assert_array_equal(other.after(LOOKED), np.repeat([[2.0, 3.0]], len(LOOKED), axis=0))


def test_who_comes_no_nearer_does_not_count() -> None:
    own = straight().at(1.2 * LOOKED)[0]
    beside = Walker(np.array([0.0, 0.4]), np.array([1.2, 0.0]))
    assert least(own, [beside]) == np.inf
    assert least(own, [beside, Walker(np.array([2.0, 0.3]), STILL)]) == pytest.approx(0.3, abs=0.02)


@pytest.mark.parametrize("aside", [-0.05, 0.0, 0.15])
def test_who_comes_towards_one_is_passed_on_the_right(aside: float) -> None:
    chosen = best(Walker(np.array([5.0, aside]), np.array([-1.2, 0.0])))
    assert not chosen.stops
    assert chosen.course.points[:, 1].min() < -0.3
    assert chosen.course.points[:, 1].max() < 0.05


def test_nobody_near_changes_nothing() -> None:
    rest = straight()
    chosen = best(Walker(np.array([3.0, 2.0]), STILL), rest)
    assert chosen.course is rest
    assert (chosen.slow, chosen.stops, chosen.cost) == (1.0, False, 0.0)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_who_crosses_just_before_one_is_let_by(side: float) -> None:
    """They would meet after 2 s."""
    other = Walker(np.array([2.4, -1.7 * side]), np.array([0.0, 1.0 * side]))
    chosen = best(other)
    assert not chosen.stops
    own = chosen.course.at(1.2 * chosen.slow * LOOKED)[0]
    assert least(own, [other]) > MET - 0.05
    met = np.linalg.norm(own - other.after(LOOKED), axis=-1).argmin()
    assert side * (own - other.after(LOOKED))[met, 1] < 0.0  # behind them


def test_where_there_is_no_way_round_one_stops() -> None:
    def nowhere(*_: object) -> Course:
        raise NoWay("closed")

    rest = straight()
    chosen = options(rest.at(1.2 * LOOKED)[0], rest, STOPS, 1.2, [Walker(np.array([1.7, 0.0]), STILL)], nowhere)[0]
    assert chosen.stops
    assert 1.7 - chosen.course.length > MET


def test_what_is_left_of_a_course() -> None:
    rest = cut(straight(4.0, 0.5), 1.5, 2.5)
    np.testing.assert_allclose(rest.points[[0, -1]], np.outer([1.5, 4.0], [np.cos(0.5), np.sin(0.5)]), atol=1e-9)
    assert rest.length == 2.5
    assert np.linalg.norm(cut(straight(1.0), 0.5, 2.0).points[-1]) == pytest.approx(2.5)  # goes on straight


@pytest.mark.parametrize("towards", [-1.0, -0.5, 0.0, 0.4, 1.0])
def test_one_turns_in_gently(towards: float) -> None:
    heading = 0.3
    course = straight(5.0, heading + towards, (0.3 * np.cos(heading), 0.3 * np.sin(heading)))
    made = turned_into(STILL, heading, course)
    assert made is not None
    np.testing.assert_allclose(made.points[[0, -1]], [STILL, course.points[-1]], atol=1e-9)
    assert made.heading[0] == pytest.approx(heading, abs=0.01)
    assert made.heading[-1] == pytest.approx(heading + towards, abs=1e-3)
    bend = np.gradient(made.heading, made.length / (len(made.points) - 1))
    assert np.abs(bend).max() < 1 / 0.6
    assert np.abs(bend[:2]).max() < 0.25  # it begins straight


def test_one_does_not_turn_about_in_walking() -> None:
    assert turned_into(STILL, 0.0, straight(3.0, 2.9, (0.3, 0.0))) is None


def test_who_sets_out_will_soon_walk_or_stop() -> None:
    ways = list(Walker(np.zeros(2), np.array([0.0, 0.3])).may_go())
    np.testing.assert_allclose([way.velocity for way in ways], [[0.0, 0.3], [0.0, 1.1]] + 3 * [[0.0, 0.0]])
    np.testing.assert_allclose([way.place[1] for way in ways[2:]], [0.09, 0.24, 0.39])
    assert len(list(Walker(np.zeros(2), np.array([0.05, 0.0])).may_go())) == 1


def telling(place: tuple[float, float], velocity: tuple[float, float], since: float = 0.0) -> Walker:
    """Somebody who tells that they will stand so many seconds more, and then go."""
    way = np.array(place) + np.maximum(AHEAD - since, 0.0)[:, None] * np.array(velocity)
    return Walker(np.array(place), np.zeros(2), way=way)


def test_who_tells_that_they_come_is_met_while_they_still_stand() -> None:
    own = straight().at(1.2 * LOOKED)[0]
    comes, stands = telling((2.4, 1.2), (0.0, -1.0), 0.8), Walker(np.array([2.4, 1.2]), np.zeros(2))
    assert least(own, [stands]) > MET
    assert least(own, [comes]) < 0.2
    assert held_up(own, [comes], begun=False)
    assert not held_up(own, [stands], begun=False)


def test_who_tells_that_they_are_gone_by_then_does_not_hold_one_up() -> None:
    own = straight().at(1.2 * LOOKED)[0]
    goes = telling((1.5, 0.1), (0.0, 1.2))
    guessed = Walker(goes.place, np.array([0.0, 0.3]))
    assert not held_up(own, [goes], begun=False)
    assert held_up(own, [guessed], begun=False)  # they may stop


def test_how_near_who_tells_comes_is_looked_at_as_far_on_as_one_has_planned() -> None:
    own = straight().at(1.2 * np.arange(0.0, 3.65, 0.1))[0]
    comes = telling((4.2, 3.5), (0.0, -1.0))
    assert least(own[: len(LOOKED)], [comes]) > 1.0
    assert least(own, [comes]) < 0.1


def test_who_hears_of_another_way_takes_its_own_back_if_they_go_first() -> None:
    """The second comes towards one, on the way that has just been told; before, they stood."""
    own = straight().at(1.2 * LOOKED)[0]
    stays = np.zeros_like(own)
    for sign in (1.0, -1.0):
        ahead = sign * own
        now = telling((sign * 3.5, 0.0), (-sign * 1.2, 0.0))
        before = Walker(now.place, np.zeros(2), way=np.repeat(now.place[None], len(AHEAD), axis=0))
        assert bool(yields(ahead, stays, [now], [before])) == (sign > 0.0)  # one of both
        assert not yields(ahead, stays, [now], [now])  # it was known
        assert not yields(ahead, ahead, [now], [before])  # it would be no better
        back = Walker(np.array([sign * 1.0, 0.0]), np.zeros(2), way=np.repeat([[sign * 1.0, 0.0]], len(AHEAD), axis=0))
        left = telling((sign * 1.0, 0.0), (0.0, 1.2))
        assert yields(ahead, stays, [back], [left])  # who has taken theirs back can't once more


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_who_is_met_is_moved_to_the_side_on_which_they_are_not_passed(side: float) -> None:
    own = straight().at(1.2 * LOOKED)[0]
    ((x, y),) = met(own, [telling((4.0, 0.0), (-1.0, 0.0)), telling((4.0, 3.0), (-1.0, 0.0))], side)
    assert x == pytest.approx(4.0 / 2.2 * 1.2, abs=0.15)
    assert y == pytest.approx(0.1 * side, abs=1e-6)


def test_what_is_told_is_more_certain_than_what_is_guessed() -> None:
    """Somebody will be met in 2 seconds: it is not cheaper to go on than to make way."""
    place, velocity = np.array([4.6, 0.3]), np.array([-1.1, 0.0])
    rest = straight()
    own = rest.at(1.2 * LOOKED)[0]
    costs = [
        next(option.cost for option in options(own, rest, STOPS, 1.2, [other], around) if option.course is rest)
        for other in (telling((4.6, 0.3), (-1.1, 0.0)), Walker(place, velocity))
    ]
    assert costs[0] > 1.5 * costs[1]
    assert SAFE < MET


def test_who_is_followed_is_kept_farther_from_than_who_goes_beside_or_comes() -> None:
    own = straight().at(1.2 * LOOKED)[0]
    behind, beside, comes = (
        least(own, [telling(place, velocity)])
        for place, velocity in (((1.6, 0.0), (0.85, 0.0)), ((0.1, 1.2), (1.2, -0.2)), ((3.3, 0.78), (-1.2, 0.0)))
    )
    assert behind == pytest.approx(1.6 - 0.35 * 2.4 - 0.3, abs=0.03)
    assert beside == pytest.approx(1.2 - 0.2 * 2.4, abs=0.02)
    assert comes == pytest.approx(0.78, abs=0.02)
