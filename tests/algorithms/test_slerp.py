"""slerp: from the present pose to the keyframes, hands and gaze at their targets."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import Transform, frames
from ahmss.algorithm.messages import Goal
from ahmss.algorithm.performance import Performance
from ahmss.body.arm import Arm, hand_angles
from ahmss.body.inverse import RIGHT_HAND, grips
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS
from ahmss.body.quaternion import from_axis_angle, multiply, norm, rotate
from ahmss.errors import AlgorithmError
from ahmss.motion.planting import feet
from ahmss.skills.staging import lips

from .reached import outlined
from .scene import CUP, FLOOR, ROOT, Body, frame_of, program, record

CHAIR, BEFORE_CHAIR = "room/chair", (1.80, 0.2, 180.0)  # where a human stands to sit down
REACH = {"motion": str(ROOT / "objectdb" / "cup" / "reach.npz"), "parameters": {"arc": 0.09}, "frames": 60}


@pytest.mark.parametrize("name", ["ken", "aiko"])
def test_the_palm_arrives_beside_the_cup_at_rest(name: str) -> None:
    body = Body(name)
    shown = body.do("slerp", body.start(CUP, "reach", **REACH))
    from_axis = body.grip().place - frame_of(CUP).place
    assert 0.05 < np.hypot(*from_axis[:2]) < 0.09
    assert from_axis[2] == pytest.approx(0.052, abs=0.003)
    into = rotate(body.grip().rotation, np.array([1.0, 0.0, 0.0]))
    assert into @ from_axis < 0.0  # the palm looks at the cup
    assert np.linalg.norm(shown[-1].root - shown[-2].root) < 1e-4


def test_it_begins_where_the_body_is() -> None:
    body = Body()
    grip, root = body.grip().place, body.root
    first = next(iter(frames(program("slerp"), body.start(CUP, "reach", **REACH))))
    np.testing.assert_allclose(first.targets[RIGHT_HAND, :3], grip, atol=1e-4)
    np.testing.assert_allclose(first.root, root, atol=1e-4)


def test_the_hand_takes_its_time_as_a_hand_does() -> None:
    body = Body()
    poses = list(frames(program("slerp"), body.start(CUP, "reach", **REACH)))
    path = np.array([pose.targets[RIGHT_HAND, :3] for pose in poses])
    speed = np.linalg.norm(np.diff(path, axis=0), axis=1)
    assert speed.max() / speed.mean() == pytest.approx(1.875, rel=0.15)
    assert 0.35 < speed.argmax() / len(speed) < 0.65


def test_the_feet_stay_whatever_the_body_does() -> None:
    body = Body("aiko", x=1.0, y=-0.5, facing=70.0)
    before = feet(body.skeleton, body.rotations, body.root)
    ahead = Transform(np.array([1.15, -0.09, 0.88]), np.array([1.0, 0.0, 0.0, 0.0]))
    for pose in body.do("slerp", body.start(CUP, "reach", frame=ahead, **REACH)):
        np.testing.assert_allclose(feet(body.skeleton, pose.rotations, pose.root), before, atol=2e-3)


def test_the_left_hand_does_what_the_right_does() -> None:
    body = Body(y=-0.3, facing=20.0)  # the cup before it as before the right hand, seen in a mirror
    body.do("slerp", body.start(CUP, "reach", hand="left", **REACH))
    assert 0.05 < np.hypot(*(body.grip(1).place - frame_of(CUP).place)[:2]) < 0.09


def test_a_held_cup_is_put_where_it_shall_be() -> None:
    body = Body()
    body.do("slerp", body.start(CUP, "reach", **REACH))
    in_palm = body.grip().inverse().then(frame_of(CUP))
    body.do("slerp", body.start(CUP, "lift", frame=body.grip().then(in_palm)))
    assert body.grip().then(in_palm).place[2] > frame_of(CUP).place[2] + 0.1
    body.do("slerp", body.start(CUP, "lift", frame=body.grip().then(in_palm), goal=Goal(place=(0.3, -0.05, 0.98))))
    cup = body.grip().then(in_palm)
    np.testing.assert_allclose(cup.place, [0.3, -0.05, 0.98], atol=1e-3)
    assert rotate(cup.rotation, np.array([0.0, 0.0, 1.0]))[2] > 0.9999


def test_who_is_carried_on_raises_a_cup_straight_from_where_it_stands() -> None:
    """The hand is led from the first frame: left to the joints it would go through the table on its way."""
    body = Body()
    body.do("slerp", body.start(CUP, "reach", **REACH))
    grip = body.grip()
    made = [pose.targets[RIGHT_HAND] for pose in frames(program("slerp"), body.start(CUP, "lift", carried=True))]
    way = np.array(made)
    np.testing.assert_allclose(way[:, 7], 1.0)
    np.testing.assert_allclose(way[0, :3], grip.place, atol=1e-3)
    assert np.diff(way[:, 2]).min() > 0.0
    assert way[-1, 2] - grip.place[2] == pytest.approx(0.17, abs=0.02)
    along = (way[-1, :3] - grip.place) / np.linalg.norm(way[-1, :3] - grip.place)
    np.testing.assert_allclose(np.cross(way[:, :3] - grip.place, along), 0.0, atol=1e-6)


def rim_from_mouth(name: str, wide: float = 1.0) -> float:
    """Metres from the mouth to the middle of the rim of a cup so many times as wide, at the nearest as one drinks."""
    body = Body(name)
    body.do("slerp", body.start(CUP, "reach", **REACH))
    in_palm = body.grip().inverse().then(frame_of(CUP))
    nearest = 1.0
    start = body.start(CUP, "drink", frame=body.grip().then(in_palm))
    assert start.object is not None
    properties = start.object.properties | {"diameter": 0.072 * wide}
    start = msgspec.structs.replace(start, object=msgspec.structs.replace(start.object, properties=properties))
    for pose in body.do("slerp", start):
        places, turned = forward(pose.rotations, pose.root, body.skeleton.offsets)
        head = INDEX["head"]
        mouth = places[head] + rotate(turned[head], lips(body.skeleton))
        grip = pose.targets[RIGHT_HAND]
        rim = grip[:3] + rotate(grip[3:7], in_palm.apply(np.array([0.0, 0.0, 0.095])))
        nearest = min(nearest, float(np.linalg.norm(rim - mouth)))
    return nearest


@pytest.mark.parametrize("name", ["ken", "aiko"])
def test_the_rim_comes_to_the_mouth_of_either_human(name: str) -> None:
    assert rim_from_mouth(name) == pytest.approx(0.036, abs=0.004)  # the rim's centre is its radius away


@pytest.mark.parametrize("wide", [0.6, 1.25, 1.4])
def test_of_a_wider_cup_the_edge_comes_to_the_mouth_and_not_the_middle(wide: float) -> None:
    """At the same distance from the middle its rim was 9 mm in the face."""
    assert rim_from_mouth("ken", wide) - rim_from_mouth("ken") == pytest.approx(0.036 * (wide - 1.0), abs=5e-4)


@pytest.mark.parametrize("name", ["ken", "aiko"])
@pytest.mark.parametrize("action", ["drink", "lift"])
def test_who_sits_drinks_and_lifts_sitting(name: str, action: str) -> None:
    body, chair = Body(name, *BEFORE_CHAIR), outlined(record(CHAIR), 3)
    body.do("sit", msgspec.structs.replace(body.start(CHAIR, "sit", hand=""), object=chair))
    elbow = INDEX["right_lower_arm"]
    body.rotations[elbow] = multiply(body.rotations[elbow], from_axis_angle(np.array([0.0, 1.0, 0.0]), -0.5))
    body.rotations[3] = multiply(body.rotations[3], from_axis_angle(np.array([0.0, 1.0, 0.0]), -0.5))
    held = Transform(body.grip().place, np.array([1.0, 0.0, 0.0, 0.0]))
    in_palm = body.grip().inverse().then(held)
    start = msgspec.structs.replace(body.start(CUP, action, frame=held), world=[chair], busy=["right"])
    before, root = body.rotations, body.root
    shown = body.do("slerp", start)
    still = [i for i, link in enumerate(LINKS) if link == "hips" or "leg" in link or "foot" in link or "left" in link]
    rims = []
    for pose in shown:
        np.testing.assert_allclose(pose.root, root, atol=1e-4)
        np.testing.assert_allclose(np.abs((pose.rotations * before).sum(axis=-1))[still], 1.0, atol=1e-5)
        places, turned = forward(pose.rotations, pose.root, body.skeleton.offsets)
        mouth = places[INDEX["head"]] + rotate(turned[INDEX["head"]], lips(body.skeleton))
        grip = Transform.of(grips(body.skeleton, pose.rotations, pose.root)[0])
        rims.append(grip.then(in_palm).apply(np.array([0.0, 0.0, 0.095])) - mouth)
    if action == "drink":
        assert np.linalg.norm(rims, axis=1).min() == pytest.approx(0.036, abs=0.004)
    else:
        assert body.grip().place[2] > held.place[2] + 0.1


@pytest.mark.parametrize(("hand", "other"), [("right", "left"), ("left", "right")])
def test_who_is_carried_and_drinks_has_the_other_arm_for_what_carries_them(hand: str, other: str) -> None:
    """Let hang by who sat down meanwhile it came off the thigh, and its fingers went into the seat."""
    body = Body()
    for carried, cares in ((False, True), (True, False)):
        start = body.start(CUP, "drink", frame=body.grip(int(hand == "left")), hand=hand, carried=carried)
        importance = next(iter(frames(program("slerp"), start))).importance
        assert importance[INDEX[f"{hand}_lower_arm"]] == pytest.approx(1.0)
        assert bool(importance[INDEX[f"{other}_lower_arm"]] > 0.0) is cares


def arms_at_the_lips(body: Body, hand: str) -> np.ndarray:
    """Degrees (n, 4) of the arm that drinks, the rim at the lips: elbow, upper arm from hanging, wrist, forearm."""
    side = ("right", "left").index(hand)
    body.do("slerp", body.start(CUP, "reach", hand=hand, **REACH))
    in_palm = body.grip(side).inverse().then(frame_of(CUP))
    arm, first, head = Arm.of(body.skeleton, hand), INDEX[f"{hand}_upper_arm"], INDEX["head"]
    measured: list[np.ndarray] = []
    for pose in body.do("slerp", body.start(CUP, "drink", hand=hand, frame=body.grip(side).then(in_palm))):
        places, turn = forward(pose.rotations, pose.root, body.skeleton.offsets)
        rim = Transform.of(grips(body.skeleton, pose.rotations, pose.root)[side]).then(in_palm)
        mouth = places[head] + rotate(turn[head], lips(body.skeleton))
        if np.linalg.norm(rim.apply(np.array([0.0, 0.0, 0.095])) - mouth) > 0.042:
            continue
        upper, fore, fingers = rotate(turn[first : first + 3], np.array([1.0, 0.0, 0.0]))
        forearm = hand_angles(arm.from_pose(pose.rotations[first : first + 3]))[0]
        bent = np.arccos([upper @ fore, -upper[2], fore @ fingers])
        measured.append(np.degrees([*bent, abs(forearm)]))
    return np.array(measured)


@pytest.mark.parametrize(("hand", "y", "facing"), [("right", 0.0, -20.0), ("left", -0.3, 20.0)])
@pytest.mark.parametrize("name", ["ken", "aiko"])
def test_the_arm_drinks_as_an_arm_does(name: str, hand: str, y: float, facing: float) -> None:
    """People: elbow 130, upper arm 43 ahead and 31 aside, wrist near straight; ours has the cup square to the hand."""
    elbow, raised, wrist, forearm = arms_at_the_lips(Body(name, y=y, facing=facing), hand).T
    assert len(elbow) > 60
    assert 120.0 < elbow.min() <= elbow.max() < 138.0
    assert 45.0 < raised.min() <= raised.max() < 76.0
    assert 5.0 < wrist.max() < 37.0
    assert forearm.max() < 80.0


def test_every_frame_is_a_pose() -> None:
    body = Body()
    for action in ("reach", "lift", "drink"):
        for pose in frames(
            program("slerp"), body.start(CUP, action, **((REACH if action == "reach" else {}) | {"frames": 7}))
        ):
            np.testing.assert_allclose(norm(pose.rotations), 1.0, atol=1e-9)
            assert np.isfinite(pose.targets).all()


@pytest.mark.parametrize(("action", "x"), [("reach", -0.5), ("lift", 0.0)])
def test_what_is_out_of_reach_is_refused_with_the_missing_length(action: str, x: float) -> None:
    body = Body(x=x)
    goal = Goal(place=(1.2, -0.15, 0.88)) if action == "lift" else Goal()
    with pytest.raises(AlgorithmError, match=r"right arm is 0\.\d\d m too short"):
        next(iter(frames(program("slerp"), body.start(CUP, action, goal=goal, **(REACH if action == "reach" else {})))))


@pytest.mark.parametrize("name", ["ken", "aiko"])
@pytest.mark.parametrize("place", [(0.5, -0.2, 0.25), (0.65, -0.15, 0.6), (0.15, -0.5, 0.4)])
def test_what_was_grasped_low_or_far_off_is_lifted_to_where_the_arm_holds_it_upright(
    name: str, place: tuple[float, float, float]
) -> None:
    body = Body(name, facing=0.0)
    low = {"frames": 0, "wish": True, "hand": "right", "parameters": {"turn": "free"}}
    body.do("reach", body.start(FLOOR, "stand", **low, goal=Goal(place=place)))
    hips, palm = body.root[2], body.grip()
    cup = Transform(palm.place, np.array([1.0, 0.0, 0.0, 0.0]))
    shown = body.do("slerp", body.start(CUP, "lift", frame=cup))
    assert body.root[2] >= hips
    assert body.grip().place[2] > palm.place[2]
    np.testing.assert_allclose(body.grip().place, shown[-1].targets[RIGHT_HAND, :3], atol=1e-3)


@pytest.mark.parametrize("name", ["ken", "aiko"])
@pytest.mark.parametrize("hand", ["right", "left"])
def test_who_drinks_with_the_cup_taken_from_the_floor_brings_it_along_as_they_rise(name: str, hand: str) -> None:
    """The hand was led to where the face was, not to where it would be: the arm was drawn out, the forearm by 13."""
    body, side = Body(name, facing=0.0), ("right", "left").index(hand)
    cup, hips = Transform(np.array([0.45, 0.2 * side - 0.1, 0.0]), np.array([1.0, 0.0, 0.0, 0.0])), body.root[2]
    body.do("reach", body.start(CUP, "reach", hand=hand, frame=cup))
    assert body.root[2] < hips - 0.15
    before = body.rotations
    shown = body.do("slerp", body.start(CUP, "drink", hand=hand, frame=cup))
    arm = [INDEX[f"{hand}_{link}"] for link in ("upper_arm", "lower_arm", "hand")]
    turned = np.stack([before, *(pose.rotations for pose in shown)])[:, arm]
    by = np.degrees(2.0 * np.arccos(np.clip(np.abs((turned[1:] * turned[:-1]).sum(axis=-1)), 0.0, 1.0)))
    assert by.max() < 6.0


@pytest.mark.parametrize(
    ("length", "moved", "missing"), [(60, 0.0, "1.1"), (60, 1.25, ""), (60, 0.6, "0.5"), (2, 0.0, "1.1")]
)
def test_who_was_not_carried_near_enough_in_time_is_told_once_by_how_much(
    length: int, moved: float, missing: str
) -> None:
    """Before the last frame, from where the body is then: it was carried so many metres."""
    body = Body(x=-1.2)
    performance = Performance(program("slerp"), body.start(CUP, "reach", **(REACH | {"frames": length}), carried=True))
    notes: list[list[str]] = []
    for k in range(1, length + 1):
        present = body.row(k)
        present[1] += moved * (k - 1) / (length - 1)
        assert performance.step(present)
        notes.append(performance.news())
    assert performance.over
    assert not any(notes[:-1])
    assert len(notes[-1]) == (missing != "")
    for note in notes[-1]:
        assert f"its arm was {missing}" in note
        assert "`after N`" in note


def test_standing_needs_no_object_to_look_at() -> None:
    body = Body()
    body.do("slerp", body.start(CUP, "reach", **REACH))
    body.do("slerp", body.start(FLOOR, "stand"))
    assert body.grip().place[2] < 0.85
