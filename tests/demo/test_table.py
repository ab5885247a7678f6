"""No step of the recorded demo jumps, hands meet things, feet stand: against what real capture measures."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.inverse import RIGHT_HAND
from ahmss.body.links import INDEX, LINKS
from ahmss.body.quaternion import conjugate, multiply, rotate, to_rotation_vector
from ahmss.motion.contact import foot_points
from ahmss.motion.smoothness import joint_motion, worst_pop
from ahmss.skills.staging import lips

from .conftest import CUP
from .recorded import Recorded

pytestmark = pytest.mark.timeout(180)  # the first test plays the demo

RADIUS, HEIGHT = 0.036, 0.095  # of the cup
LEVER = 0.011
MOST_ACCELERATION, P99_ACCELERATION = 382.0, 213.0  # rad/s2, straight walks of real capture


def held(demo: Recorded) -> np.ndarray:
    """The frames in which the cup is in the hand: from the first to the last in which it moves."""
    moved = np.flatnonzero(np.linalg.norm(np.diff(demo.objects[CUP][:, :3], axis=0), axis=1) > 1e-6)
    return np.arange(moved[0] + 1, moved[-1] + 2)


def test_joints_accelerate_no_more_than_in_real_capture(demo: Recorded) -> None:
    joints = joint_motion(demo.rotations, demo.rate)
    assert 20.0 < joints.acceleration_max <= MOST_ACCELERATION, LINKS[joints.joint]
    assert joints.acceleration_p99 <= P99_ACCELERATION


def test_no_joint_pops(demo: Recorded) -> None:
    pop = worst_pop(demo.rotations)
    assert pop.degrees <= 1.5, pop


def test_the_root_does_not_jump(demo: Recorded) -> None:
    steps = np.diff(demo.root, axis=0)
    assert np.linalg.norm(steps[1:] - steps[:-1], axis=1).max() < 0.001


def test_the_feet_stay_where_they_stand(demo: Recorded) -> None:
    points = foot_points(demo.skeleton, demo.rotations, demo.root)
    assert np.ptp(points, axis=0).max() < 0.003
    assert points[..., 2].min() > -0.003


def test_the_weight_stays_over_the_feet(demo: Recorded) -> None:
    places, turned = demo.links
    middles = places + rotate(turned, 0.5 * demo.skeleton.tips)
    centre = np.einsum("l,flc->fc", demo.skeleton.mass / demo.skeleton.mass.sum(), middles)[:, :2]
    feet = foot_points(demo.skeleton, demo.rotations, demo.root)[0, ..., :2].reshape(-1, 2)
    ahead = rotate(demo.rotations[0, 0], np.array([0.0, 0.0, -1.0]))[:2]
    aside = np.array([-ahead[1], ahead[0]])
    for axis in (ahead, aside):
        assert (centre @ axis).min() > (feet @ axis).min()
        assert (centre @ axis).max() < (feet @ axis).max()


def test_the_cup_keeps_its_pose_in_the_palm(demo: Recorded) -> None:
    frames = held(demo)
    in_palm = demo.grip(RIGHT_HAND).inverse().then(demo.object(CUP)).row()[frames]
    assert len(frames) > 240
    assert np.ptp(in_palm[:, :3], axis=0).max() < 0.002
    assert np.degrees(np.abs(to_rotation_vector(multiply(conjugate(in_palm[:1, 3:]), in_palm[:, 3:])))).max() < 0.5


def test_the_cup_does_not_jump_when_it_is_caught_or_let_go(demo: Recorded) -> None:
    steps = np.diff(demo.objects[CUP][:, :3], axis=0)
    assert np.linalg.norm(steps[1:] - steps[:-1], axis=1).max() < 0.002


def test_the_cup_is_claimed_while_it_is_held_and_free_after(demo: Recorded) -> None:
    holders = demo.holders[CUP]
    assert {holders[i] for i in held(demo)} == {"ken"}
    assert holders[0] == holders[-1] == ""


def test_the_cup_is_put_back_upright_where_it_was(demo: Recorded) -> None:
    cup = demo.object(CUP)
    assert np.linalg.norm(cup.place[-1] - cup.place[0]) < 0.002
    assert rotate(cup.rotation[-1], np.array([0.0, 0.0, 1.0]))[2] > 0.9999


def test_the_thumb_is_on_the_other_side_of_the_cup(demo: Recorded) -> None:
    frame = int(held(demo)[0])
    places, _ = demo.links
    axis = demo.object(CUP).place[frame]
    thumb = places[frame, INDEX["right_thumb_distal"]] - axis
    index = places[frame, INDEX["right_index_distal"]] - axis
    assert thumb[:2] @ index[:2] < 0.0


def test_it_drinks(demo: Recorded) -> None:
    places, turned = demo.links
    head = INDEX["head"]
    mouth = places[:, head] + rotate(turned[:, head], lips(demo.skeleton))
    around = np.radians(np.arange(0.0, 360.0, 3.0))
    rim = np.stack([RADIUS * np.cos(around), RADIUS * np.sin(around), np.full(len(around), HEIGHT)], axis=-1)
    cup = demo.objects[CUP]
    edge = cup[:, None, :3] + rotate(cup[:, None, 3:], rim[None])
    near = np.linalg.norm(edge - mouth[:, None], axis=-1).min(axis=1)
    tilt = np.degrees(np.arccos(np.clip(rotate(cup[:, 3:], np.array([0.0, 0.0, 1.0]))[:, 2], -1.0, 1.0)))
    sipping = near < 0.008
    assert 1.0 < sipping.sum() / demo.rate < 2.2
    assert 40.0 < tilt[sipping].max() < 75.0
    elbow, raised, wrist = (angle[sipping] for angle in demo.arm(0))
    assert 120.0 < elbow.min() <= elbow.max() < 138.0
    assert 45.0 < raised.min() <= raised.max() < 77.0
    assert 5.0 < wrist.max() < 37.0


def test_the_head_turns_to_the_television_while_the_hand_reaches(demo: Recorded) -> None:
    _, turned = demo.links
    head = INDEX["head"]
    gaze = rotate(turned[:, head], np.array([0.0, 0.0, -1.0]))[:, :2]
    yaw = np.degrees(np.arctan2(gaze[:, 1], gaze[:, 0]))
    speed = np.linalg.norm(np.diff(demo.grip(RIGHT_HAND).place, axis=0), axis=1) * demo.rate
    before = slice(0, int(held(demo)[0]))
    moving = np.flatnonzero(speed[before] > 0.3)
    assert len(moving) > 15
    assert yaw[moving[-1]] - yaw[0] > 25.0  # to the left, the hand still on its way


def test_hands_move_at_the_speed_of_hands(demo: Recorded) -> None:
    speed = np.linalg.norm(np.diff(demo.grip(RIGHT_HAND).place, axis=0), axis=1) * demo.rate
    reach = speed[: int(held(demo)[0])]
    duration = np.flatnonzero(reach > 0.03)
    assert 0.5 < reach.max() < 1.1
    assert 0.7 < (duration[-1] - duration[0]) / demo.rate < 1.7  # reach and grasp
    assert speed.max() < 1.2
