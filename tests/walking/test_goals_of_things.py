"""Where one stands to use a thing that has no place of its own for that."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from ahmss.body.quaternion import from_axis_angle
from ahmss.walking.goals import beside, facing_of

THING = np.array([2.0, 0.5])


def box(x: float, y: float, width: float, depth: float) -> np.ndarray:
    return np.array([[-width, -depth], [width, -depth], [width, depth], [-width, depth]]) / 2.0 + [x, y]


@pytest.mark.parametrize("human", [(0.0, 0.0), (2.0, 3.0), (5.0, 0.5)])
def test_one_stands_before_it_on_the_own_side_looking_at_it(human: tuple[float, float]) -> None:
    goal = beside(THING, np.array(human), [])
    assert np.linalg.norm(goal.place - THING) == pytest.approx(0.42, abs=0.02)
    towards = np.array(human) - THING
    assert (goal.place - THING) @ towards / np.linalg.norm(towards) > 0.38
    way = THING - goal.place
    assert goal.facing == pytest.approx(np.arctan2(way[1], way[0]))


def test_what_stands_on_a_table_is_used_from_its_edge() -> None:
    table = box(2.0, 0.5, 1.2, 0.8)
    goal = beside(np.array([2.0, 0.25]), np.array([2.0, -3.0]), [table])
    away = shapely.distance(shapely.Polygon(table), shapely.points(goal.place))
    assert 0.18 < away < 0.29
    assert goal.place[1] < 0.1  # on the side that it is near to and the human comes from
    assert abs(goal.place[0] - 2.0) < 0.15


@pytest.mark.parametrize("degrees", [0.0, 90.0, -135.0, 179.0])
def test_a_heading_is_that_of_the_x_axis(degrees: float) -> None:
    q = from_axis_angle(np.array([0.0, 0.0, 1.0]), np.radians(degrees))
    assert np.degrees(facing_of(q)) == pytest.approx(degrees)


def test_one_does_not_stand_where_a_wall_is_between() -> None:
    table, wall = box(2.0, 0.5, 1.2, 0.8), box(2.0, 0.0, 6.0, 0.02)
    cup, human = np.array([2.0, 0.2]), np.array([2.0, -3.0])
    assert beside(cup, human, [table]).place[1] < 0.1
    goal = beside(cup, human, [table, wall])
    assert goal.place[1] > 0.05
    assert shapely.distance(shapely.Polygon(table), shapely.Point(goal.place)) > 0.18


def test_the_shoulders_of_who_leans_to_it_are_clear_of_what_stands_beside() -> None:
    turn = np.radians(40.0)
    table = box(0.0, 0.0, 1.0, 1.2) @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    table, cup = table + np.array([0.77, 0.2]), np.array([0.727, -0.293])
    wall, jamb, shelf = box(2.0, -0.5, 3.34, 0.02), box(0.29, -0.5, 0.08, 0.16), box(2.5, -0.33, 0.92, 0.34)
    goal = beside(cup, np.array([1.43, 1.09]), [table, wall, jamb, shelf], 0.475)
    ahead = np.array([np.cos(goal.facing), np.sin(goal.facing)])
    shoulder = goal.place + 0.2 * ahead + 0.2 * np.array([ahead[1], -ahead[0]])
    assert shapely.distance(shapely.Polygon(jamb), shapely.Point(shoulder)) > 0.05
    assert np.linalg.norm(goal.place - cup) < 0.66


def test_what_is_around_is_widened_once_for_all_the_places_that_are_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is what takes time of it, in the frame in which a walk begins."""
    union, made = shapely.union_all, list[int]()
    monkeypatch.setattr(shapely, "union_all", lambda shapes: made.append(len(shapes)) or union(shapes))
    table = np.array([[0.0, -0.5], [1.0, -0.5], [1.0, 0.5], [0.0, 0.5]])
    beside(np.array([0.2, 0.0]), np.array([-2.0, 0.0]), [table, table + 3.0])
    assert made == [2]
