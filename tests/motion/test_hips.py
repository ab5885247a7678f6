"""The hips from what stands: the thesis's five steps by hand, and what lies beyond them."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, from_rotation_vector, multiply
from ahmss.body.skeleton import Skeleton
from ahmss.motion.contact import foot_points
from ahmss.motion.hips import from_lowest_part, from_standing_parts
from ahmss.motion.hips_online import HipsOnline

WALKER = Skeleton.of(1.70, "female")
RATE = 60.0
RIGHT_HEEL, RIGHT_TOE, LEFT_HEEL, LEFT_TOE = 0, 2, 3, 5


def legs(right: float, left: float, *, right_knee: float = 0.0, left_knee: float = 0.0):
    """Upright, the legs swung forward and the knees bent by so many degrees, the soles level."""
    rotations, _ = WALKER.upright()
    turns = {
        "right_upper_leg": -right, "right_lower_leg": right_knee, "right_foot": right - right_knee,
        "left_upper_leg": -left, "left_lower_leg": left_knee, "left_foot": left - left_knee,
    }  # fmt: skip
    for name, degrees in turns.items():
        turn = from_rotation_vector(np.radians([0.0, degrees, 0.0]))
        rotations[INDEX[name]] = multiply(rotations[INDEX[name]], turn)
    return rotations


def stiff_walk(steps: int = 4, frames: int = 36):
    """A straight leg carries the body over, while the other swings past it with a bent knee."""
    poses = []
    for k in range(steps * frames):
        share = (k % frames) / frames
        swing, knee = 20.0 * np.cos(np.pi * share), 60.0 * np.sin(np.pi * share)
        if (k // frames) % 2:
            poses.append(legs(-swing + knee / 2.0, swing, right_knee=knee))
        else:
            poses.append(legs(swing, -swing + knee / 2.0, left_knee=knee))
    return np.array(poses)


def test_the_five_steps_by_hand():
    poses = np.array([legs(20.0, 0.0), legs(15.0, 5.0), legs(0.0, 20.0)])
    parts = foot_points(WALKER, poses, np.zeros((3, 3))).reshape(3, 6, 3)
    start = np.array([1.0, 2.0, 0.0])
    root, stands = from_lowest_part(WALKER, poses, start)
    first, second, third = parts[..., 2].argmin(axis=1)  # step 1
    np.testing.assert_array_equal(stands, [first, second, third])
    assert first in range(3, 6)  # the left leg hangs down
    assert third in range(3)  # then the right one
    np.testing.assert_allclose(root[0], start - parts[0, first], atol=1e-12)  # steps 2 and 3
    ground = start + (parts[1, second] - parts[1, first])  # steps 4 and 5
    np.testing.assert_allclose(root[1], ground - parts[1, second], atol=1e-12)
    ground = ground + (parts[2, third] - parts[2, second])
    np.testing.assert_allclose(root[2], ground - parts[2, third], atol=1e-12)


def test_the_part_that_stands_stays_where_it_is():
    poses = stiff_walk()
    root, stands = from_lowest_part(WALKER, poses)
    points = foot_points(WALKER, poses, root).reshape(len(poses), 6, 3)
    for k in range(1, len(poses)):  # also the one that stood before: it is left where it stood
        np.testing.assert_allclose(points[k, stands[k - 1]], points[k - 1, stands[k - 1]], atol=1e-12)
    assert len({part // 3 for part in stands}) == 2
    assert root[-1, 0] - root[0, 0] > 1.0


def test_beyond_it_the_hips_do_not_jerk_and_go_as_far():
    poses = stiff_walk()
    literal, _ = from_lowest_part(WALKER, poses)
    root = from_standing_parts(WALKER, poses, RATE)
    heights = foot_points(WALKER, poses, root)[..., :2, 2].min(axis=(1, 2))
    assert np.abs(heights).max() < 0.015
    jerks = [np.abs(np.diff(way[:, 0], n=2)).max() * RATE**2 for way in (literal, root)]
    assert jerks[1] < 0.7 * jerks[0]
    assert root[-1, 0] - root[0, 0] == pytest.approx(literal[-1, 0] - literal[0, 0], rel=0.15)
    assert np.abs(root[:, 1]).max() < 0.01


def test_who_turns_on_the_spot_and_sways_stays_there():
    standing, _ = WALKER.upright()
    time = np.arange(600) / RATE
    poses = np.tile(standing, (600, 1, 1))
    sway = 0.03 * np.sin(2.0 * np.pi * 0.3 * time)
    for link, sign in (("hips", 1.0), ("right_upper_leg", -1.0), ("left_upper_leg", -1.0)):
        turn = from_rotation_vector(sign * sway[:, None] * np.array([0.0, 1.0, 0.0]))
        poses[:, INDEX[link]] = multiply(poses[:, INDEX[link]], turn)
    root = from_standing_parts(WALKER, poses, RATE)
    points = foot_points(WALKER, poses, root)
    assert np.linalg.norm(points - points[0], axis=-1).max() < 0.002


def test_jitter_does_not_carry_the_hips_away():
    generator = np.random.default_rng(1)
    standing, _ = WALKER.upright()
    shake = from_rotation_vector(generator.normal(0.0, np.radians(0.1), (600, 43, 3)))
    root = from_standing_parts(WALKER, multiply(standing, shake), RATE)
    assert np.linalg.norm(root - root[0], axis=-1).max() < 0.02


def test_the_heading_of_the_motion_is_that_of_its_hips():
    poses = stiff_walk()
    turned = poses.copy()
    turned[:, 0] = multiply(from_axis_angle(np.array([0.0, 0.0, 1.0]), np.array(np.pi / 2)), poses[:, 0])
    straight, aside = from_standing_parts(WALKER, poses, RATE), from_standing_parts(WALKER, turned, RATE)
    np.testing.assert_allclose(aside[:, 1], straight[:, 0], atol=1e-9)


def test_one_frame_alone_stands_on_the_floor():
    root = from_standing_parts(WALKER, legs(0.0, 0.0)[None], RATE)
    np.testing.assert_allclose(root[0], WALKER.upright()[1], atol=1e-9)


def test_online_goes_the_same_way_without_knowing_the_future():
    poses = stiff_walk(6)
    hips = HipsOnline(WALKER, RATE, np.array([1.0, -1.0]))
    out = [hips.step(pose) for pose in poses]
    root = np.array([place for _, place in out])
    offline = from_standing_parts(WALKER, poses, RATE)
    np.testing.assert_allclose(root[0, :2], [1.0, -1.0])
    assert root[-1, 0] - 1.0 == pytest.approx(offline[-1, 0], rel=0.1)
    assert np.abs(root[:, 2] - offline[:, 2]).max() < 0.02
    rotations = np.array([rotation for rotation, _ in out])
    assert foot_points(WALKER, rotations, root)[..., 2].min() > -0.003


def test_online_a_lost_frame_costs_no_way():
    poses = stiff_walk(4)
    whole, broken = HipsOnline(WALKER, RATE, np.zeros(2)), HipsOnline(WALKER, RATE, np.zeros(2))
    for k, pose in enumerate(poses):
        _, meant = whole.step(pose)
        if k % 10 != 5:
            _, found = broken.step(pose, 2 if k % 10 == 6 else 1)
    np.testing.assert_allclose(found, meant, atol=0.01)
