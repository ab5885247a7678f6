"""What an author writes, played without a process."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest
from algorithm_rig import HUMAN, ROOT, ROTATIONS

from ahmss.algorithm import HumanTask, ObjectTask, Transform, frames, resolve_site
from ahmss.algorithm.messages import Goal, ObjectRecord, SiteRecord
from ahmss.algorithm.performance import Performance
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.errors import ProtocolError, ShapeError
from ahmss.skills.stepping import walkers

STEP = np.array([0.25, 0.0, 0.0])
Y, Z = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])


def nod(task: HumanTask):
    head = task.start.rotations[INDEX["head"]].copy()
    for k in task.frames():
        angle = task.parameter("depth", 0.5) * np.sin(np.pi * k / task.length)
        yield task.pose({"head": multiply(head, from_axis_angle(Y, angle))})


def test_a_motion_has_its_frames_and_ends(make_start):
    poses = list(frames(nod, make_start(frames=8, parameters={"depth": 1})))
    assert len(poses) == 8
    expected = multiply(ROTATIONS[INDEX["head"]], from_axis_angle(Y, 1.0))
    np.testing.assert_allclose(poses[3].rotations[INDEX["head"]], expected, atol=1e-12)
    np.testing.assert_allclose(poses[7].rotations, ROTATIONS, atol=1e-12)
    assert poses[0].importance[INDEX["head"]] == 1.0
    assert poses[0].importance.sum() == 1.0
    np.testing.assert_array_equal(poses[0].root, ROOT)


def test_each_frame_starts_from_where_the_one_before_has_led(make_start):
    def creep(task: HumanTask):
        for _ in task.frames():
            yield task.pose({}, root=task.present.root + STEP)

    roots = [pose.root[0] - ROOT[0] for pose in frames(creep, make_start(frames=4))]
    assert roots == [0.25, 0.5, 0.75, 1.0]


def test_a_block_is_given_out_frame_by_frame(make_start):
    def slide(task: HumanTask):
        root = task.start.root + np.linspace([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], task.length)
        return task.block(np.tile(task.start.rotations, (task.length, 1, 1)), root, targets=np.full((5, 8), 0.5))

    poses = list(frames(slide, make_start(frames=5)))
    assert [pose.root[0] - ROOT[0] for pose in poses] == [0.0, 0.25, 0.5, 0.75, 1.0]
    assert (poses[0].importance == 1.0).all()
    assert (poses[4].targets == 0.5).all()


def test_a_motion_without_a_number_of_frames_ends_itself(make_start):
    def walk_to_a_metre(task: HumanTask):
        assert task.length == 0
        for _ in task.frames():
            if task.present.root[0] - ROOT[0] >= 1.0:
                return
            yield task.pose({}, root=task.present.root + STEP)

    roots = [pose.root[0] - ROOT[0] for pose in frames(walk_to_a_metre, make_start(frames=0))]
    assert roots == [0.25, 0.5, 0.75, 1.0]


def test_what_is_made_at_once_is_over_with_its_last_frame(make_start):
    start = make_start(frames=0)
    made = Performance(lambda task: task.block(np.tile(ROTATIONS, (2, 1, 1)), np.tile(ROOT, (2, 1))), start)
    seen = []
    for _ in range(2):
        assert made.step(made.task.start.row.copy())
        seen.append(made.over)
    assert seen == [False, True]


def test_blocks_and_poses_mix(make_start):
    def both(task: HumanTask):
        yield task.block(np.tile(ROTATIONS, (2, 1, 1)), np.tile(ROOT, (2, 1)))
        yield task.pose({}, root=ROOT + 1.0, states={"full": False})
        yield task.block(np.tile(ROTATIONS, (2, 1, 1)), np.tile(ROOT + 2.0, (2, 1)))

    poses = list(frames(both, make_start(frames=9)))
    assert [round(float((pose.root - ROOT)[0])) for pose in poses] == [0, 0, 1, 2, 2]
    assert [dict(pose.states) for pose in poses] == [{}, {}, {"full": False}, {}, {}]


def test_a_block_that_cannot_be_written_is_not_written_to(make_start):
    made = np.zeros((3, 260))
    made.flags.writeable = False
    poses = list(frames(lambda _: made, make_start(frames=3)))
    assert len(poses) == 3
    assert (made == 0.0).all()


def test_states_are_told_when_they_change(make_start):
    def pour(task: ObjectTask):
        for human in task.frames():
            yield task.pose(states={"full": human.k < 3})

    changes = [dict(pose.states) for pose in frames(pour, make_start("object", frames=5))]
    assert changes == [{}, {}, {"full": False}, {}, {}]  # it was full at the start


def test_an_object_follows_the_hand(make_start):
    def follow(task: ObjectTask):
        offset = None
        for human in task.frames():
            palm = human.grip(task.hand)
            offset = offset or palm.inverse().then(task.object.frame)
            held = palm.then(offset)
            yield task.pose(held.place, held.rotation)

    start = make_start("object", frames=3, hand="left")
    turn = from_axis_angle(Z, np.pi / 2)
    humans = np.zeros((3, 190))
    humans[:, 183:190] = [[1, 0, 1, 1, 0, 0, 0], [2, 0, 1, 1, 0, 0, 0], [2, 0, 1, *turn]]
    poses = list(frames(follow, start, humans))
    np.testing.assert_allclose([pose.place for pose in poses], [[0.4, -0.1, 0.8], [1.4, -0.1, 0.8], [2.1, -0.6, 0.8]])
    np.testing.assert_allclose(poses[2].rotation, turn)


def test_the_palms_at_the_start_face_inwards(make_start):
    task = HumanTask(make_start())
    np.testing.assert_allclose(rotate(task.start.right_grip.rotation, np.array([1.0, 0, 0])), Y, atol=1e-12)
    np.testing.assert_allclose(rotate(task.start.left_grip.rotation, np.array([1.0, 0, 0])), -Y, atol=1e-12)
    assert task.start.right_grip.place[1] < 0.0 < task.start.left_grip.place[1]


def test_the_first_frame_tells_where_the_start_is(make_start):
    seen = []

    def look(task: HumanTask):
        seen.append(task.start.root.copy())
        for _ in task.frames():
            yield task.pose({})

    performance = Performance(look, make_start())
    frame = np.zeros(190)
    frame[0], frame[1:4] = 1, [5.0, 6.0, 7.0]
    performance.step(frame)
    np.testing.assert_array_equal(seen, [[5.0, 6.0, 7.0]])
    assert performance.task.start.k == 0


def test_the_task_says_what_start_said(make_start):
    tap = ObjectRecord(9, "tap", "tap", (1.0, 1.0, 1.0), (1.0, 0.0, 0.0, 0.0), states={"water": "off"})
    goal = Goal(rotation=(0.0, 1.0, 0.0, 0.0), facing=1.5, object=tap)
    task = HumanTask(make_start(goal=goal, world=[tap], seed=3, hand="right", rate=30.0, directory="/somewhere"))
    assert task.object is not None
    assert (task.object.properties, task.object.states) == ({"mass": 0.2}, {"full": True})
    assert (task.rate, task.hand, str(task.directory), task.goal_facing) == (30.0, "right", "/somewhere", 1.5)
    np.testing.assert_array_equal(task.goal_place, [1.0, 1.0, 1.0])
    np.testing.assert_array_equal(task.goal_rotation, [0.0, 1.0, 0.0, 0.0])
    assert task.goal_object is not None
    assert task.goal_object.name == "tap"
    assert task.world[9].states == {"water": "off"}
    assert task.motion is None
    assert task.posture is None
    assert task.random.integers(1 << 30) == HumanTask(make_start(seed=3)).random.integers(1 << 30)
    assert task.human.stature == HUMAN.stature
    np.testing.assert_allclose(task.human.offsets, HUMAN.offsets)


def test_what_moves_is_seen(make_start):
    tap = ObjectRecord(9, "tap", "tap", (1.0, 1.0, 1.0), (1.0, 0.0, 0.0, 0.0))
    task = HumanTask(make_start(world=[tap]))
    before = task.world[9].frame
    moved = [[9, 2, 3, 4, 0, 1, 0, 0], [7, 5, 6, 7, 0, 0, 1, 0], [1000, 0, 0, 0, 1, 0, 0, 0]]
    task.see(np.concatenate([np.zeros(190), np.ravel(moved).astype(float)]))
    np.testing.assert_array_equal(task.world[9].place, [2, 3, 4])
    np.testing.assert_array_equal(before.place, [1, 1, 1])  # what was made of it as it was is not moved
    np.testing.assert_array_equal(task.object.rotation, [0, 0, 1, 0])
    with pytest.raises(ProtocolError, match="FRAME has 191 numbers; 190 and 8 for each"):
        task.see(np.zeros(191))


def test_where_other_humans_were_is_remembered(make_start):
    other = ObjectRecord(-4, "aiko", "human", (1.0, 1.0, 0.0), (1.0, 0.0, 0.0, 0.0))
    tap = ObjectRecord(9, "tap", "tap", (1.0, 1.0, 1.0), (1.0, 0.0, 0.0, 0.0))
    task = HumanTask(make_start(world=[other, tap]))
    for k in (1, 2, 5):
        row = np.zeros(190)
        row[0] = k
        moved = [[-4, 1 + 0.1 * k, 2, 0, np.cos(0.1 * k), 0, 0, np.sin(0.1 * k)], [9, k, 0, 0, 1, 0, 0, 0]]
        task.see(np.concatenate([row, np.ravel(moved).astype(float)]))
    seen = [(1.0, 1.1, 2.0, 0.2), (2.0, 1.2, 2.0, 0.4), (5.0, 1.5, 2.0, 1.0)]  # frame, place, heading
    np.testing.assert_allclose(task.world[-4].seen, seen)
    assert not task.world[9].seen


def test_a_human_who_comes_later_is_among_the_others(make_start):
    task = HumanTask(make_start(world=[]))
    moved = [[-3, 1, 2, 0, 1, 0, 0, 0], [8, 1, 2, 0, 1, 0, 0, 0]]
    task.see(np.concatenate([np.zeros(190), np.ravel(moved).astype(float)]))
    assert list(task.world) == [-3]
    assert task.world[-3].kind == "human"
    np.testing.assert_array_equal(task.world[-3].place, [1, 2, 0])


def test_a_human_who_has_left_is_not_waited_for(make_start):
    other = ObjectRecord(-4, "aiko", "human", (1.0, 2.0, 0.0), (1.0, 0.0, 0.0, 0.0))
    task = HumanTask(make_start(world=[other]))
    assert [one.name for one in walkers(task)] == ["aiko"]
    gone = [[-4, *np.full(7, np.nan)], [-5, *np.full(7, np.nan)]]  # the latter was never told of
    task.see(np.concatenate([np.zeros(190), np.ravel(gone)]))
    assert walkers(task) == []
    assert not task.world


def test_what_an_object_occupies_goes_where_it_goes(make_start):
    ring = [(0.0, 0.0), (2.0, 0.0), (0.0, 1.0)]
    door = ObjectRecord(9, "door", "door", (1.0, 1.0, 0.5), (1.0, 0.0, 0.0, 0.0), footprint=[ring])
    task = HumanTask(make_start(world=[door]))
    np.testing.assert_array_equal(task.world[9].footprint, [ring])
    np.testing.assert_allclose(task.world[9].occupied, [[[1, 1], [3, 1], [1, 2]]])
    quarter, tilt = from_axis_angle(Z, np.pi / 2), from_axis_angle(Y, 0.3)
    moved = np.concatenate([np.zeros(190), [9, 5, 6, 7], multiply(quarter, tilt)])
    task.see(moved)
    np.testing.assert_allclose(task.world[9].occupied, [[[5, 6], [5, 8], [4, 6]]], atol=1e-12)
    assert task.object is not None
    assert task.object.footprint == task.object.occupied == ()


def test_a_site_with_a_free_axis_turns_away_from_the_human(make_start):
    tilted = from_axis_angle(Y, 0.3)
    frame = Transform(np.array([2.0, 0.0, 1.0]), tilted)
    for human in ([0.0, 0.0, 0.9], [2.0, -3.0, 0.9], [4.0, 4.0, 0.9]):
        site = resolve_site(frame, SiteRecord((0.0, 0.0, 0.05), free_axis="z"), np.array(human))
        x, z = rotate(site.rotation, np.array([1.0, 0, 0])), rotate(site.rotation, Z)
        np.testing.assert_allclose(z, rotate(tilted, Z), atol=1e-12)  # its own axis stays
        away = (site.place - human) * [1.0, 1.0, 0.0]
        assert x @ away > 0.9 * np.linalg.norm(away)
        assert abs(np.cross(z, x) @ away) < 1e-9  # no better yaw
    fixed = resolve_site(frame, SiteRecord((0.1, 0.0, 0.0)), np.zeros(3))
    np.testing.assert_allclose(fixed.place, [2.0 + 0.1 * np.cos(0.3), 0.0, 1.0 - 0.1 * np.sin(0.3)])
    straight = Transform(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
    above = resolve_site(straight, SiteRecord((0.0, 0.0, 0.0), free_axis="z"), Z)
    np.testing.assert_allclose(above.rotation, [1, 0, 0, 0])


def test_parameters_have_the_type_of_their_default(make_start):
    task = HumanTask(make_start(parameters={"depth": 1, "side": "left", "fast": True}))
    assert task.parameter("depth", 0.5) == 1.0
    assert isinstance(task.parameter("depth", 0.5), float)
    assert task.parameter("width", 0.5) == 0.5
    for name, default in (("side", 1.0), ("fast", 1.0), ("fast", 1)):
        with pytest.raises(TypeError, match=f"parameter {name}"):
            task.parameter(name, default)


def test_mistakes_of_an_author_are_told_plainly(make_start):
    def playing(answer):
        return list(frames(lambda task: (answer(task) for _ in task.frames()), make_start(frames=1)))

    with pytest.raises(ShapeError, match=r"rotations \(43, 4\).*\(3,\), \(42, 4\), \(44,\), \(5, 8\)"):
        playing(lambda task: task.pose(np.zeros((42, 4))))
    with pytest.raises(KeyError, match="importance of 'haed'"):
        playing(lambda task: task.pose({}, importance={"haed": 1.0}))
    with pytest.raises(KeyError, match="no target 'nose'"):
        playing(lambda task: task.pose({}, targets={"nose": np.zeros(3)}))
    with pytest.raises(ShapeError, match="target gaze: 3, 7 or 8 numbers"):
        playing(lambda task: task.pose({}, targets={"gaze": np.zeros(4)}))
    with pytest.raises(TypeError, match="expected a HumanPose"):
        playing(lambda _: 3)
    with pytest.raises(ShapeError, match=r"a block of poses is \(N, 260\)"):
        list(frames(lambda _: np.zeros((3, 259)), make_start()))
    with pytest.raises(ShapeError, match=r"a block needs.*\(3, 42, 4\)"):
        HumanTask(make_start()).block(np.zeros((3, 42, 4)), np.zeros((3, 3)))
    with pytest.raises(ProtocolError, match="names no object"):
        ObjectTask(msgspec.structs.replace(make_start("object"), object=None))
    with pytest.raises(KeyError, match="has no site 'rim'; it has: handle, side"):
        _ = HumanTask(make_start(site="rim")).site


def test_names_give_importance_and_targets(make_start):
    task = HumanTask(make_start())
    pose = task.pose(
        {}, importance={"right_": 1.0, "right_index": 0.5, "root": 2.0},
        targets={"right_hand": np.array([1.0, 2.0, 3.0]), "gaze": np.arange(8.0)},
    )  # fmt: skip
    assert pose.importance[INDEX["right_foot"]] == 1.0
    assert pose.importance[INDEX["right_index_distal"]] == 0.5
    assert pose.importance[INDEX["left_foot"]] == 0.0
    assert pose.importance[43] == 2.0
    np.testing.assert_array_equal(pose.targets[0], [1, 2, 3, 0, 0, 0, 0, 1])
    np.testing.assert_array_equal(pose.targets[4], np.arange(8.0))


def test_notes_are_kept_and_said_with_the_next_answer(make_start):
    def says(task: HumanTask):
        task.note("30 frames\nare too few")
        for k in task.frames():
            if k == 2:
                task.note("half way")
            yield task.pose({})

    performance = Performance(says, make_start(frames=3))
    told = []
    for k in range(1, 4):
        performance.step(np.concatenate([[k], np.zeros(189)]))
        told.append(performance.news())
    assert told == [["30 frames are too few"], ["half way"], []]
    assert performance.task.notes == ["30 frames are too few", "half way"]


def test_a_function_that_is_left_early_cleans_up(make_start):
    ended = []

    def tidy(task: HumanTask):
        try:
            for _ in task.frames():
                yield task.pose({})
        finally:
            ended.append(True)

    playing = frames(tidy, make_start(frames=10))
    next(playing)
    playing.close()
    assert ended == [True]
