"""The program `walk` in the shipped room, told what main tells it."""

from __future__ import annotations

import re
from typing import Any

import msgspec
import numpy as np
import pytest
import shapely

from ahmss.algorithm import frames
from ahmss.algorithm.messages import Goal, ObjectRecord, Start, encode_frame
from ahmss.algorithm.performance import Performance
from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.pose import HumanPose
from ahmss.body.array import Array
from ahmss.body.inverse import solve
from ahmss.body.links import INDEX, LINKS
from ahmss.body.quaternion import norm, rotate
from ahmss.errors import AlgorithmError
from ahmss.motion.planting import feet
from ahmss.processes.answers import Answer
from ahmss.processes.launcher import Launcher
from ahmss.reaching.standing import Standing

from .scene import FLOOR, WORKSPACE, Body, program, record

FEET = slice(2, 4)
FROM = (-1.5, -1.5)


def standing(name: str, number: int) -> ObjectRecord:
    """A thing of the room where it stands, with its footprint."""
    made = record(name)
    outlines = WORKSPACE.objects.footprint(made.kind, made.place[2], np.array(made.rotation))
    return msgspec.structs.replace(made, id=number, footprint=[list(ring) for ring in outlines])


ROOM = [standing("room/table", 11), standing("room/chair", 12), standing("room/television", 13)]


def other_human(x: float, y: float, number: int = 20) -> ObjectRecord:
    return ObjectRecord(number, "aiko", "human", (x, y, 0.86), (1.0, 0.0, 0.0, 0.0))


def start(body: Body, goal: Goal, frames: int = 0, world: list[ObjectRecord] | None = None, **given: Any) -> Start:
    """START of a walk as main sends it: over the floor, in the room."""
    return body.start(
        FLOOR, "walk", frames=frames, wish=True, goal=goal, hand="", world=ROOM if world is None else world, **given
    )


def to(x: float, y: float, degrees: float | None = None) -> Goal:
    return Goal(place=(x, y, 0.0), facing=None if degrees is None else float(np.radians(degrees)))


def walked(body: Body, message: Start) -> list[HumanPose]:
    return list(frames(program("walk"), message))


def shown(body: Body, poses: list[HumanPose]) -> tuple[Array, Array]:
    """As main shows them: rotations (F, 43, 4), the limbs solved onto their targets, and root (F, 3)."""
    rotations = np.array([solve(body.skeleton, p.rotations, p.root, p.targets) for p in poses])
    return rotations, np.array([p.root for p in poses])


def heading(rotation: Array) -> float:
    ahead = rotate(rotation, np.array([0.0, 0.0, -1.0]))
    return float(np.degrees(np.arctan2(ahead[1], ahead[0])))


@pytest.mark.parametrize("name", ["ken", "aiko"])
def test_it_walks_to_the_place_and_looks_the_way_it_was_told(name: str) -> None:
    body = Body(name, *FROM, facing=30.0)
    poses = walked(body, start(body, to(-0.2, -2.0, -120.0)))
    np.testing.assert_allclose(poses[-1].root[:2], [-0.2, -2.0], atol=0.01)
    assert heading(poses[-1].rotations[0]) == pytest.approx(-120.0, abs=1.0)
    for pose in poses:
        np.testing.assert_allclose(norm(pose.rotations), 1.0, atol=1e-9)
        assert np.isfinite(pose.targets).all()


@pytest.mark.parametrize("name", ["ken", "aiko"])
def test_the_table_is_walked_round(name: str) -> None:
    body = Body(name, -1.5, -0.2, facing=0.0)
    poses = walked(body, start(body, to(2.6, -0.2, 0.0)))
    np.testing.assert_allclose(poses[-1].root[:2], [2.6, -0.2], atol=0.01)
    hips = shapely.points([pose.root[:2] for pose in poses])
    ankles = shapely.points(np.array([pose.targets[FEET, :2] for pose in poses]).reshape(-1, 2))
    for thing in ROOM:
        for ring in occupied(thing):
            assert shapely.distance(ring, hips).min() > 0.12, thing.name
            assert shapely.distance(ring, ankles).min() > 0.0, thing.name


def occupied(thing: ObjectRecord) -> list[shapely.Polygon]:
    return [shapely.Polygon(ring) for ring in WorldObject.of(thing).occupied]


def test_a_goal_in_the_table_gets_a_clear_answer() -> None:
    body = Body("ken", *FROM)
    table = ROOM[0].place
    with pytest.raises(AlgorithmError, match=r"room/table; the nearest free place is -?\d"):
        walked(body, start(body, to(table[0], table[1])))


def test_the_nearest_free_place_that_is_named_can_be_walked_to() -> None:
    body = Body("ken", *FROM)
    table = ROOM[0].place
    with pytest.raises(AlgorithmError) as told:
        walked(body, start(body, to(table[0], table[1])))
    x, y = (float(word) for word in str(told.value).rsplit("place is ", 1)[1].split()[:2])
    poses = walked(body, start(body, to(x, y)))
    np.testing.assert_allclose(poses[-1].root[:2], [x, y], atol=0.01)


@pytest.mark.parametrize("name", ["room/chair", "room/table", "room/television"])
def test_to_a_thing_one_comes_to_where_it_is_used(name: str) -> None:
    body = Body("ken", *FROM)
    thing = next(one for one in ROOM if one.name == name)
    poses = walked(body, start(body, Goal(object=thing)))
    end = poses[-1].root[:2]
    for ring in occupied(thing):
        assert 0.05 < shapely.distance(ring, shapely.points(end)) < 0.8
    if "stand" in thing.sites:
        site = WorldObject.of(thing).site("stand", poses[0].root)
        np.testing.assert_allclose(end, site.place[:2], atol=0.01)


def test_who_sits_is_told_to_stand_up() -> None:
    body = Body("ken", *FROM)
    body.root = body.root - np.array([0.0, 0.0, 0.4])
    with pytest.raises(AlgorithmError, match="stand up first: `do floor stand`"):
        walked(body, start(body, to(0.0, -2.0)))


def test_who_crouches_stands_up_first_and_then_walks_there() -> None:
    body = Body("ken", *FROM)
    rotations, root = body.rotations, body.root
    low = Standing.of(body.skeleton, rotations, root)
    assert low is not None
    bent = low.postures(np.zeros(1), np.radians([60.0]), np.full(1, low.heading), np.array([0.35]), np.zeros(3))
    body.rotations, body.root = bent.rotations[0], bent.root[0]
    poses = walked(body, start(body, to(-2.0, -1.2)))
    root = np.array([pose.root for pose in poses])
    up = int((root[:, 2] > 0.99 * root[-1, 2]).argmax())
    assert np.linalg.norm(np.diff(root[:, :2], axis=0), axis=-1)[: up - 10].max() < 0.008  # the hips, over the feet
    assert np.abs(np.diff(root[:, 2], prepend=bent.root[0, 2])).max() < 0.012
    np.testing.assert_allclose(root[-1, :2], [-2.0, -1.2], atol=0.01)


def test_without_a_goal_it_asks_where_to() -> None:
    body = Body("ken", *FROM)
    with pytest.raises(AlgorithmError, match="where to"):
        walked(body, start(body, Goal()))


def test_without_a_library_it_says_what_to_do() -> None:
    body = Body("ken", *FROM)
    with pytest.raises(AlgorithmError, match="ahmss walk build"):
        walked(body, msgspec.structs.replace(start(body, to(0.0, -2.0)), motion=None))


@pytest.mark.parametrize("name", ["ken", "aiko"])
@pytest.mark.parametrize("degrees", [-90.0, 35.0, 179.0])
def test_a_turn_on_the_spot(degrees: float, name: str) -> None:
    body = Body(name, *FROM, facing=20.0)
    poses = walked(body, start(body, Goal(facing=float(np.radians(degrees)))))
    assert heading(poses[-1].rotations[0]) == pytest.approx(degrees, abs=1.0)
    away = np.linalg.norm(np.array([pose.root[:2] for pose in poses]) - FROM, axis=1)
    assert away.max() < 0.2
    assert away[-1] < 0.01


def test_legs_and_pelvis_matter_the_arms_little_the_head_less() -> None:
    body = Body("ken", *FROM)
    pose = walked(body, start(body, to(0.0, -2.0)))[30]
    cares = dict(zip(LINKS, pose.importance[:43].tolist(), strict=True))
    legs = [cares[f"{side}_{part}"] for side in ("right", "left") for part in ("upper_leg", "lower_leg", "foot")]
    arms = [cares[f"{side}_{part}"] for side in ("right", "left") for part in ("upper_arm", "lower_arm", "hand")]
    assert {*legs, cares["hips"], pose.importance[43]} == {1.0}
    assert 0.0 < cares["head"] < min(arms) <= max(arms) < 0.3
    assert max(arms) < cares["spine"] < 1.0
    assert not any(value for name, value in cares.items() if LINKS.index(name) > INDEX["left_foot"])  # fingers: none


def test_the_fingers_stay_as_they_are() -> None:
    body = Body("ken", *FROM)
    body.do("slerp", body.start(FLOOR, "stand"))
    before = body.rotations[INDEX["left_foot"] + 1 :].copy()
    rotations, _ = shown(body, walked(body, start(body, to(0.0, -2.0))))
    np.testing.assert_allclose(np.abs((rotations[:, -len(before) :] * before).sum(axis=-1)), 1.0, atol=1e-9)


@pytest.mark.parametrize("name", ["ken", "aiko"])
def test_the_feet_are_where_they_shall_be_without_help_and_with_it(name: str) -> None:
    """The rotations alone put the feet where their targets are: other motions may bend all but the legs."""
    body = Body(name, *FROM)
    poses = walked(body, start(body, to(0.5, -2.2, 90.0)))
    wanted = np.array([pose.targets[FEET, :7] for pose in poses])
    assert np.array([pose.targets[FEET, 7] for pose in poses]).min() == 1.0
    alone = feet(body.skeleton, np.array([p.rotations for p in poses]), np.array([p.root for p in poses]))
    np.testing.assert_allclose(alone[..., :3], wanted[..., :3], atol=1e-6)
    rotations, root = shown(body, poses)
    solved = feet(body.skeleton, rotations, root)
    np.testing.assert_allclose(solved[..., :3], wanted[..., :3], atol=1e-6)
    np.testing.assert_allclose(np.abs((solved[..., 3:] * wanted[..., 3:]).sum(axis=-1)), 1.0, atol=1e-9)


def heard(message: Start) -> tuple[int, list[str]]:
    """How many frames a walk takes, and what it has to say."""
    performance = Performance(program("walk"), message)
    present = performance.task.start.row.copy()
    for k in range(1, 3000):
        present[0] = k
        if not performance.step(present):
            return k - 1, performance.news()
        present[1:176] = performance.row[1:176]
    raise AssertionError("it never ends")


def test_frames_that_a_person_can_walk_in_are_followed() -> None:
    body = Body("ken", *FROM)
    natural, notes = heard(start(body, to(1.5, -2.0)))
    assert not notes
    for wanted in (round(0.8 * natural), round(1.3 * natural)):
        taken, notes = heard(start(body, to(1.5, -2.0), frames=wanted))
        assert taken == wanted
        assert not notes


@pytest.mark.parametrize(("frames_asked", "said"), [(60, "too few"), (2000, "too many")])
def test_frames_that_nobody_can_walk_in_are_said_to_be_so(frames_asked: int, said: str) -> None:
    body = Body("ken", *FROM)
    taken, notes = heard(start(body, to(1.5, -2.0), frames=frames_asked))
    assert len(notes) == 1
    assert said in notes[0]
    assert f"it takes {taken}" in notes[0]


def test_too_many_frames_for_a_turn_are_told_of_the_turn() -> None:
    body = Body("ken", *FROM)
    taken, notes = heard(start(body, Goal(facing=float(np.radians(90.0))), frames=2000))
    assert notes == [f"2000 frames are too many for a turn on the spot; it takes {taken}"]


@pytest.mark.parametrize("name", ["ken", "aiko"])
@pytest.mark.parametrize(
    "goal", [Goal(facing=float(np.radians(20.0))), to(*FROM), to(*FROM, 20.0)], ids=["turn", "walk", "walk and turn"]
)
def test_who_is_there_already_takes_no_step_and_says_so(goal: Goal, name: str) -> None:
    body = Body(name, *FROM, facing=20.0)
    taken, notes = heard(start(body, goal))
    assert taken <= 2
    assert notes == ["one stands there already, so no step is taken"]
    for pose in walked(body, start(body, goal)):
        np.testing.assert_allclose(pose.root, body.root, atol=1e-9)
        np.testing.assert_allclose(pose.rotations[:15], body.rotations[:15], atol=1e-9)
        np.testing.assert_allclose(pose.targets[FEET, :7], feet(body.skeleton, body.rotations, body.root), atol=1e-9)


def test_who_has_walked_there_is_there() -> None:
    body = Body("aiko", *FROM, facing=30.0)
    message = start(body, to(-0.2, -2.0, -120.0))
    body.do("walk", message)
    assert heard(start(body, to(-0.2, -2.0, -120.0)))[0] <= 2
    assert heard(start(body, Goal(facing=float(np.radians(-120.0)))))[0] <= 2


def test_who_stays_does_so_for_the_frames_asked_for() -> None:
    assert heard(start(Body("ken", *FROM), to(*FROM), frames=90))[0] == 90


@pytest.mark.parametrize("goal", [to(FROM[0] + 0.03, FROM[1]), to(*FROM, 3.0)], ids=["aside", "turned"])
def test_who_is_not_quite_there_steps(goal: Goal) -> None:
    taken, notes = heard(start(Body("ken", *FROM), goal))
    assert taken > 60
    assert not notes


def test_who_bends_where_they_are_to_be_straightens_up() -> None:
    body = Body("ken", *FROM)
    body.root = body.root - np.array([0.0, 0.0, 0.1])
    assert heard(start(body, to(*FROM)))[0] > 60


@pytest.mark.parametrize(("x", "said"), [(1e9, "1e+06 km away"), (-2003.0, "2.002 km away")])
def test_what_is_further_than_one_walks_at_once_is_refused(x: float, said: str) -> None:
    body = Body("ken", *FROM)
    with pytest.raises(AlgorithmError, match=f"{re.escape(said)}; name a place within 2 km of the walker"):
        walked(body, start(body, to(x, -1.5)))


def test_somebody_who_stands_in_the_way_is_walked_round() -> None:
    body = Body("ken", -2.0, -2.0, facing=0.0)
    there = other_human(0.0, -2.0)
    poses = walked(body, start(body, to(2.0, -2.0), world=[*ROOM, there]))
    np.testing.assert_allclose(poses[-1].root[:2], [2.0, -2.0], atol=0.01)
    away = np.linalg.norm(np.array([pose.root[:2] for pose in poses]) - there.place[:2], axis=1)
    assert away.min() > 0.5


def test_a_real_process_answers_as_the_function_does() -> None:
    body = Body("ken", *FROM)
    message = start(body, to(-0.9, -1.9, 0.0))
    expected = walked(body, message)
    rows, present = [], body.row(1)
    for k, pose in enumerate(expected, 1):
        present = present.copy()
        present[0] = k
        rows.append(present)
        present = np.concatenate([[k], pose.root, pose.rotations.reshape(172), np.zeros(14)])
    with Launcher() as launcher:
        process = launcher.start(WORKSPACE.algorithms.find("walk"), message)
        answers: list[Array] = []
        for row in rows:
            process.ask(
                encode_frame(int(row[0]), row[1:4], row[4:176].reshape(43, 4), row[176:190].reshape(2, 7), None)
            )
            assert launcher.wait([process], 20.0)
            answers += [got.row for got in process.receive() if isinstance(got, Answer)]
        process.stop()
        launcher.close()
    assert len(answers) == len(expected)
    for answer, pose in zip(answers, expected, strict=True):
        got = HumanPose.of(answer)
        np.testing.assert_allclose(got.root, pose.root, atol=1e-9)
        np.testing.assert_allclose(got.rotations, pose.rotations, atol=1e-9)
        np.testing.assert_allclose(got.targets, pose.targets, atol=1e-9)


def test_a_place_beyond_the_floor_is_refused_with_where_it_ends() -> None:
    start = Body("ken", *FROM).start(FLOOR, "walk", goal=Goal(place=(100.0, 100.0, 0.0)))
    with pytest.raises(AlgorithmError, match=r"^100.00 100.00 is beyond room/floor, which ends at 3.70 3.60; name"):
        next(iter(frames(program("walk"), start)))


def test_where_another_floor_goes_on_one_walks_onto_it() -> None:
    floor = msgspec.structs.replace(record(FLOOR), id=77, name="floor_2", place=(6.7, 0.6, 0.0))
    start = Body("ken", *FROM).start(FLOOR, "walk", goal=Goal(place=(9.6, 0.6, 0.0)), world=[floor])
    beyond = msgspec.structs.replace(start, goal=Goal(place=(9.8, 0.6, 0.0)))
    assert next(iter(frames(program("walk"), start))).root[2] > 0.8
    with pytest.raises(AlgorithmError, match=r"9.80 0.60 is beyond room/floor, which ends at 9.70 0.60"):
        next(iter(frames(program("walk"), beyond)))
