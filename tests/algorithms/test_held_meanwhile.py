"""What a hand holds while the other one works, or the trunk bends: it stays upright, and where it was."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ahmss.algorithm import HumanPose, HumanTask, Transform
from ahmss.algorithm.messages import Goal, ObjectRecord
from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import IDENTITY, conjugate, multiply, rotate, to_rotation_vector
from ahmss.reaching.prism import clearance
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.skin import hand_skin
from ahmss.skills.reaching import prisms_of

from .devices import UP, at, begun, device, posed
from .scene import CUP, Body
from .test_keeping import holding, numbered

MOST = 15.0  # degrees, that a cup leans


def cup_in(body: Body, side: str) -> ObjectRecord:
    """A cup, upright, in a hand."""
    return numbered(device("cup", Transform(body.grip(int(side == "left")).place, IDENTITY)), 21)


def leaning(body: Body, before: Array, shown: list[HumanPose], side: str) -> Array:
    """How far (F) what was upright in a hand leans, degrees; before (4,): the hand, in the world, as it held it."""
    turned = posed(body, shown)[1][:, INDEX[f"{side}_hand"]]
    up = rotate(turned, rotate(conjugate(before), UP))
    return np.degrees(np.arccos(np.clip(up[:, 2], -1.0, 1.0)))


def hand_of(body: Body, side: str) -> Array:
    return posed(body, [HumanPose(body.rotations, body.root, np.zeros(44), np.zeros((5, 8)))])[1][
        0, INDEX[f"{side}_hand"]
    ]


def fastest(shown: list[HumanPose]) -> float:
    """Of the arms' joints, degrees a frame."""
    rotations = np.array([pose.rotations for pose in shown])[:, 3:9]
    steps = to_rotation_vector(multiply(conjugate(rotations[:-1]), rotations[1:]))
    return float(np.degrees(np.linalg.norm(steps, axis=-1)).max())


@pytest.mark.parametrize("name", ["ken", "aiko"])
@pytest.mark.parametrize("side", ["right", "left"])
def test_a_lift_leaves_what_the_other_hand_holds(name: str, side: str) -> None:
    """It hung down at the side, the cup in it on its side; on the way through what it was over."""
    body, other = holding(name, side, (0.0, 0.0, 0.0)), {"right": "left", "left": "right"}[side]
    held, before, was = cup_in(body, side), hand_of(body, side), body.grip(int(side == "left")).place
    lifted = Transform(body.grip(int(other == "left")).place, IDENTITY)
    given: dict[str, Any] = {"world": [held], "busy": ["right", "left"], "held": {side: 21, other: 3}}
    shown = body.do("slerp", body.start(CUP, "lift", frame=lifted, hand=other, **given))
    assert leaning(body, before, shown, side).max() < MOST
    assert body.grip(int(side == "left")).place[2] > was[2] - 0.05


@pytest.mark.parametrize("name", ["ken", "aiko"])
def test_who_bows_spills_nothing(name: str) -> None:
    body = holding(name, "right", (0.0, 0.0, 0.0))
    held, before = cup_in(body, "right"), hand_of(body, "right")
    told = begun(body, None, "", {"which": "bow", "degrees": 45.0}, world=[held], busy=["right"], held={"right": 21})
    shown = body.do("gesture", told)
    assert leaning(body, before, shown, "right").max() < MOST
    assert fastest(shown) < 4.0


@pytest.mark.parametrize("name", ["ken", "aiko"])
def test_who_leans_to_reach_spills_nothing(name: str) -> None:
    body = holding(name, "right", (0.0, 0.0, 0.0))
    held, before = cup_in(body, "right"), hand_of(body, "right")
    given: dict[str, Any] = {"world": [held], "busy": ["right"], "held": {"right": 21}}
    shown = body.do("reach", begun(body, None, "", {}, goal=Goal(place=(0.75, 0.15, 0.55)), hand="left", **given))
    trunk = posed(body, shown)[1][:, INDEX["spine"]]
    leans = to_rotation_vector(multiply(conjugate(trunk[:1]), trunk))
    assert np.degrees(np.linalg.norm(leans, axis=-1)).max() > MOST + 5.0
    assert leaning(body, before, shown, "right").max() < MOST


@pytest.mark.parametrize(("name", "x", "y"), [("ken", 0.72, 0.0), ("aiko", 0.72, 0.0), ("aiko", 0.8, 0.2)])
def test_a_table_is_pointed_at_from_over_it(name: str, x: float, y: float) -> None:
    """The hand was in its top: where it stands is farther down the line of sight."""
    table, body = numbered(device("table", at(0.0, 0.0, 0.0)), 20), Body(name, x, y, 180.0)
    shown = body.do("point", begun(body, None, "", {}, world=[table], goal=Goal(place=(0.0, 0.0, 0.0))))
    assert sunk(body, shown, table) < 0.002


def sunk(body: Body, shown: list[HumanPose], table: ObjectRecord) -> float:
    """How deep skin of hands is in a table at some frame, metres."""
    rotations, root = np.array([pose.rotations for pose in shown]), np.array([pose.root for pose in shown])
    things, deepest = prisms_of(HumanTask(begun(body, None, "", {}, world=[table]))), -np.inf
    for side in ("right", "left"):
        points, radii = hand_skin(Reacher.of(body.skeleton, side), rotations, root)
        deepest = max(deepest, float((radii - clearance(things, points)).max()))
    return deepest
