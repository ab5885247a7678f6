"""reach: the palm comes to a place in the world, from standing and while carried, with the better hand."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import HumanPose, HumanTask, Transform, frames
from ahmss.algorithm.messages import Goal
from ahmss.algorithm.performance import Performance
from ahmss.body.inverse import GAZE, LEFT_HAND, RIGHT_FOOT, RIGHT_HAND, grips, solve
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, rotate, to_rotation_vector
from ahmss.errors import AlgorithmError
from ahmss.motion.planting import feet
from ahmss.motion.quality import beyond_limits
from ahmss.motion.smoothness import pops, worst_pop
from ahmss.reaching.reacher import Reacher, seat

from .scene import CUP, FLOOR, TELEVISION, Body, frame_of, program

FREE: dict[str, Any] = {"frames": 0, "wish": True, "hand": "", "parameters": {}}


def turned(a: np.ndarray, b: np.ndarray) -> float:
    """Degrees between two rotations."""
    return float(np.degrees(np.linalg.norm(to_rotation_vector(multiply(conjugate(a), b)))))


@pytest.mark.parametrize("name", ["ken", "aiko"])
def test_a_point_in_the_air_is_reached_with_a_hand_turned_as_told(name: str) -> None:
    body = Body(name, facing=0.0)  # fingers ahead, the palm looking inward and down
    ahead = multiply(from_axis_angle(np.array([0.0, 1.0, 0.0]), -np.pi / 2), body.grip().rotation)
    flat = tuple(multiply(from_axis_angle(np.array([1.0, 0.0, 0.0]), -1.0), ahead).tolist())
    body.do("reach", body.start(FLOOR, "stand", **FREE, goal=Goal(place=(0.4, -0.2, 1.1), rotation=flat)))
    np.testing.assert_allclose(body.grip().place, [0.4, -0.2, 1.1], atol=1e-3)
    assert turned(body.grip().rotation, np.array(flat)) < 1.0


def test_eyes_and_head_go_first() -> None:
    body = Body()
    shown = body.do("reach", body.start(CUP, "reach", **FREE))
    wall = frame_of(CUP).apply(np.array([0.0, 0.0, 0.052]))
    head = np.array([turned(shown[0].rotations[INDEX["head"]], pose.rotations[INDEX["head"]]) for pose in shown])
    way = np.array([np.linalg.norm(pose.targets[RIGHT_HAND, :3] - wall) for pose in shown if pose.targets[0, 7]])
    assert {tuple(pose.targets[GAZE, :3]) for pose in shown} == {tuple(wall)}
    half = int(np.argmax(way < 0.5 * (way[0] + way[-1]))) + len(shown) - len(way)
    assert head[half] > 0.6 * head.max()
    assert head[5] > 3.0 * np.degrees(1e-3)


@pytest.mark.parametrize("name", ["ken", "aiko"])
@pytest.mark.parametrize("place", [(0.35, -0.1), (0.45, -0.1), (0.55, -0.1), (0.33, 0.05)])
def test_a_cup_on_the_floor_is_reached_with_the_knees_bent_so_far_that_the_wrist_can_turn(
    name: str, place: tuple[float, float]
) -> None:
    body, cup = Body(name, facing=0.0), Transform(np.array([*place, 0.0]), np.array([1.0, 0.0, 0.0, 0.0]))
    hips = body.root[2]
    body.do("reach", body.start(CUP, "reach", frame=cup, **FREE | {"hand": "right"}))
    palm, wall = body.grip(), cup.apply(np.array([0.0, 0.0, 0.052]))
    assert abs(palm.place[2] - wall[2]) < 0.01
    assert np.hypot(*(palm.place - wall)[:2]) == pytest.approx(0.066, abs=0.01)
    assert abs(rotate(palm.rotation, np.array([0.0, 0.0, 1.0]))[2]) > np.cos(np.radians(12.0))
    assert body.root[2] < 0.65 * hips


@pytest.mark.parametrize(("y", "facing", "row"), [(0.0, -20.0, RIGHT_HAND), (-0.45, 20.0, LEFT_HAND)])
def test_the_nearer_hand_is_used(y: float, facing: float, row: int) -> None:
    poses = list(frames(program("reach"), Body(y=y, facing=facing).start(CUP, "reach", **FREE)))
    assert poses[-1].targets[row, 7] == 1.0
    assert poses[-1].targets[1 - row, 7] == 0.0


def test_a_hand_that_holds_something_is_not_used() -> None:
    poses = list(frames(program("reach"), Body().start(CUP, "reach", **FREE, busy=["right"])))
    assert poses[-1].targets[LEFT_HAND, 7] == 1.0
    with pytest.raises(AlgorithmError, match="both hands"):
        list(frames(program("reach"), Body().start(CUP, "reach", **FREE, busy=["left", "right"])))


def test_the_hand_that_was_said_is_used() -> None:
    poses = list(frames(program("reach"), Body().start(CUP, "reach", **(FREE | {"hand": "left"}))))
    assert poses[-1].targets[LEFT_HAND, 7] == 1.0


def test_the_trunk_stays_where_the_arm_is_long_enough() -> None:
    body = Body(facing=0.0)
    poses = list(frames(program("reach"), body.start(FLOOR, "stand", **FREE, goal=Goal(place=(0.3, -0.2, 1.2)))))
    for name in ("hips", "spine", "right_upper_leg"):
        assert poses[-1].importance[INDEX[name]] == 0.0
    assert poses[-1].importance[43] == 0.0


def test_the_trunk_begins_with_the_arm_and_ends_last() -> None:
    body = Body(facing=0.0)
    shown = body.do("reach", body.start(FLOOR, "stand", **FREE, goal=Goal(place=(0.65, -0.1, 1.0))))
    palm = np.array([pose.targets[RIGHT_HAND, :3] for pose in shown])
    lean = np.array([turned(pose.rotations[0], shown[0].rotations[0]) for pose in shown])
    assert lean[-1] > 8.0
    there = int(np.argmax(np.linalg.norm(palm - palm[-1], axis=1) < 1e-6))
    assert there < len(shown) - 2
    assert lean[there] < lean[-1] - 1e-3
    begun = int(np.argmax([pose.targets[RIGHT_HAND, 7] > 0.0 for pose in shown]))
    assert np.argmax(lean > 0.01) < begun + 6


@pytest.mark.parametrize(("x", "missing"), [(1.2, r"0\.\d\d"), (2.2, r"1\.\d\d")])
def test_what_is_out_of_reach_is_refused_with_the_distance(x: float, missing: str) -> None:
    start = Body(facing=0.0).start(FLOOR, "stand", **FREE, goal=Goal(place=(x, 0.0, 1.2)))
    with pytest.raises(AlgorithmError, match=rf"arm is {missing} m too short"):
        list(frames(program("reach"), start))


@pytest.mark.parametrize("name", ["ken", "aiko"])
@pytest.mark.parametrize("rotation", [None, (1.0, 0.0, 0.0, 0.0)])
def test_what_is_nearer_than_the_elbow_bends_is_reached_all_the_same(
    name: str, rotation: tuple[float, float, float, float] | None
) -> None:
    """Another turn of the palm has the wrist farther away; where the palm is told, the trunk goes back."""
    body = Body(name, facing=0.0)
    arm = Reacher.of(body.skeleton, "left")
    place = arm.shoulder(seat(body.skeleton, body.rotations, body.root)) + np.array([0.06, 0.05, -0.05])
    goal = Goal(place=(float(place[0]), float(place[1]), float(place[2])), rotation=rotation)
    body.do("reach", body.start(FLOOR, "stand", **(FREE | {"hand": "left"}), goal=goal))
    np.testing.assert_allclose(body.grip(1).place, place, atol=1e-3)


@pytest.mark.parametrize(
    ("goal", "told"),
    [
        (Goal(place=(0.4, 0.2, 1.2), rotation=(0.5, 0.5, 0.5, 0.5)), "wrist does not turn so far"),
        (Goal(place=(0.4, 0.2, 1.2)), ""),
    ],
)
def test_a_palm_that_ends_elsewhere_is_told_with_how_far(goal: Goal, told: str) -> None:
    body, notes = Body(facing=0.0), list[str]()
    run = program("reach")

    def noted(task: HumanTask):
        yield from run(task)
        notes.extend(task.notes)

    start = body.start(FLOOR, "stand", **(FREE | {"hand": "left"}), goal=goal)
    last = list(frames(noted, start))[-1]
    off = 1000.0 * float(np.linalg.norm(last.targets[LEFT_HAND, :3] - np.array(goal.place)))
    if told:
        (note,) = notes
        assert told in note
        assert float(note.split(" mm")[0].rpartition(" ")[2]) == pytest.approx(off, abs=0.5)
    else:
        assert not notes
        assert off < 1.0


def test_how_short_the_hand_stops_is_told_of_the_try_alone_that_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every way counts as badly off, so that others are tried, each of which stops short by its own."""
    run, notes = program("reach"), list[str]()
    tries, own = iter((0.004, 0.006, 0.008, 0.011)), run.__globals__["planned"]

    def planned(*given: Any, **named: Any) -> Any:
        plan = yield from own(*given, **named)
        return replace(plan, short=next(tries))

    def noted(task: HumanTask) -> Any:
        yield from run(task)
        notes.extend(task.notes)

    for name, value in (("FLAW", -1.0), ("TOUCHES", -1.0), ("planned", planned)):
        monkeypatch.setitem(run.__globals__, name, value)
    list(frames(noted, Body(facing=0.0).start(FLOOR, "stand", **FREE, goal=Goal(place=(0.45, -0.1, 1.1)))))
    assert next(tries) > 0.006  # more than one was tried
    (note,) = notes
    assert re.search(r"hand stops [468] mm short of it", note)


def test_knees_bend_for_what_is_low() -> None:
    body = Body(facing=0.0)
    before = feet(body.skeleton, body.rotations, body.root)
    shown = body.do("reach", body.start(FLOOR, "stand", **FREE, goal=Goal(place=(0.4, -0.15, 0.12))))
    np.testing.assert_allclose(body.grip(0).place, [0.4, -0.15, 0.12], atol=1e-3)
    np.testing.assert_allclose(feet(body.skeleton, body.rotations, body.root), before, atol=2e-3)
    assert shown[-1].root[2] < shown[0].root[2] - 0.1


def test_nothing_jumps() -> None:
    shown = Body().do("reach", Body().start(CUP, "reach", **FREE))
    assert worst_pop(np.array([pose.rotations for pose in shown])).degrees < 1.5


def test_asked_for_so_many_frames_it_takes_them() -> None:
    for length, wish in ((3, False), (30, True), (100, True)):  # of 3 frames only where main ends it after them
        given = FREE | {"frames": length, "wish": wish}
        assert len(list(frames(program("reach"), Body().start(CUP, "reach", **given)))) == length


@pytest.mark.parametrize("length", [1, 8])
def test_asked_for_too_few_frames_it_takes_those_that_it_needs_and_arrives(length: int) -> None:
    body, task = Body(), Performance(program("reach"), Body().start(CUP, "reach", **(FREE | {"frames": length}))).task
    shown = body.do("reach", body.start(CUP, "reach", **(FREE | {"frames": length})))
    at_ease = Body().do("reach", Body().start(CUP, "reach", **FREE))
    assert 0.33 * len(at_ease) < len(shown) < 0.7 * len(at_ease)
    last = shown[-1].targets[RIGHT_HAND]
    assert last[7] == 1.0
    np.testing.assert_allclose(body.grip().place, last[:3], atol=1e-3)
    notes = list(program("reach")(task)) and task.notes
    assert notes == [f"{length} frame{' is' if length == 1 else 's are'} too few; it takes {len(shown)}"]


def test_who_sits_bends_at_the_waist_alone() -> None:
    body = Body(facing=0.0)
    for link in (INDEX["right_upper_leg"], INDEX["left_upper_leg"]):
        back = from_axis_angle(np.array([0.0, 1.0, 0.0]), 1.5)
        body.rotations[link] = multiply(body.rotations[link], conjugate(back))
        body.rotations[link + 1] = multiply(body.rotations[link + 1], back)
    body.root = body.root - np.array([0.0, 0.0, 0.4])
    root = body.root.copy()
    goal = Goal(place=(0.62, -0.1, 0.75))
    shown = body.do("reach", body.start(FLOOR, "stand", **FREE, goal=goal))
    np.testing.assert_allclose(body.grip(int(shown[-1].targets[LEFT_HAND, 7])).place, goal.place, atol=1e-3)
    np.testing.assert_allclose(body.root, root)
    assert shown[-1].importance[INDEX["spine"]] == 1.0
    assert shown[-1].importance[INDEX["hips"]] == shown[-1].importance[43] == 0.0
    assert not shown[-1].targets[RIGHT_FOOT, 7]


def carried(length: int, moved: float, *, stops: bool = True, **given: Any) -> tuple[list[HumanPose], Body, list[str]]:
    """A reach for the cup by who is carried so many metres ahead meanwhile, and comes to rest, or goes on as before."""
    body = Body(x=-moved, facing=0.0)
    fields = FREE | {"frames": length} | given
    performance = Performance(program("reach"), body.start(CUP, "reach", carried=True, **fields))
    begun, shown = body.root.copy(), []
    for k in range(1, 2000):
        if not performance.step(body.row(k)):
            break
        pose = HumanPose.of(performance.row.copy())
        share = min(k / (length or 200), 1.0)
        root = begun + np.array([moved * share * (2.0 - share if stops else 1.0), 0.0, 0.0])
        arm = pose.importance > 0.0
        given_rotations = np.where(arm[:43, None], pose.rotations, body.rotations)
        body.rotations = solve(body.skeleton, given_rotations, root, pose.targets)
        body.root = root
        shown.append(HumanPose(body.rotations, root, pose.importance, pose.targets))
        if performance.over:
            break
    return shown, body, performance.news()


@pytest.mark.parametrize(("length", "moved"), [(60, 0.8), (110, 1.5), (0, 2.0)])
def test_while_carried_the_place_is_met_in_the_world(length: int, moved: float) -> None:
    shown, body, notes = carried(length, moved)
    wall = frame_of(CUP).apply(np.array([0.0, 0.0, 0.052]))
    row = int(shown[-1].targets[LEFT_HAND, 7])
    palm = Transform.of(grips(body.skeleton, body.rotations, body.root)[row])
    out = rotate(palm.rotation, np.array([1.0, 0.0, 0.0]))
    assert np.linalg.norm(palm.place + 0.066 * out - wall) < 1e-3
    assert rotate(palm.rotation, np.array([0.0, 0.0, 1.0]))[2] > np.cos(np.radians(1.0))
    assert not notes
    assert len(shown) == length or not length
    for name in ("hips", "right_upper_leg", "left_foot"):
        assert shown[-1].importance[INDEX[name]] == 0.0
    assert shown[-1].importance[43] == 0.0
    assert not shown[-1].targets[RIGHT_FOOT, 7]
    assert worst_pop(np.array([pose.rotations for pose in shown[2:]])).degrees < 1.5


def test_who_goes_on_slowly_holds_the_palm_there_until_what_follows_begins() -> None:
    """Let go of, it went on with the body, 2 mm a frame and into the cup, before the hand could close on it."""
    shown, body, notes = carried(90, 0.4, stops=False)
    wall = frame_of(CUP).apply(np.array([0.0, 0.0, 0.052]))
    assert shown[-1].targets[:2, 7].sum() == 1.0
    row = int(shown[-1].targets[:2, 7].argmax())
    palm = Transform.of(grips(body.skeleton, body.rotations, body.root)[row])
    assert np.linalg.norm(palm.place + 0.066 * rotate(palm.rotation, np.array([1.0, 0.0, 0.0])) - wall) < 5e-3
    assert not notes


def test_who_was_not_carried_near_enough_is_told_by_how_much() -> None:
    _, _, notes = carried(60, 0.0)
    assert notes == []
    body = Body(x=-1.2)
    performance = Performance(program("reach"), body.start(CUP, "reach", carried=True, **(FREE | {"frames": 30})))
    for k in range(1, 31):
        assert performance.step(body.row(k))
    (note,) = performance.news()
    assert "arm was 1.1" in note or "arm was 1.0" in note
    assert "`after N`" in note


def passing(name: str, hand: str, place: tuple[float, float, float], length: int) -> tuple[list[HumanPose], list[str]]:
    """A reach for a place by who is carried on past it at 1.2 m/s, never stopping."""
    body = Body(name, x=-0.8, facing=0.0)
    fields = FREE | {"frames": length, "hand": hand, "goal": Goal(place=place)}
    performance = Performance(program("reach"), body.start(FLOOR, "stand", carried=True, **fields))
    shown: list[HumanPose] = []
    for k in range(1, length + 1):
        assert performance.step(body.row(k))
        pose = HumanPose.of(performance.row.copy())
        root = body.root + np.array([0.02, 0.0, 0.0])
        given_rotations = np.where(pose.importance[:43, None] > 0.0, pose.rotations, body.rotations)
        body.rotations, body.root = solve(body.skeleton, given_rotations, root, pose.targets), root
        shown.append(HumanPose(body.rotations, root, pose.importance, pose.targets))
    return shown, performance.news()


PASSED = [
    ("ken", "right", 0.4, 1.1),
    ("aiko", "left", 0.7, 0.6),
    ("aiko", "right", 0.15, 1.1),
    ("ken", "left", 0.4, 1.6),
]
OTHERS = [(name, hand, *place) for _, _, *place in PASSED for name in ("ken", "aiko") for hand in ("right", "left")]


@pytest.mark.parametrize(
    ("name", "hand", "aside", "z"),
    PASSED + [pytest.param(*one, marks=pytest.mark.long) for one in OTHERS if one not in PASSED],
)
def test_a_place_that_is_passed_is_let_go_of_smoothly(name: str, hand: str, aside: float, z: float) -> None:
    shown, notes = passing(name, hand, (-0.2, -aside if hand == "right" else aside, z), 110)
    rotations = np.array([pose.rotations for pose in shown])
    arm = slice(INDEX[f"{hand}_upper_arm"], INDEX[f"{hand}_hand"] + 1)
    begun = int(np.argmax([pose.targets[:2, 7].any() for pose in shown])) + 4  # what begins is smoothed by main
    assert pops(rotations)[begun:, arm].max() < 3.0
    still = np.tile(Body(name).rotations, (len(shown), 1, 1))
    still[:, arm] = rotations[:, arm]
    assert beyond_limits(still, Body(name).skeleton).degrees < 7.0
    assert shown[-1].targets[("right", "left").index(hand), 7] == 0.0
    (note,) = notes
    assert "was passed already" in note
    assert "m beyond its arm" in note
    assert "fewer frames" in note


@pytest.mark.parametrize(("name", "hand"), [("ken", "left"), ("aiko", "right")])
def test_who_goes_on_past_a_place_has_reached_when_the_hand_has_let_go(name: str, hand: str) -> None:
    """Without a number of frames it is no failure that the walk ends far beyond; how near the hand came is told."""
    aside = 0.73 if name == "ken" else 0.66  # a little too far for the arm alone
    body, place = Body(name, x=-1.5, facing=0.0), np.array([0.0, aside if hand == "left" else -aside, 0.92])
    fields = FREE | {"hand": hand, "goal": Goal(place=tuple(place.tolist()))}
    performance = Performance(program("reach"), body.start(FLOOR, "stand", carried=True, **fields))
    off: list[float] = []
    for k in range(1, 300):
        if not performance.step(body.row(k)):
            break
        pose = HumanPose.of(performance.row.copy())
        root = body.root + np.array([0.016 if body.root[0] < 1.5 else 0.0, 0.0, 0.0])
        driven = np.where(pose.importance[:43, None] > 0.0, pose.rotations, body.rotations)
        body.rotations, body.root = solve(body.skeleton, driven, root, pose.targets), root
        off.append(float(np.linalg.norm(body.grip(("right", "left").index(hand)).place - place)))
        if performance.over:
            break
    (note,) = performance.news()
    assert f"the {hand} hand came within" in note
    assert min(off) < 0.05
    assert abs(float(note.split("within ")[1].split(" mm")[0]) - 1000.0 * min(off)) < 4.0
    assert off[-1] > 0.3
    assert body.root[0] < 1.4, "before the walk ends"


def test_without_a_site_and_a_goal_it_asks_where() -> None:
    start = msgspec.structs.replace(Body().start(TELEVISION, "look", **FREE), site="", object=None)
    with pytest.raises(AlgorithmError, match="reach where"):
        list(frames(program("reach"), start))
