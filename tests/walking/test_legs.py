"""Legs solved onto their feet, against forward kinematics."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, norm, rotate, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.walking.legs import foot_frames, hip_joints, reach, solve_legs

HUMAN = Skeleton.of(1.68, "female")
UP, LEFT = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
FEET = [INDEX["right_foot"], INDEX["left_foot"]]
KNEES = [INDEX["right_lower_leg"], INDEX["left_lower_leg"]]


def poses(count: int, heading: float, seed: int = 1) -> tuple[Array, Array, Array, Array]:
    """Rotations (n, 43, 4), root (n, 3), ankles (n, 2, 3), feet (n, 2, 4): hips over feet that are within reach."""
    rng = np.random.default_rng(seed)
    rotations, root = HUMAN.upright()
    rotations = np.repeat(rotations[None], count, axis=0)
    tilt = multiply(
        from_axis_angle(UP, heading + rng.uniform(-0.2, 0.2, count)),
        from_axis_angle(LEFT, rng.uniform(-0.15, 0.15, count)),
    )
    rotations[:, 0] = multiply(tilt, rotations[:, 0])
    roots = np.repeat(root[None], count, axis=0)
    roots[:, 2] -= rng.uniform(0.05, 0.25, count)
    local = np.stack([rng.uniform(-0.25, 0.3, (count, 2)), rng.uniform(0.05, 0.2, (count, 2)) * [-1.0, 1.0]], axis=-1)
    turn = np.array([[np.cos(heading), np.sin(heading)], [-np.sin(heading), np.cos(heading)]])
    ankles = np.zeros((count, 2, 3))
    ankles[..., :2] = local @ turn
    ankles[..., 2] = rng.uniform(0.07, 0.2, (count, 2))
    yaw = heading + rng.uniform(-0.35, 0.35, (count, 2))
    feet = multiply(from_axis_angle(UP, yaw), from_axis_angle(LEFT, rng.uniform(-0.4, 0.8, (count, 2))))
    return rotations, roots, ankles, feet


@pytest.mark.parametrize("heading", [0.0, 2.2, -3.0])
def test_feet_are_where_they_shall_be(heading: float) -> None:
    rotations, root, ankles, feet = poses(300, heading)
    solve_legs(HUMAN, rotations, root, ankles, feet)
    np.testing.assert_allclose(norm(rotations), 1.0, atol=1e-12)
    places, world = forward(rotations, root, HUMAN.offsets)
    np.testing.assert_allclose(places[:, FEET], ankles, atol=1e-9)
    np.testing.assert_allclose(np.abs((world[:, FEET] * feet).sum(axis=-1)), 1.0, atol=1e-12)


@pytest.mark.parametrize("heading", [0.0, 2.2, -3.0])
def test_knees_are_ahead(heading: float) -> None:
    rotations, root, ankles, feet = poses(300, heading)
    solve_legs(HUMAN, rotations, root, ankles, feet)
    places, _ = forward(rotations, root, HUMAN.offsets)
    joints = hip_joints(HUMAN, rotations[:, 0], root)
    ahead = np.array([np.cos(heading), np.sin(heading), 0.0])
    line = ankles - joints
    line /= np.linalg.norm(line, axis=-1, keepdims=True)
    knee = places[:, KNEES] - joints
    off = knee - (knee * line).sum(axis=-1, keepdims=True) * line
    assert (off @ ahead).min() > 0.02


def test_hip_joints_are_those_of_kinematics() -> None:
    rotations, root, _, _ = poses(20, 0.7)
    places, _ = forward(rotations, root, HUMAN.offsets)
    np.testing.assert_allclose(
        hip_joints(HUMAN, _from_upright(rotations[:, 0]), root),
        places[:, [INDEX["right_upper_leg"], INDEX["left_upper_leg"]]], atol=0.01,
    )  # fmt: skip


def _from_upright(hips: Array) -> Array:
    """What turns the upright hips to these."""
    own, _ = HUMAN.upright()
    return multiply(hips, own[0] * [1.0, -1.0, -1.0, -1.0])


def test_foot_frames_are_those_of_kinematics() -> None:
    rotations, root, ankles, feet = poses(20, 1.0)
    solve_legs(HUMAN, rotations, root, ankles, feet)
    places, world = foot_frames(HUMAN, rotations, root)
    p, q = forward(rotations, root, HUMAN.offsets)
    np.testing.assert_allclose(places, p[:, FEET], atol=1e-12)
    np.testing.assert_allclose(world, q[:, FEET], atol=1e-12)


def test_a_leg_that_is_too_short_points_at_its_foot_and_keeps_its_length() -> None:
    rotations, root, ankles, feet = poses(10, 0.0)
    ankles[..., 2] -= 0.6
    solve_legs(HUMAN, rotations, root, ankles, feet)
    places, _ = forward(rotations, root, HUMAN.offsets)
    joints = places[:, [INDEX["right_upper_leg"], INDEX["left_upper_leg"]]]
    way, wanted = places[:, FEET] - joints, ankles - joints
    np.testing.assert_allclose(np.linalg.norm(way, axis=-1), reach(HUMAN), rtol=1e-9)
    cosine = (way * wanted).sum(axis=-1) / np.linalg.norm(way, axis=-1) / np.linalg.norm(wanted, axis=-1)
    assert cosine.min() > 1.0 - 1e-9


def test_nothing_else_is_touched() -> None:
    rotations, root, ankles, feet = poses(10, 0.0)
    before = rotations.copy()
    solve_legs(HUMAN, rotations, root, ankles, feet)
    legs = [INDEX[f"{side}_{part}"] for side in ("right", "left") for part in ("upper_leg", "lower_leg", "foot")]
    others = [i for i in range(43) if i not in legs]
    np.testing.assert_array_equal(rotations[:, others], before[:, others])


def test_the_knee_goes_with_the_foot_as_the_foot_turns() -> None:
    rotations, root, ankles, feet = poses(1, 0.0)
    sides = []
    for turn in (-0.5, 0.0, 0.5):
        q = rotations.copy()
        solve_legs(HUMAN, q, root, ankles, multiply(from_axis_angle(UP, turn), feet))
        sides.append(forward(q, root, HUMAN.offsets)[0][0, KNEES, 1])
    assert (np.diff(np.array(sides), axis=0) > 0.0).all()  # the foot turned to the left: the knee further left
    thigh = forward(rotations, root, HUMAN.offsets)[1][:, INDEX["right_upper_leg"]]
    assert rotate(thigh, np.array([1.0, 0.0, 0.0]))[0, 2] < 0.0


def turned_feet(degrees: float, knees: float = 0.06) -> Array:
    """Angles (15, 3) from upright, degrees, of who stands with both feet turned to the left against the pelvis."""
    upright, root = HUMAN.upright()
    places, world = forward(upright, root, HUMAN.offsets)
    rotations = upright[None].copy()
    turn = from_axis_angle(UP, np.radians(degrees))
    solve_legs(HUMAN, rotations, root[None] - [0.0, 0.0, knees], places[None, FEET], multiply(turn, world[None, FEET]))
    return np.degrees(to_rotation_vector(multiply(conjugate(upright), rotations[0])))[:15]


HIP, KNEE, ANKLE = (INDEX[f"left_{link}"] for link in ("upper_leg", "lower_leg", "foot"))


@pytest.mark.parametrize("degrees", [-90.0, 90.0])
def test_a_foot_turned_by_much_is_turned_in_all_joints_of_the_leg(degrees: float) -> None:
    """Their limits are 45, 10 and 25 degrees: of 90 each is beyond by about as much."""
    angles, sign = turned_feet(degrees), np.sign(degrees)
    hip, knee, ankle = -sign * angles[HIP, 0], -sign * angles[KNEE, 0], sign * angles[ANKLE, 2]
    assert 42.0 < hip < 52.0
    assert 8.0 < knee < 10.0
    assert 20.0 < ankle < 33.0


def test_a_foot_turned_by_little_leaves_the_knee_a_hinge() -> None:
    angles = turned_feet(20.0)
    assert np.abs(angles[KNEE, [0, 2]]).max() < 1e-6
    assert angles[KNEE, 1] > 10.0
    assert angles[HIP, 0] == pytest.approx(-12.3, abs=1.5)


def test_the_further_a_foot_is_turned_the_further_each_joint() -> None:
    degrees = np.arange(0.0, 121.0, 1.0)
    angles = np.array([turned_feet(float(turn)) for turn in degrees])
    for by in (-np.diff(angles[:, HIP, 0]), -np.diff(angles[:, KNEE, 0]), np.diff(angles[:, ANKLE, 2])):
        assert by.min() > -0.05
        assert by.max() < 1.2
