"""kept_clear: what a hand holds, and its arm, keep out of a panel while the other hand is at work there."""

from __future__ import annotations

import itertools

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import HumanPose, HumanTask, Transform
from ahmss.algorithm.messages import Goal, ObjectRecord
from ahmss.algorithm.place import WorldObject
from ahmss.body.array import Array
from ahmss.body.inverse import grips, solve
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import conjugate, from_axis_angle, from_matrix, multiply, rotate, to_rotation_vector
from ahmss.reaching.moved_hand import with_hand_moved
from ahmss.reaching.reacher import Reacher
from ahmss.skills.box import filled
from ahmss.skills.giving_way import points_of

from .devices import at, begun, device, posed
from .scene import WORKSPACE, Body, program

PANEL = at(1.5, 0.0, 0.0, np.pi)
BUTTON = WORKSPACE.objects.get("panel").contains[6]
WALKS = str(WORKSPACE.objects.get("latching_button").affordances["press"].motion)
IN_PALM = Transform(np.array([0.02, 0.0, 0.0]), np.array([1.0, 0.0, 0.0, 0.0]))


def numbered(thing: ObjectRecord, number: int) -> ObjectRecord:
    return msgspec.structs.replace(thing, id=number, footprint=[] if number == 21 else thing.footprint)


def holding(name: str, side: str, at: tuple[float, float, float]) -> Body:
    """Somebody who stands somewhere, facing so many degrees, with a forearm before the belly."""
    body = Body(name, *at)
    for link, turn in ((f"{side}_lower_arm", 1.1), (f"{side}_upper_arm", 0.2)):
        bent = from_axis_angle(np.array([0.0, 1.0, 0.0]), turn)
        body.rotations[INDEX[link]] = multiply(body.rotations[INDEX[link]], bent)
    reacher = Reacher.of(body.skeleton, side)  # the elbow where it is by itself
    body.rotations[reacher.links] = with_hand_moved(reacher, body.rotations, body.root, np.zeros(3))
    return body


def pressed(name: str, held: dict[str, int]) -> tuple[Body, list[HumanPose], HumanTask]:
    """Somebody with a manual before the belly goes to a panel and presses a button with the other hand."""
    body = holding(name, "right", (0.5, -0.6, 0.0))
    button = device(BUTTON.kind, PANEL.then(Transform(np.array(BUTTON.position), np.array(BUTTON.rotation))))
    manual = device("manual", body.grip().then(IN_PALM))
    world = [numbered(device("panel", PANEL), 20), numbered(manual, 21)]
    start = begun(body, button, "face", {}, motion=WALKS, world=world, busy=["right"], held=held)
    task = HumanTask(start)
    return body, body.do(program("press"), start), task


def depth(body: Body, shown: list[HumanPose], task: HumanTask, *, manual: bool, side: str = "right") -> float:
    """How deep the bones of hand and forearm, or the board in the hand, come to be in the panel, metres."""
    blocks = filled(WorldObject.of(device("panel", PANEL)))
    places, turned = posed(body, shown)
    if manual:
        held, _ = points_of(task, side, task.world[21])
        hand = INDEX[f"{side}_hand"]
        points = places[:, hand, None] + rotate(turned[:, hand, None], held)
    else:
        links = [INDEX[f"{side}_lower_arm"], INDEX[f"{side}_hand"], *fingers(side)]
        ends = places[:, links] + rotate(turned[:, links], body.skeleton.tips[links])
        points: Array = np.concatenate([places[:, links], ends, 0.5 * (places[:, links] + ends)], axis=1)
    return float(max(-block.signed(points).min() for block in blocks))


@pytest.mark.parametrize("name", ["ken", "aiko"])
def test_what_is_carried_keeps_out_of_the_panel_at_which_the_other_hand_presses(name: str) -> None:
    body, shown, task = pressed(name, {"right": 21})
    assert depth(body, shown, task, manual=False) < -0.02
    assert depth(body, shown, task, manual=True) < -0.01
    rotations = np.array([pose.rotations for pose in shown])
    arm = slice(INDEX["right_upper_arm"], INDEX["right_hand"] + 1)
    turned = to_rotation_vector(multiply(conjugate(rotations[:-1, arm]), rotations[1:, arm]))
    assert np.degrees(np.linalg.norm(turned, axis=-1)).max() < 6.0
    palms = grips(body.skeleton, rotations, np.array([pose.root for pose in shown]))
    assert float(np.linalg.norm(palms[-1, 1, :3] - np.array(task.site.place))) < 0.3  # type: ignore[union-attr]


def test_of_what_is_not_told_the_hand_alone_keeps_out() -> None:
    body, shown, task = pressed("ken", {})
    assert task.in_hand("right") is None
    assert depth(body, shown, task, manual=False) < -0.02


def test_in_hand_tells_what_each_hand_holds() -> None:
    _, _, task = pressed("ken", {"right": 21})
    thing = task.in_hand("right")
    assert thing is not None
    assert thing.name == "manual"
    assert task.in_hand("left") is None


@pytest.mark.parametrize("name", ["ken", "aiko"])
@pytest.mark.parametrize(("side", "x", "y"), [("right", 1.15, -1.4), ("left", 1.2, 1.4)])
def test_what_is_carried_past_a_panel_keeps_out_of_it(name: str, side: str, x: float, y: float) -> None:
    """The board stands out to the panel's side, 0.3 m beside the way."""
    body = holding(name, side, (x, y, float(np.degrees(np.arctan2(-y, 0.0)))))
    manual_there = device("manual", body.grip(int(side == "left")).then(IN_PALM))
    world = [numbered(device("panel", PANEL), 20), numbered(manual_there, 21)]
    start = begun(
        body, None, "", {}, motion=WALKS, world=world, busy=[side], held={side: 21}, goal=Goal(place=(x, -y, 0.0))
    )
    shown, task = body.do("walk", start), HumanTask(start)
    assert abs(shown[-1].root[1] + y) < 0.05
    for manual in (False, True):
        assert depth(body, shown, task, manual=manual, side=side) < -0.01
    rotations = np.array([pose.rotations for pose in shown])
    arm = slice(INDEX[f"{side}_upper_arm"], INDEX[f"{side}_hand"] + 1)
    turned = to_rotation_vector(multiply(conjugate(rotations[:-1, arm]), rotations[1:, arm]))
    assert np.degrees(np.linalg.norm(turned, axis=-1)).max() < 4.0


def bearing(name: str, at: tuple[float, float, float]) -> tuple[Body, ObjectRecord]:
    """Somebody who stands somewhere, facing so many degrees, with a carton between both hands; the carton."""
    body = Body(name, *at)
    ahead, left = (np.array([np.cos(turn), np.sin(turn), 0.0]) for turn in np.radians([at[2], at[2] + 90.0]))
    middle, targets = np.array([*body.root[:2], 1.0]) + 0.32 * ahead, np.zeros((5, 8))
    for row, sign in ((0, -1.0), (1, 1.0)):  # the palm to the other side, the thumb ahead
        palm = np.stack([-sign * left, np.cross(ahead, -sign * left), ahead], axis=-1)
        targets[row] = [*(middle + sign * 0.18 * left), *from_matrix(palm), 1.0]
    body.rotations = solve(body.skeleton, body.rotations, body.root, targets)
    turn = from_axis_angle(np.array([0.0, 0.0, 1.0]), float(np.radians(at[2])))
    carton = device("carton", Transform(middle - np.array([0.0, 0.0, 0.2]), turn))
    return body, msgspec.structs.replace(carton, id=21, footprint=[])


@pytest.mark.parametrize("name", ["ken", "aiko"])
@pytest.mark.parametrize("y", [0.66, -0.66])
def test_both_arms_go_aside_together_with_what_they_hold_between_them(name: str, y: float) -> None:
    """One palm left a carton's side beside a panel, and the carton hung in the air from there on."""
    body, carton = bearing(name, (1.29, y, 0.0))  # beside the panel, one hand a little in it
    world = [numbered(device("panel", PANEL), 20), carton]
    start = begun(
        body, None, "", {}, motion=WALKS, world=world, busy=["left", "right"], held={"right": 21, "left": 21},
        goal=Goal(place=(0.2, 0.6, 0.0)),
    )  # fmt: skip
    shown = body.do("walk", start)
    palms = grips(body.skeleton, np.array([p.rotations for p in shown]), np.array([p.root for p in shown]))
    right, left = palms[..., :3].swapaxes(0, 1)
    assert np.ptp(np.linalg.norm(left - right, axis=-1)) < 0.003
    assert np.abs((left - right)[:, 2]).max() < 0.003


def test_the_corners_of_what_is_thick_are_looked_at_too() -> None:
    """A carton was taken for three balls, from which its corners stood out by 6 cm, and went into a panel's edge."""
    body, carton = bearing("ken", (0.0, 0.0, 0.0))
    task = HumanTask(begun(body, None, "", {}, world=[carton], busy=["left", "right"], held={"right": 21, "left": 21}))
    thing = task.world[21]
    held, radii = points_of(task, "right", thing)
    place, turned = Reacher.of(body.skeleton, "right").hand(body.grip().row())
    points = place + rotate(turned, held)
    for x, y, z in itertools.product((-0.14, 0.14), (-0.18, 0.18), (0.0, 0.28)):
        corner = thing.frame.apply(np.array([x, y, z]))
        assert 0.0 < (np.linalg.norm(points - corner, axis=-1) - radii).min() < 0.025
