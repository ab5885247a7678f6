"""Footsteps on the spot and to a place near by: as few as turn and reach allow, none on the other foot."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from ahmss.walking.footsteps import LEFT, RIGHT, Frame
from ahmss.walking.moves import Feet, Placed, footsteps

FEET = Feet((Frame(0.0, -0.1, -0.1), Frame(0.0, 0.1, 0.1)), -0.08, 0.19)
HERE = Frame(0.0, 0.0, 0.0)


@cache  # several tests look at one turn
def taken(turn: float, lead: int | None = None, *, even: bool = False) -> list[Placed]:
    return footsteps(FEET, FEET.own, HERE, Frame(0.0, 0.0, np.radians(turn)), 2, lead, even=even)


@pytest.mark.parametrize(("turn", "steps"), [(30.0, 2), (60.0, 3), (90.0, 3), (120.0, 3), (150.0, 4), (180.0, 4)])
def test_no_more_are_taken_than_the_turn_needs_whichever_foot_leads(turn, steps):
    assert [len(taken(sign * turn, lead)) for sign in (1, -1) for lead in (None, LEFT, RIGHT)] == [steps] * 6


@pytest.mark.parametrize("turn", [45.0, 75.0, 105.0, 120.0, 150.0, 180.0, -60.0, -120.0])
def test_no_foot_lands_turned_in_by_much(turn):
    now = [0.0, 0.0]
    for one in taken(turn):
        now[one.foot] = one.landing.heading - FEET.own[one.foot].heading
        out = np.degrees(now[LEFT] - now[RIGHT])
        assert -45.0 - 1e-6 <= out <= 75.0 + 1e-6


@pytest.mark.parametrize("turn", [60.0, 90.0, 120.0, 150.0, 180.0, -90.0, -150.0])
@pytest.mark.parametrize("lead", [LEFT, RIGHT])
def test_feet_take_turns_and_both_end_where_the_goal_has_them(turn, lead):
    placed = taken(turn, lead)
    assert [one.foot for one in placed] == [(lead + i) % 2 for i in range(len(placed))]
    goal = Frame(0.0, 0.0, np.radians(turn))
    for one in placed[-2:]:
        there = FEET.beside(goal, one.foot)
        assert np.allclose([*one.landing.place, one.landing.heading], [*there.place, there.heading])


def test_an_odd_number_is_left_out_where_the_other_foot_must_land_last():
    odd = [t for t in range(15, 181, 15) if len(taken(float(t), RIGHT)) % 2]
    assert odd
    assert all(len(taken(float(t), RIGHT, even=True)) % 2 == 0 for t in odd)


def test_no_foot_lands_on_the_other_nor_turned_far_from_it():
    for turn in range(-180, 181, 15):
        now = list(FEET.own)
        for one in taken(float(turn)):
            now[one.foot] = one.landing
            assert FEET.apart(now[0], now[1]) > 0.085
            apart = now[LEFT].heading - 0.1 - (now[RIGHT].heading + 0.1)
            assert abs(np.degrees(apart)) < 76.0


@pytest.mark.parametrize("way", [-60.0, -45.0, -30.0, 30.0, 60.0, 90.0])
@pytest.mark.parametrize("turn", [0.0, 90.0, -90.0])
def test_legs_do_not_cross_on_the_way_aside(way, turn):
    goal = Frame(np.cos(np.radians(way)), np.sin(np.radians(way)), np.radians(turn))
    now = list(FEET.own)
    for one in footsteps(FEET, FEET.own, HERE, goal, 3):
        now[one.foot] = one.landing
        off = now[LEFT].place - now[RIGHT].place
        assert np.cos(one.body) * off[1] - np.sin(one.body) * off[0] >= 0.05 - 1e-9
