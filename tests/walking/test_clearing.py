"""Legs keep out of things beside which one turns, sets out or arrives, and feet that stand stay where they are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
import shapely

from ahmss.body.array import Array
from ahmss.body.inverse import grips, solve
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.motion.contact import foot_points
from ahmss.walking.fence import Fence
from ahmss.walking.leeway import Leeway
from ahmss.walking.library import BODY
from ahmss.walking.trip import Ground, Trip

from . import measures as m

TABLE = np.array([[0.27, -0.6], [1.27, -0.6], [1.27, 0.6], [0.27, 0.6]])  # its edge is before who stands at the origin
FAR = TABLE + np.array([0.0, 4.0])
CHAIR = np.array([
    [2.388, 0.037], [2.375, 0.039], [2.375, 0.361], [2.388, 0.362], [2.388, 0.397], [2.345, 0.402], [2.345, 0.415],
    [1.905, 0.415], [1.905, -0.015], [2.345, -0.015], [2.345, -0.002], [2.388, 0.002],
])  # fmt: skip
BEFORE_IT = np.array([
    [0.788, -0.562], [0.825, -0.545], [1.494, 0.016], [1.515, 0.043], [1.52, 0.077], [1.503, 0.114], [0.813, 0.936],
    [0.786, 0.957], [0.752, 0.962], [0.715, 0.945], [0.046, 0.384], [0.025, 0.357], [0.02, 0.323], [0.037, 0.286],
    [0.727, -0.536], [0.754, -0.557],
])  # fmt: skip
BEYOND = np.array([
    [2.015, 2.028], [1.675, 1.799], [1.684, 1.786], [1.679, 1.783], [2.204, 1.004], [2.209, 1.007], [2.218, 0.994],
    [2.558, 1.224],
])  # fmt: skip
_LEFT_ARM = [INDEX[f"left_{link}"] for link in ("upper_arm", "lower_arm", "hand")]
GOALS = [
    (-0.2, 1.8, 90.0), (1.9, 0.2, 0.0), (-1.5, -0.3, 180.0), (-0.3, -2.0, -60.0), (0.0, 0.0, 120.0), (0.1, 1.8, -90.0),
]  # fmt: skip


def walked(
    outlines: list[Array], goal: tuple[float, float, float], name: str = "ken", tops: Sequence[float] = (),
    start: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> tuple[Array, Array]:  # fmt: skip
    """Rotations (F, 43, 4) and root (F, 3) from a place and heading to another, in metres and degrees."""
    body = m.subject(name)
    trip = Trip(body.skeleton, m.library(), Ground(outlines, tops=tops), np.array(goal[:2]), float(np.radians(goal[2])))
    pieces = list(trip.pieces(*body.at(start[:2], start[2])))
    rotations = np.concatenate([piece.rotations for piece in pieces])
    whole = np.repeat(body.rotations[None], len(rotations), axis=0)
    whole[:, :BODY] = rotations
    return whole, np.concatenate([piece.root for piece in pieces])


def nearest(name: str, rotations: Array, root: Array, outline: Array) -> float:
    """How near knees, ankles and tips of the toes come to an outline; negative within it."""
    skeleton = m.subject(name).skeleton
    places, _ = forward(rotations, root, skeleton.offsets)
    joints = [INDEX[f"{side}_{link}"] for side in ("right", "left") for link in ("lower_leg", "foot")]
    feet = foot_points(skeleton, rotations, root).reshape(len(root), -1, 3)
    points = shapely.points(np.concatenate([places[:, joints], feet], axis=1)[..., :2])
    thing = shapely.Polygon(outline)
    away = np.where(shapely.within(points, thing), -1.0, 1.0) * shapely.distance(shapely.boundary(thing), points)
    return float(away.min())


@pytest.mark.parametrize("name", ["ken", "aiko"])
@pytest.mark.parametrize("goal", GOALS)
def test_legs_keep_out_of_a_table_beside_which_one_turns(name: str, goal: tuple[float, float, float]) -> None:
    assert nearest(name, *walked([TABLE], goal, name), TABLE) > 0.0


@pytest.mark.parametrize(("name", "foot"), [("ken", 90.0), ("aiko", -90.0)])
def test_who_sets_out_beside_a_table_shifts_no_weight_into_it(name: str, foot: float) -> None:
    rotations, root = walked([TABLE], (-1.5, -0.3, 180.0), name, start=(0.07, 0.0, foot))
    skeleton = m.subject(name).skeleton
    places, _ = forward(rotations, root, skeleton.offsets)
    hips = places[:, [INDEX["right_upper_leg"], INDEX["left_upper_leg"]]]
    assert (TABLE[0, 0] - hips[..., 0]).min() > 0.105, "metres: a thigh is so thick"


@pytest.mark.parametrize("name", ["ken", "aiko"])
@pytest.mark.parametrize(
    ("other", "top", "start", "goal"),
    [
        (BEFORE_IT, 0.88, (0.3, 1.6, 151.71), (1.78, 0.2, 180.0)),  # a table's corner, 0.39 m from the seat
        (BEYOND, 1.11, (2.78, 0.25, 0.0), (1.51967, 1.10856, 34.0)),  # past the back, a television on the other side
    ],
)
def test_who_is_moved_off_one_thing_is_not_in_the_next(
    name: str, other: Array, top: float, start: tuple[float, float, float], goal: tuple[float, float, float]
) -> None:
    made = walked([CHAIR, other], goal, name, [0.86, top], start)
    assert nearest(name, *made, CHAIR) > 0.02, "metres: a heel is as thick, and all else more"
    assert nearest(name, *made, other) > 0.02


def test_some_of_these_legs_would_be_in_it() -> None:
    body = m.subject("ken")
    lacks = []
    for goal in GOALS:
        trip = Trip(body.skeleton, m.library(), Ground([TABLE]), np.array(goal[:2]), float(np.radians(goal[2])))
        rotations, root = body.at((0.0, 0.0), 0.0)
        now = m.footing(body.skeleton, rotations, root, body.standing)
        going = trip.planner.walk(now).shaped
        whole = np.repeat(body.rotations[None], len(going.root), axis=0)
        whole[:, :BODY] = going.rotations
        lacks.append(nearest("ken", whole, going.root, TABLE))
    assert min(lacks) < -0.05


def test_what_is_far_changes_nothing() -> None:
    goal = (-1.5, -0.3, 180.0)
    one, other = walked([], goal), walked([FAR], goal)
    assert np.array_equal(one[0], other[0])
    assert np.array_equal(one[1], other[1])


@pytest.mark.parametrize("goal", GOALS)
def test_a_foot_that_bears_stays_and_the_body_moves_smoothly(goal: tuple[float, float, float]) -> None:
    rotations, root = walked([TABLE], goal)
    points = foot_points(m.subject("ken").skeleton, rotations, root).reshape(len(root), -1, 3)
    moved = np.linalg.norm(np.diff(points[..., :2], axis=0), axis=-1)
    low = np.maximum(points[1:, :, 2], points[:-1, :, 2]) < 0.002
    assert moved[low].max() < 0.0005
    assert np.linalg.norm(np.diff(root, 2, axis=0), axis=-1).max() * 60.0**2 < 20.0
    assert np.allclose(root[-1, :2], goal[:2], atol=1e-4)


def test_a_foot_goes_with_the_body_but_where_it_stands_first_and_last() -> None:
    bears = np.array([True] * 10 + [False] * 9 + [True] * 11 + [False] * 9 + [True] * 10)
    body = np.zeros((len(bears), 2))
    body[5:45] = [0.1, -0.2]
    own = np.array([[0.0, 0.05], [0.0, 0.0]])
    foot = Leeway(body, (own, np.zeros((2, 2)))).foot(bears, 0)
    assert not foot[:10].any()
    assert not foot[-10:].any()
    assert np.allclose(foot[19:30], [0.1, -0.2])
    assert np.allclose(foot[14], [0.1, -0.15])  # half-way, and its own
    assert np.linalg.norm(np.diff(foot, axis=0), axis=-1).max() < 0.07


def test_how_deep_points_are_in_outlines() -> None:
    rings = [
        np.array([[0, 0], [1, 0], [1, 1], [0.5, 0.4], [0, 1]], float),
        np.array([[2, 0], [2, 1], [3, 1], [3, 0]], float),
    ]
    points = np.random.default_rng(1).uniform(-0.5, 3.5, (300, 2))
    away, out = Fence(rings, 9.0).away(points)
    shapes, places = [shapely.Polygon(ring) for ring in rings], shapely.points(points)
    sides = [np.where(shapely.within(places, shape), -1.0, 1.0) for shape in shapes]
    true = [side * shapely.distance(shapely.boundary(shape), places) for side, shape in zip(sides, shapes, strict=True)]
    assert np.allclose(away, np.min(true, axis=0))
    further, _ = Fence(rings, 9.0).away(points + 1e-6 * out)
    assert np.allclose((further - away) / 1e-6, 1.0, atol=1e-4)
    assert Fence(rings, 0.1).away(np.array([[-5.0, 0.0]]))[0] == 0.1


def test_what_is_over_a_thing_is_not_in_it() -> None:
    fence, inside = Fence([TABLE], 0.3, [0.88]), np.array([[0.4, 0.0], [0.4, 0.0]])
    assert np.allclose(fence.away(inside, np.array([0.87, 0.89]))[0], [-0.13, 0.3])


def test_elbows_keep_out_of_what_is_as_high() -> None:
    thing, goal = np.array([[0.8, 0.275], [2.0, 0.275], [2.0, 0.9], [0.8, 0.9]]), (3.5, 0.0, 0.0)

    def nearest_elbow(top: float) -> float:
        places, _ = forward(*walked([thing], goal, tops=[top]), m.subject("ken").skeleton.offsets)
        elbows = places[:, [INDEX["right_lower_arm"], INDEX["left_lower_arm"]], :2]
        polygon, points = shapely.Polygon(thing), shapely.points(elbows)
        sign = np.where(shapely.within(points, polygon), -1.0, 1.0)
        return float((sign * shapely.distance(shapely.boundary(polygon), points)).min())

    assert nearest_elbow(1.2) > 0.055
    assert nearest_elbow(0.5) < 0.04


def test_a_hand_that_holds_something_is_kept_out_of_a_table_as_high_as_it_is() -> None:
    body, table = m.subject("ken"), TABLE + np.array([0.18, 0.0])
    rotations, root = body.at((0.0, 0.0), 0.0)
    targets = np.zeros((5, 8))
    targets[1, :7], targets[1, 7] = [0.40, 0.15, 0.85, *grips(body.skeleton, rotations, root)[1, 3:]], 1.0
    rotations = solve(body.skeleton, rotations, root, targets)
    hand = INDEX["left_hand"]

    def nearest_to_table(held: tuple[str, ...]) -> float:
        trip = Trip(
            body.skeleton, m.library(), Ground([table], tops=[0.88]), np.array([-0.3, -1.6]), -np.pi / 2.0, held=held
        )
        pieces = list(trip.pieces(rotations, root))
        whole = np.repeat(rotations[None], sum(len(piece.root) for piece in pieces), axis=0)
        own = whole[:, _LEFT_ARM].copy()
        whole[:, :BODY] = np.concatenate([piece.rotations for piece in pieces])
        whole[:, _LEFT_ARM] = own
        places, _ = forward(whole, np.concatenate([piece.root for piece in pieces]), body.skeleton.offsets)
        return float((0.45 - places[50:, hand, 0]).min())

    assert nearest_to_table(("left",)) > nearest_to_table(()) + 0.02
