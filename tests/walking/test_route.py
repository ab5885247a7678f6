"""Shortest ways between a table and a chair before it: beside those over every leg that is free."""

import numpy as np
import pytest
import shapely

from ahmss.walking import route
from ahmss.walking.course import plan
from ahmss.walking.obstacles import SLOPE, Obstacles
from ahmss.walking.route import shortest

RADIUS = 0.27
TABLE = np.array(  # with round corners
    [[-0.476, -0.596], [-0.436, -0.606], [0.437, -0.606], [0.47, -0.599], [0.496, -0.576], [0.506, -0.537],
     [0.506, 0.537], [0.499, 0.57], [0.476, 0.596], [0.436, 0.606], [-0.437, 0.606], [-0.47, 0.599],
     [-0.496, 0.576], [-0.506, 0.536], [-0.506, -0.537], [-0.499, -0.57]]
)  # fmt: skip
CHAIR = np.array(
    [[-0.258, 0.162], [-0.245, 0.161], [-0.245, -0.161], [-0.258, -0.163], [-0.258, -0.197], [-0.215, -0.202],
     [-0.215, -0.215], [0.225, -0.215], [0.225, 0.215], [-0.215, 0.215], [-0.215, 0.202], [-0.258, 0.198]]
)  # fmt: skip


def moved(ring, x, y, deg):
    a = np.radians(deg)
    return ring @ np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]]) + [x, y]


@pytest.mark.parametrize(
    ("table", "chair", "start", "goal", "longest"),
    [
        ((0.70, 0.10, 73.0), (0.03, -0.71, 58.0), (-1.001, -1.064), (0.215, -0.413), 2.9),
        ((0.70, 0.10, 65.0), (1.00, 1.15, -100.0), (-0.9, 1.7), (0.939, 0.805), 3.9),
    ],
)
def test_into_a_gap_between_table_and_chair_one_goes_round_the_chair(table, chair, start, goal, longest):
    """The way led past the chair by up to a metre, turned about there by 150 degrees and came back."""
    things = [moved(TABLE, *table), moved(CHAIR, *chair)]
    union = shapely.union_all([shapely.Polygon(ring) for ring in things])
    for here, there in ((start, goal), (goal, start)):
        course = plan(np.array(here), np.array(there), things, radius=RADIUS)
        assert course.length < longest
        assert np.abs(np.diff(course.heading)).max() < 0.1  # in 2 cm
        away = shapely.distance(union, shapely.points(course.points))
        assert away.min() > 0.12
        out = np.linalg.norm(course.points - np.array(goal), axis=-1) > 0.6
        assert away[out].min() > 0.21  # it kept as near to them as in the gap, and shins went into the chair


def test_no_leg_of_a_shortest_way_is_left_out(monkeypatch):
    """Legs along short edges were: of 195 ways 15 were longer, by up to 6.6 m, or not found."""
    rng = np.random.default_rng(5)
    cases = []
    for _ in range(30):
        things = [moved(TABLE, 0.7, 0.1, rng.uniform(0, 360)), moved(CHAIR, *rng.uniform(-0.8, 0.3, 2), 58.0)]
        around = Obstacles.of(things, RADIUS)
        goal, start = rng.uniform(-1.0, 1.0, 2), around.nearest_free(rng.uniform(-2.0, 2.0, 2))
        floor = around.blocked(around.ends(start, goal, SLOPE / 4.0))
        cases.append((start, goal, floor, shortest(start, goal, floor)))
    monkeypatch.setattr(route, "_passes", lambda _places, _corners, at, _to: np.ones(len(at), dtype=bool))
    ways = 0
    for start, goal, floor, found in cases:
        over_all = shortest(start, goal, floor)
        assert (found is None) == (over_all is None)
        if over_all is not None:
            assert shapely.LineString(found).length < shapely.LineString(over_all).length + 0.002
            ways += 1
    assert ways > 10
