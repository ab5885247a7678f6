"""Ways round things, judged by shapely's distances; footprints are worked out by hand."""

import re

import numpy as np
import pytest
import shapely

from ahmss.errors import AlgorithmError
from ahmss.walking.bend import SLACK, blurred
from ahmss.walking.course import Course, NoWay, blocked, nearest_free, plan

RADIUS = 0.27


def box(x, y, width, depth, deg=0.0):
    a = np.radians(deg)
    corners = np.array([[-width, -depth], [width, -depth], [width, depth], [-width, depth]]) / 2.0
    return corners @ np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]]) + [x, y]


TABLE = box(0.0, 0.0, 1.0, 1.2)
U_ROOM = np.array([[-2, -2], [2, -2], [2, 2], [1.9, 2], [1.9, -1.9], [-1.9, -1.9], [-1.9, 2], [-2, 2]], dtype=float)
HALL = [box(-1.4, 0.0, 2.0, 0.1), box(1.4, 0.0, 2.0, 0.1)]  # an opening of 0.8 m


def way(start, goal, obstacles, **more):
    return plan(np.array(start), np.array(goal), obstacles, radius=RADIUS, **more)


def curvature(course):
    return np.gradient(course.heading) / (course.length / (len(course.points) - 1))


def clearance(course, obstacles, leaving=0.0):
    """The least distance of a course from footprints, without what lies as near to its ends."""
    away = np.minimum(*(np.linalg.norm(course.points - course.points[end], axis=-1) for end in (0, -1)))
    union = shapely.union_all([shapely.Polygon(ring) for ring in obstacles])
    return shapely.distance(union, shapely.points(course.points[away >= leaving])).min(initial=np.inf)


def check(course, start, goal):
    """What holds of every course."""
    assert tuple(course.points[0]) == tuple(start)
    assert tuple(course.points[-1]) == tuple(goal)
    legs = np.diff(course.points, axis=0)
    steps = np.linalg.norm(legs, axis=-1)
    assert steps.max() < 0.0201
    assert np.ptp(steps) < 5e-4
    assert course.length == pytest.approx(steps.sum(), rel=1e-3)
    assert course.length >= np.linalg.norm(np.subtract(goal, start)) - 1e-9
    tangent = np.stack([np.cos(course.heading), np.sin(course.heading)], axis=-1)
    along = legs / steps[:, None]
    middle = tangent[:-1] + tangent[1:]
    assert (along * middle / np.linalg.norm(middle, axis=-1, keepdims=True)).sum(axis=-1).min() > 0.999
    assert np.abs(np.diff(course.heading)).max() < 0.15
    assert np.abs(np.diff(curvature(course))).max() < 0.8


def test_nothing_in_the_way_is_a_straight_line():
    course = way((0.0, 1.0), (-3.0, 5.0), [TABLE])
    check(course, (0.0, 1.0), (-3.0, 5.0))
    assert course.length == pytest.approx(5.0)
    np.testing.assert_allclose(course.heading, np.arctan2(4.0, -3.0))
    assert way((0.0, 1.0), (-3.0, 5.0), []).length == pytest.approx(5.0)


def test_places_and_headings_by_arc_length_go_on_straight_beyond_both_ends():
    course = way((0.0, 1.0), (-3.0, 5.0), [TABLE])
    place, heading = course.at(np.array([[-1.0, 0.0], [2.5, 6.0]]))
    np.testing.assert_allclose(place, [[[0.6, 0.2], [0.0, 1.0]], [[-1.5, 3.0], [-3.6, 5.8]]], atol=1e-12)
    np.testing.assert_allclose(heading, np.arctan2(4.0, -3.0))


def test_a_place_on_a_bend_lies_on_the_circle():
    turn = np.linspace(0.0, np.pi / 2, 48)
    circle = Course(np.stack([np.sin(turn), 1.0 - np.cos(turn)], axis=-1), turn, np.pi / 2)
    s = np.linspace(0.0, np.pi / 2, 1001)
    place, heading = circle.at(s)
    np.testing.assert_allclose(place, np.stack([np.sin(s), 1.0 - np.cos(s)], axis=-1), atol=1e-7)
    np.testing.assert_allclose(heading, s, atol=1e-9)


def test_a_walk_to_where_one_stands_has_no_length():
    course = way((0.0, 1.0), (0.0, 1.0), [TABLE], start_heading=np.pi / 2)
    assert course.length == 0.0
    place, heading = course.at(np.array([0.0, 0.5]))
    np.testing.assert_allclose(place, [[0.0, 1.0], [0.0, 1.5]], atol=1e-12)
    np.testing.assert_allclose(heading, np.pi / 2)


@pytest.mark.parametrize("place", [(0.56, 0.0), (0.4, 0.1)])  # 6 cm from its edge, and within it
def test_who_turns_where_they_stand_may_be_as_near_to_a_table_as_they_are(place):
    x, y = place
    assert way(place, (x, y + 0.01), [TABLE]).length < 0.02
    with pytest.raises(NoWay):
        way(place, (x - 0.02, y), [TABLE])


def test_the_way_round_a_table_bends_as_wide_as_asked():
    course = way((-1.2, -0.8), (0.9, 1.6), [TABLE])
    check(course, (-1.2, -0.8), (0.9, 1.6))
    assert clearance(course, [TABLE]) > RADIUS - 0.01
    assert -1.2 / 0.6 < curvature(course).min() < -0.5  # it turns right
    assert curvature(course).max() < 0.05  # and right only
    assert np.abs(np.diff(curvature(course))).max() < 0.1  # no step in the bend
    assert course.length < 3.6


def test_there_is_room_to_turn_back_round_the_end_of_a_wall():
    course = way((-1.0, 0.0), (1.0, 0.0), [box(0.0, -2.0, 0.1, 6.0)])
    check(course, (-1.0, 0.0), (1.0, 0.0))
    assert np.abs(curvature(course)).max() < 1.3 / 0.6
    tighter = plan(
        np.array([-1.0, 0.0]), np.array([1.0, 0.0]), [box(0.0, -2.0, 0.1, 6.0)], radius=0.27, turn_radius=0.3
    )
    assert tighter.length < course.length


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_the_shorter_side_of_a_table_is_taken(side):
    course = way((-2.0, 0.3 * side), (2.0, 0.3 * side), [TABLE])
    check(course, (-2.0, 0.3 * side), (2.0, 0.3 * side))
    assert (side * course.points[:, 1]).max() > 0.8
    assert clearance(course, [TABLE]) > RADIUS - 0.08


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_of_two_ways_as_long_the_one_ahead_is_taken(side):
    course = way((-2.0, 0.0), (2.0, 0.0), [TABLE], start_heading=side * 0.5)
    assert (side * course.points[:, 1]).max() > 0.8


def test_a_doorway_of_80_cm_lets_one_through():
    course = way((-2.0, -1.0), (0.3, 2.0), HALL)
    check(course, (-2.0, -1.0), (0.3, 2.0))
    assert clearance(course, HALL) > RADIUS - 0.08
    crossing = course.points[np.argmin(np.abs(course.points[:, 1]))]
    assert abs(crossing[0]) < 0.4 - RADIUS + 0.08


def test_out_of_a_room_shaped_like_a_u():
    course = way((0.0, -1.0), (0.0, -3.0), [U_ROOM])
    check(course, (0.0, -1.0), (0.0, -3.0))
    assert clearance(course, [U_ROOM]) > RADIUS - 0.08
    assert course.points[:, 1].max() > 2.0


@pytest.mark.parametrize("goal", [(0.1, 0.2), (0.0, 0.65)])
def test_a_goal_within_a_thing_names_it_and_a_place_that_is_free(goal):
    with pytest.raises(NoWay) as caught:
        way((-2.0, -1.0), goal, [HALL[0] - 5.0, TABLE], names=["room/wall", "room/table"])
    assert isinstance(caught.value, AlgorithmError)
    assert "{:.2f}, {:.2f}".format(*goal) in str(caught.value)
    assert "room/table" in str(caught.value)
    free = np.array([float(number) for number in re.findall(r"[-\d.]+", str(caught.value))[-2:]])
    assert clearance(way((-2.0, -1.0), free, [TABLE]), [TABLE]) > RADIUS - 0.08


def test_where_another_human_stands_is_no_goal():
    with pytest.raises(NoWay, match="another human stands"):
        way((-2.0, 0.0), (1.0, 0.1), [], circles=[(1.0, 0.0, 0.2)])


def test_a_goal_in_a_closed_room_names_what_closes_it():
    walls = [box(0, 2, 4.1, 0.1), box(0, -2, 4.1, 0.1), box(2, 0, 0.1, 4.1), box(-2, 0, 0.1, 4.1)]
    names = ["north", "south", "east", "west"]
    with pytest.raises(NoWay, match=r"closed off by north, south, east, west; the nearest .* is -2\.\d+ 0\.00"):
        way((-4.0, 0.0), (-1.0, 0.0), [*walls, box(0.5, 0.0, 0.5, 0.5)], names=[*names, "stool"])
    with pytest.raises(NoWay, match=r"closed in by north, south, east, west; the nearest .* is -1\.\d+ 0\.00"):
        way((-1.0, 0.0), (-4.0, 0.0), walls, names=names)


def test_one_leaves_a_table_that_one_touches():
    start, goal = (-0.53, 0.1), (1.5, 0.0)
    course = way(start, goal, [TABLE])
    check(course, start, goal)
    assert clearance(course, [TABLE]) > 0.0
    assert clearance(course, [TABLE], leaving=0.7) > RADIUS - 0.08


def test_who_stands_within_a_thing_leaves_it_the_short_way():
    start, goal = (-0.3, 0.1), (2.0, 0.1)
    course = way(start, goal, [TABLE])
    check(course, start, goal)
    assert course.points[:, 0].min() < -0.5  # out on the near side, then round
    assert clearance(course, [TABLE], leaving=0.9) > RADIUS - 0.08


def test_one_comes_to_stand_15_cm_from_a_table():
    start, goal = (-2.0, 0.0), (0.65, 0.2)
    course = way(start, goal, [TABLE])
    check(course, start, goal)
    assert clearance(course, [TABLE]) > 0.12
    assert clearance(course, [TABLE], leaving=0.4) > RADIUS - 0.08


@pytest.mark.parametrize(("start", "goal"), [((0.71, 0.15), (0.65, 0.41)), ((0.68, -0.12), (0.68, -0.27))])
def test_a_step_along_a_table_is_straight(start, goal):
    """It led off the table and back to it, and who went there turned about by 360 degrees within two steps."""
    course = way(start, goal, [TABLE], start_heading=np.pi)
    check(course, start, goal)
    assert np.ptp(course.heading) == 0.0
    assert clearance(course, [TABLE]) > 0.12


def test_a_step_past_the_corner_of_a_table_is_not_straight():
    start, goal = (0.63, 0.5), (0.4, 0.75)
    course = way(start, goal, [TABLE])
    assert clearance(course, [TABLE]) > 0.12
    assert np.ptp(course.heading) > 0.5


def test_other_humans_are_walked_round():
    circles = [(0.0, 0.05, 0.25), (1.2, -0.3, 0.25)]
    course = way((-2.0, 0.0), (2.5, 0.0), [], circles=circles)
    check(course, (-2.0, 0.0), (2.5, 0.0))
    for x, y, r in circles:
        assert np.linalg.norm(course.points - [x, y], axis=-1).min() > r + RADIUS - 0.08
    assert blocked(course, 0.0, course.length, circles, RADIUS - 0.08) is None


def test_where_a_course_is_first_blocked():
    course = way((0.0, 0.0), (4.0, 0.0), [])
    circles = [(3.0, 0.3, 0.2), (2.0, 0.0, 0.3)]
    assert blocked(course, 0.0, 4.0, circles, 0.2) == pytest.approx(1.5, abs=0.011)
    assert blocked(course, 2.6, 4.0, circles, 0.2) == pytest.approx(3.0 - np.sqrt(0.07), abs=0.011)
    assert blocked(course, 0.0, 1.4, circles, 0.2) is None
    assert blocked(course, 0.0, 4.0, [], 0.2) is None
    assert blocked(course, 4.0, 6.0, [(5.0, 0.0, 0.2)], 0.2) == pytest.approx(4.6, abs=0.011)


def test_where_nothing_else_fits_the_straight_legs_lose_their_corners_only():
    corner = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    points, heading = blurred(corner)
    assert (points[[0, -1]] == corner[[0, -1]]).all()
    assert np.abs(np.diff(heading)).max() < 0.6
    assert 0.01 < np.linalg.norm(points - corner[1], axis=-1).min() < SLACK / 2
    assert heading[[0, -1]] == pytest.approx([0.0, np.pi / 2], abs=1e-6)


def test_the_nearest_free_place():
    np.testing.assert_allclose(nearest_free(np.array([0.4, 0.1]), [TABLE], 0.3), [0.8, 0.1], atol=2e-3)
    np.testing.assert_allclose(nearest_free(np.array([2.0, 0.1]), [TABLE], 0.3), [2.0, 0.1])
    np.testing.assert_allclose(nearest_free(np.array([2.0, 0.1]), [], 0.3), [2.0, 0.1])


def test_rings_without_an_area_are_walked_round():
    panel = np.array([[0.0, -1.0], [0.0, 0.5]])
    course = way((-1.0, 0.0), (1.0, 0.0), [panel, np.array([[0.0, 0.4], [0.0, 0.5], [0.0, 0.5], [0.0, 0.45]])])
    check(course, (-1.0, 0.0), (1.0, 0.0))
    assert np.linalg.norm(course.points - [0.0, 0.5], axis=-1).min() > RADIUS - 0.08
    assert course.points[:, 1].max() > 0.6


@pytest.mark.parametrize("seed", range(40))
def test_any_room(seed):
    random = np.random.default_rng(seed)
    rings = [box(*random.uniform(-3, 3, 2), *random.uniform(0.2, 1.5, 2), random.uniform(0, 180)) for _ in range(9)]
    start, goal = random.uniform(-3.5, 3.5, (2, 2))
    both = shapely.points([start, goal])
    rings = [ring for ring in rings if shapely.distance(shapely.Polygon(ring), both).min() > 0.13]
    try:
        course = way(start, goal, rings)
    except NoWay:
        wide = shapely.union_all([shapely.buffer(shapely.Polygon(ring), RADIUS) for ring in rings])
        parts = shapely.get_parts(shapely.difference(shapely.box(-9, -9, 9, 9), wide))
        assert not (shapely.distance(parts[:, None], both) < 0.12).all(axis=-1).any()
        return
    check(course, start, goal)
    assert clearance(course, rings) > 0.1
    assert clearance(course, rings, leaving=1.5) > RADIUS - 0.08
