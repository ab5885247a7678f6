"""hold_arm keeps what is in the hand level; hands that swing are drawn in beside things."""

from __future__ import annotations

import itertools

import msgspec
import numpy as np

from ahmss.algorithm import Transform, frames
from ahmss.algorithm.task import HumanTask
from ahmss.algorithm.tucking import Tucking
from ahmss.body.inverse import grips
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, rotate

from .reached import outlined
from .scene import CUP, Body, frame_of, program, record

UP = np.array([0.0, 0.0, 1.0])
SINK = "room/sink"


def test_what_is_held_comes_upright_and_stays_so_without_end() -> None:
    body = Body()
    leant = from_axis_angle(np.array([1.0, 0.0, 0.0]), 0.35)
    cup = Transform(body.grip().place, multiply(leant, frame_of(CUP).rotation))
    start = body.start(CUP, "carry", frames=0, wish=True, parameters={"level": True}, hand="right")
    start = msgspec.structs.replace(start, object=record(CUP, cup))
    hand = INDEX["right_hand"]
    _, world = forward(body.rotations, body.root, body.skeleton.offsets)
    in_hand = rotate(conjugate(world[hand]), rotate(cup.rotation, UP))
    poses = list(itertools.islice(frames(program("hold_arm"), start), 90))
    assert len(poses) == 90
    heights = [
        rotate(multiply(world[INDEX["right_lower_arm"]], pose.rotations[hand]), in_hand)[2]
        for pose in (poses[0], poses[-1])
    ]
    assert heights[0] < np.cos(0.33)  # it begins as it was
    assert heights[1] > np.cos(np.radians(2.0))
    assert poses[-1].importance[hand] == 1.0
    assert poses[-1].importance[INDEX["left_hand"]] == 0.0


def walked(place: np.ndarray, hand: str = "") -> np.ndarray:
    """Rows (60, 260) of one who stands at a place beside the sink and faces along it, arms hanging."""
    body = Body(x=float(place[0]), y=float(place[1]), facing=90.0)
    start = body.start(CUP, "carry", frames=0, wish=True, parameters={})
    busy = {"busy": [hand]} if hand else {}
    start = msgspec.structs.replace(start, object=None, world=[outlined(record(SINK), 11)], **busy)
    task = HumanTask(start)
    rows = task.block(
        np.repeat(body.rotations[None], 60, axis=0), np.repeat(body.root[None], 60, axis=0), np.full(44, 0.15)
    )
    return Tucking(task).over(rows)


def palms(rows: np.ndarray) -> np.ndarray:
    return grips(Body().skeleton, rows[:, 4:176].reshape(-1, 43, 4), rows[:, 1:4])[..., :3]


def test_a_hand_that_hangs_in_a_counter_comes_up_and_the_other_does_not() -> None:
    at = palms(walked(np.array([2.86, 0.25, 0.0])))
    right, left = at[:, 0], at[:, 1]
    assert right[-1, 2] > right[0, 2] + 0.2
    assert right[-1, 0] < 2.86 + 0.2  # before the belly, off the counter
    assert np.abs(np.diff(right, n=2, axis=0)).max() < 0.003  # softly
    np.testing.assert_allclose(left[-1], left[0], atol=1e-9)


def test_where_there_is_room_hands_hang_and_a_hand_that_holds_something_is_left_alone() -> None:
    for at in (palms(walked(np.array([2.0, 1.2, 0.0]))), palms(walked(np.array([2.86, 0.25, 0.0]), "right"))):
        np.testing.assert_allclose(at[-1], at[0], atol=1e-9)
